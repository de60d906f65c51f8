"""The tree of products in a STEP file: names, colours, places and the unit of length."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from OCP import (
    TDF,
    IFSelect,
    Interface,
    Quantity,
    STEPCAFControl,
    STEPConstruct,
    TCollection,
    TDataStd,
    TDocStd,
    TopLoc,
    XCAFDoc,
)

from inertia.mesh.readers.opencascade.kernel import kind_of, labels, parts_of

Colour = tuple[float, float, float]
_DEEP = 200


@dataclass(frozen=True)
class Piece:
    """A solid, shell or face, where the tree puts it (loose faces of one product come as one compound)."""

    shape: Any
    location: Any
    name: str | None
    path: tuple[str, ...]
    colour: Colour | None


class Document:
    """A STEP file, taken over in its own unit.

    Attributes
    ----------
    millimetres : the unit
    units : how many different ones the file has
    loose : points, edges and wires that belong to no face
    """

    def __init__(self, source: str) -> None:
        Interface.Interface_Static.SetIVal_s("read.stepcaf.subshapes.name", 1)
        reader = STEPCAFControl.STEPCAFControl_Reader()
        reader.SetNameMode(True)
        reader.SetColorMode(True)
        if reader.ReadFile(source) != IFSelect.IFSelect_RetDone:
            raise ValueError("it is no STEP file")
        factors = _factors(reader.ChangeReader().StepModel())
        self.units = len(set(factors))
        self.millimetres = max(factors, key=factors.count, default=1.0)
        self.loose = 0
        self._document = TDocStd.TDocStd_Document(TCollection.TCollection_ExtendedString("XmlXCAF"))
        XCAFDoc.XCAFDoc_DocumentTool.SetLengthUnit_s(self._document, self.millimetres / 1000)
        reader.ChangeReader().SetSystemLengthUnit(self.millimetres)
        if not reader.Transfer(self._document):
            raise ValueError("nothing in it can be taken over")
        self._shapes = XCAFDoc.XCAFDoc_DocumentTool.ShapeTool_s(self._document.Main())
        self._tree = XCAFDoc.XCAFDoc_ShapeTool

    def pieces(self) -> Iterator[Piece]:
        """Yield everything that has faces."""
        roots = labels()
        self._shapes.GetFreeShapes(roots)
        for root in roots:
            yield from self._below(root, TopLoc.TopLoc_Location(), (), None)

    def _below(self, label: Any, location: Any, path: tuple[str, ...], colour: Colour | None) -> Iterator[Piece]:
        if self._tree.IsReference_s(label):
            location = location.Multiplied(self._tree.GetLocation_s(label))
            colour = _colour(label) or colour
            product = TDF.TDF_Label()
            self._tree.GetReferredShape_s(label, product)
            label = product
        if not self._tree.IsAssembly_s(label):
            yield from self._within(label, location, path, colour)
            return
        if len(path) == _DEEP:
            raise ValueError(f"its assemblies are nested more than {_DEEP} deep")
        components = labels()
        self._tree.GetComponents_s(label, components, False)
        name = _name(label)
        for component in components:
            yield from self._below(
                component, location, path if name is None else (*path, name), colour or _colour(label)
            )

    def _within(self, label: Any, location: Any, path: tuple[str, ...], colour: Colour | None) -> Iterator[Piece]:
        shape, name = self._tree.GetShape_s(label), _name(label)
        several = sum(1 for _ in _solids(shape)) > 1
        for piece in self._pieces_of(shape):
            own = TDF.TDF_Label()
            known = self._shapes.FindSubShape(label, piece, own)
            title = (_name(own) if known and several else None) or name
            shade = colour or (_colour(own) if known else None) or _colour(label)
            where = location.Multiplied(piece.Location())
            yield Piece(piece.Located(TopLoc.TopLoc_Location()), where, title, path, shade)

    def _pieces_of(self, shape: Any) -> Iterator[Any]:
        kind = kind_of(shape)
        if kind in ("SOLID", "SHELL", "FACE"):
            yield shape
        elif kind in ("COMPOUND", "COMPSOLID"):
            for part in parts_of(shape):
                yield from self._pieces_of(part)
        else:
            self.loose += 1


def _solids(shape: Any) -> Iterator[Any]:
    if kind_of(shape) in ("COMPOUND", "COMPSOLID"):
        for part in parts_of(shape):
            yield from _solids(part)
    else:
        yield shape


def _name(label: Any) -> str | None:
    attribute = TDataStd.TDataStd_Name()
    if not label.FindAttribute(TDataStd.TDataStd_Name.GetID_s(), attribute):
        return None
    return str(attribute.Get().ToExtString()).strip() or None


def _colour(label: Any) -> Colour | None:
    colour = Quantity.Quantity_Color()
    for kind in (XCAFDoc.XCAFDoc_ColorSurf, XCAFDoc.XCAFDoc_ColorGen):
        if XCAFDoc.XCAFDoc_ColorTool.GetColor_s(label, kind, colour):
            red, green, blue = colour.Values(Quantity.Quantity_TOC_sRGB)
            return round(red, 6), round(green, 6), round(blue, 6)  # the kernel holds float32
    return None


def _factors(model: Any) -> list[float]:
    """Return the unit of length of each context of shapes, in millimetres."""
    factors = []
    for number in range(1, model.NbEntities() + 1):
        entity = model.Value(number)
        if hasattr(entity, "GlobalUnitAssignedContext"):
            context = STEPConstruct.STEPConstruct_UnitContext()
            context.ComputeFactors(entity.GlobalUnitAssignedContext())
            if context.LengthDone():
                factors.append(float(context.LengthFactor()))
    return factors
