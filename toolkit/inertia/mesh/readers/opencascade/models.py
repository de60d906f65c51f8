"""Models of cadquery and build123d, and shapes of OpenCASCADE's binding, in memory: true shapes and triangles."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from OCP import TopLoc

from inertia.errors import UsageError
from inertia.mesh.readers.opencascade.convert import Bodies
from inertia.mesh.readers.opencascade.document import Colour, Piece
from inertia.mesh.readers.opencascade.kernel import bodies_of, colour_of, has_faces, parts_of, tessellated

_Named = tuple[Any, tuple[str, ...], Colour | None]


def bodies_in(model: Any, linear: float, angular: float) -> tuple[Bodies, int]:
    """Return the bodies of a model, and how many pieces of wire it has beside; the model itself is left as it is.

    Parameters
    ----------
    model : a shape, workplane, builder or assembly, or several in a list
    linear : sag of the triangles relative to the length of an edge
    angular : angle in radians

    Raises `UsageError` where it has no face.
    """
    bodies, loose = Bodies(linear, angular, 1.0, in_memory=True), 0
    for shape, path, colour in _shapes(model, (), None):
        for body in bodies_of(shape):
            if tessellated(body):
                raise UsageError(
                    f"this {type(model).__name__} has triangles without surfaces: give the triangles as a mesh"
                )
            if has_faces(body):
                here, name = body.Located(TopLoc.TopLoc_Location()), path[-1] if path else None
                bodies.add(Piece(here, body.Location(), name, path[:-1], colour, 0, body.Location()))
            else:
                loose += 1
    if not bodies.solids:
        raise UsageError(f"this {type(model).__name__} has no solid and no face: give the solid")
    return bodies, loose


def _shapes(model: Any, path: tuple[str, ...], colour: Colour | None) -> Iterator[_Named]:
    """Yield the shapes of OpenCASCADE in a model, each with its names from the outermost on, and its colour."""
    if hasattr(model, "toCompound"):  # an assembly of cadquery
        for shape, name, location, shade in model:
            yield shape.wrapped.Moved(location.wrapped), tuple(name.split("/")), _colour(shade)
    elif isinstance(model, list | tuple) or hasattr(model, "vals"):  # what a workplane has on its stack
        for each in model if isinstance(model, list | tuple) else model.vals():
            yield from _shapes(each, path, colour)
    elif hasattr(model, "part"):  # a builder of build123d
        yield from _shapes(model.part, path, colour)
    else:
        with suppress(AssertionError):  # by which build123d says that there is no shape yet
            yield from _labelled(model, getattr(model, "wrapped", model), path, colour)


def _labelled(model: Any, shape: Any, path: tuple[str, ...], colour: Colour | None) -> Iterator[_Named]:
    """Yield a shape, or the parts that it is made of where these have labels or colours of their own."""
    if not hasattr(shape, "ShapeType") or shape.IsNull():  # a point, a vector, a place, nothing yet
        return
    label, children = getattr(model, "label", ""), getattr(model, "children", ())
    path, colour = (*path, label) if label else path, _colour(getattr(model, "color", None)) or colour
    parts = list(parts_of(shape)) if children and isinstance(children, tuple) else []
    if len(parts) != len(children) or not parts:
        yield shape, path, colour
        return
    for child, part in zip(children, parts, strict=True):  # which are where the whole is, as the children are not
        yield from _labelled(child, part, path, colour)


def _colour(colour: Any) -> Colour | None:
    return None if colour is None else colour_of(colour.wrapped.GetRGB())
