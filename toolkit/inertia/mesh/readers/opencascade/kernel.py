"""What differs between versions 7 and 8 of OpenCASCADE's Python binding (OCP): collections, and casts of shapes."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from typing import Any

from OCP import TopAbs, TopoDS


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


def bounds_something(shape: Any) -> bool:
    """Whether a face or edge is a boundary, and not marked as lying inside or outside what it belongs to."""
    return shape.Orientation() in (TopAbs.TopAbs_FORWARD, TopAbs.TopAbs_REVERSED)
