"""Shapes of OpenCASCADE's Python binding (OCP): what they are made of, and what versions 7 and 8 name differently."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from typing import Any

from OCP import BRep, Quantity, TopAbs, TopExp, TopoDS


def collection(new: str, module: str, old: str, *size: int) -> Any:
    """Return a collection by its name in version 8, or by its module and name in version 7."""
    try:
        return getattr(importlib.import_module("OCP.collections"), new)(*size)
    except ImportError:
        return getattr(importlib.import_module(f"OCP.{module}"), old)(*size)


def shape_map() -> Any:
    """Return an empty map that numbers shapes from 1; shapes are one and the same whatever their orientation."""
    return collection("IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher", "TopTools", "TopTools_IndexedMapOfShape")


def labels() -> Any:
    """Return an empty sequence of labels of a document."""
    return collection("Sequence_TDF_Label", "TDF", "TDF_LabelSequence")


def cast(shape: Any, kind: str) -> Any:
    """Return a shape as the class of its kind (`"Face"`, `"Edge"`, ...)."""
    casts = TopoDS.TopoDS
    return getattr(casts, kind)(shape) if hasattr(casts, kind) else getattr(casts, f"{kind}_s")(shape)


def kind_of(shape: Any) -> str:
    """Return the kind of a shape: `"COMPOUND"`, `"SOLID"`, `"SHELL"`, `"FACE"`, ..."""
    return str(shape.ShapeType().name).removeprefix("TopAbs_")


def parts_of(shape: Any) -> Iterator[Any]:
    """Yield what a shape is made of, one level down, oriented and placed as in it."""
    parts = TopoDS.TopoDS_Iterator(shape)
    while parts.More():
        yield parts.Value()
        parts.Next()


def bodies_of(shape: Any) -> Iterator[Any]:
    """Yield the solids, shells and faces of a shape that are in no other of them, and what has no face, placed."""
    if kind_of(shape) in ("COMPOUND", "COMPSOLID"):
        for part in parts_of(shape):
            yield from bodies_of(part)
    else:
        yield shape


def has_faces(shape: Any) -> bool:
    """Whether what `bodies_of` yields is more than points and wires."""
    return kind_of(shape) in ("SOLID", "SHELL", "FACE")


def tessellated(shape: Any) -> bool:
    """Whether a face of a shape is triangles without a surface, which ends the process where a surface is asked for."""
    walk = TopExp.TopExp_Explorer(shape, TopAbs.TopAbs_FACE)
    while walk.More():
        if BRep.BRep_Tool.Surface_s(cast(walk.Current(), "Face")) is None:
            return True
        walk.Next()
    return False


def colour_of(colour: Any) -> tuple[float, float, float]:
    """Return a colour as sRGB."""
    red, green, blue = colour.Values(Quantity.Quantity_TOC_sRGB)
    return round(red, 6), round(green, 6), round(blue, 6)  # the kernel holds float32


def bounds_something(shape: Any) -> bool:
    """Whether a face or edge is a boundary, and not marked as lying inside or outside what it belongs to."""
    return shape.Orientation() in (TopAbs.TopAbs_FORWARD, TopAbs.TopAbs_REVERSED)
