"""The tree of products in a STEP file: names, colours, places and the unit of length."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from OCP import (
    TDF,
    IFSelect,
    Interface,
    Quantity,
    STEPCAFControl,
    STEPConstruct,
    StepData,
    TCollection,
    TDataStd,
    TDocStd,
    TopLoc,
    XCAFDoc,
)

from inertia.mesh.readers.contents import shown
from inertia.mesh.readers.opencascade.kernel import bodies_of, colour_of, has_faces, labels, tessellated
from inertia.records import dataclass

Colour = tuple[float, float, float]
_DEEP = 200


@dataclass(frozen=True)
class Piece:
    """A solid, shell or face, where the tree puts it (loose faces of one product come as one compound).

    `node` is the product of the tree that it is in, by its number, and `within` its place there.
    """

    shape: Any
    location: Any
    name: str | None
    path: tuple[str, ...]
    colour: Colour | None
    node: int
    within: Any


class Document:
    """A STEP file, taken over in its own unit.

    Attributes
    ----------
    millimetres : the unit
    scale : the unit of the shapes in that of the file, a power of two, so that scaling costs no digit
    units : how many different ones the file has
    loose : points, edges and wires that belong to no face
    faults : what the kernel could not take over, in its words
    nodes : the tree of products, as far as `pieces` has come: name, number of the one above, place in it
    """

    def __init__(self, source: str) -> None:
        Interface.Interface_Static.SetIVal_s("read.stepcaf.subshapes.name", 1)
        XCAFDoc.XCAFDoc_ShapeTool.SetAutoNaming_s(False)
        reader = STEPCAFControl.STEPCAFControl_Reader()
        if reader.ReadFile(source) != IFSelect.IFSelect_RetDone:
            raise ValueError("OpenCASCADE does not take it for a STEP file: export the part again")
        model = reader.ChangeReader().StepModel()
        _require_rigid(model)
        factors = _factors(model)
        self.units = len(set(factors))
        self.millimetres = max(factors, key=factors.count, default=1.0)
        self.scale = 2.0 ** -round(math.log2(self.millimetres))  # the kernel's tolerances are meant for millimetres
        self.loose = 0
        self.nodes: list[tuple[str | None, int | None, Any]] = []
        self._document = TDocStd.TDocStd_Document(TCollection.TCollection_ExtendedString("XmlXCAF"))
        XCAFDoc.XCAFDoc_DocumentTool.SetLengthUnit_s(self._document, self.millimetres * self.scale / 1000)
        reader.ChangeReader().SetSystemLengthUnit(self.millimetres * self.scale)
        if not reader.Transfer(self._document):
            raise ValueError("OpenCASCADE finds no shape in it that can be read: export the part again")
        self.faults = [*_words(model.GlobalCheck(True)), *_faults(reader.ChangeReader().WS())]
        self._shapes = XCAFDoc.XCAFDoc_DocumentTool.ShapeTool_s(self._document.Main())
        self._tree = XCAFDoc.XCAFDoc_ShapeTool

    def pieces(self) -> Iterator[Piece]:
        """Yield everything that has faces."""
        roots = labels()
        self._shapes.GetFreeShapes(roots)
        for root in roots:
            yield from self._below(root, TopLoc.TopLoc_Location(), (), None)

    def _below(
        self, label: Any, location: Any, path: tuple[str, ...], colour: Colour | None, above: int | None = None
    ) -> Iterator[Piece]:
        name, place = None, TopLoc.TopLoc_Location()
        if self._tree.IsReference_s(label):
            place = self._tree.GetLocation_s(label)
            location = location.Multiplied(place)
            colour = _colour(label) or colour
            product = TDF.TDF_Label()
            self._tree.GetReferredShape_s(label, product)
            name, label = _name(label), product
        name = _name(label) or name
        number = len(self.nodes)
        self.nodes.append((name, above, place))
        if not self._tree.IsAssembly_s(label):
            yield from self._within(label, location, name, path, colour, number)
            return
        if len(path) == _DEEP:
            raise ValueError(f"its assemblies are nested more than {_DEEP} deep")
        components = labels()
        self._tree.GetComponents_s(label, components, False)
        for component in components:
            yield from self._below(
                component, location, path if name is None else (*path, name), colour or _colour(label), number
            )

    def _within(
        self, label: Any, location: Any, name: str | None, path: tuple[str, ...], colour: Colour | None, number: int
    ) -> Iterator[Piece]:
        shape = self._tree.GetShape_s(label)
        bodies = list(bodies_of(shape))
        if any(map(tessellated, bodies)):
            raise ValueError(
                f"its product {shown(name or (path[-1] if path else str(number)))} has tessellated shapes, triangles "
                "without surfaces, which are not read: export it with its exact shapes only, or as STL or 3MF"
            )
        several = len(bodies) > 1
        self.loose += sum(not has_faces(piece) for piece in bodies)
        for piece in filter(has_faces, bodies):
            own = TDF.TDF_Label()
            known = self._shapes.FindSubShape(label, piece, own)
            title = (_name(own) if known and several else None) or name or (path[-1] if path else None)
            shade = colour or (_colour(own) if known else None) or _colour(label)
            where = location.Multiplied(piece.Location())
            here = piece.Located(TopLoc.TopLoc_Location())
            yield Piece(here, where, title, path, shade, number, piece.Location())


def _name(label: Any) -> str | None:
    kind, attribute = TDataStd.TDataStd_Name.GetID_s(), TDataStd.TDataStd_Name()
    if not label.IsAttribute(kind):  # of which the binding does not survive the search
        return None
    label.FindAttribute(kind, attribute)
    return str(attribute.Get().ToExtString()).strip() or None


def _colour(label: Any) -> Colour | None:
    colour = Quantity.Quantity_Color()
    for kind in (XCAFDoc.XCAFDoc_ColorSurf, XCAFDoc.XCAFDoc_ColorGen):
        if XCAFDoc.XCAFDoc_ColorTool.GetColor_s(label, kind, colour):
            return colour_of(colour)
    return None


def _require_rigid(model: Any) -> None:
    """Refuse what places shapes by a scale or a mirror, of which the kernel (7.8, 8.0) makes something else."""
    for number in range(1, model.NbEntities() + 1):
        target = model.Value(number)
        target = target.MappingTarget() if hasattr(target, "MappingTarget") else None
        if target is None or not hasattr(target, "Axis3"):
            continue
        axes = [
            axis and [axis.DirectionRatiosValue(k) for k in (1, 2, 3)]
            for axis in (target.Axis1(), target.Axis2(), target.Axis3())
        ]
        mirrored = all(axes) and np.linalg.det(axes) < 0
        if mirrored or (target.HasScale() and abs(target.Scale() - 1) > 1e-12):
            what = "mirrors" if mirrored else f"scales by {target.Scale():g}"
            raise ValueError(f"it {what} a shape that it places, which is not read: export it with that carried out")


def _faults(session: Any) -> Iterator[str]:
    checks = session.TransferReader().TransientProcess().CheckList(False)
    checks.Start()
    while checks.More():
        check = checks.Value()
        warnings = (check.CWarning(k, True).strip() for k in range(1, check.NbWarnings() + 1))
        yield from (*_words(check), *(word for word in warnings if word.endswith("ignored")))
        checks.Next()


def _words(check: Any) -> list[str]:
    return [check.CFail(k, True).strip() for k in range(1, check.NbFails() + 1)]


def _factors(model: Any) -> list[float]:
    """Return the unit of length of each context of shapes, in millimetres."""
    factors = []
    for number in range(1, model.NbEntities() + 1):
        entity = model.Value(number)
        if hasattr(entity, "GlobalUnitAssignedContext"):
            context = STEPConstruct.STEPConstruct_UnitContext()
            millimetre = StepData.StepData_Factors()
            millimetre.SetCascadeUnit(1.0)
            context.ComputeFactors(entity.GlobalUnitAssignedContext(), millimetre)
            if context.LengthDone():
                factors.append(float(context.LengthFactor()))
    return factors
