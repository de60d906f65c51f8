"""Other shapes weighed than the link has: one left out or counted twice, shell, hull, box, mirror image."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from inertia.auditing.bodies import Body, Shape, cuboid
from inertia.auditing.claim import Claim, Context, Mistake

_ALL = 12
"""Shapes of a link up to which leaving out and counting twice are tried for each."""

_FACETS = 0.02
"""Of the tensor of a shell: what 500 facets of a ball are off."""

_Bodies = Callable[[Context], list[Body]]
"""What is weighed, of what a claim is made about: its meshes may be scaled."""


def mistakes(context: Context) -> Iterator[Mistake]:
    """Yield what else may have been weighed in place of the shapes of the link."""
    shapes, known = context.shapes, context.densities is not None

    def of(code: str, words: str, bodies: _Bodies, remedy: str = "weigh the meshes as solids") -> Mistake:
        return Mistake(code, 0, words, remedy, partial(_with, bodies))

    if not known:
        shells = of("shell_for_solid", _shell(context), lambda about: [shape.shell for shape in about.shapes])
        yield replace(shells, blur=_FACETS if any(shape.surface is None for shape in shapes) else 0.0)
    words = "it is that of the convex hulls of the meshes"
    yield of("hull_for_mesh", words, lambda about: [shape.hull_solid for shape in about.shapes])
    words, remedy = "it is what MuJoCo's legacy rule counts of the meshes", 'write inertia="exact" in their <mesh>'
    yield of("hull_for_mesh", words, lambda about: [shape.legacy_solid for shape in about.shapes], remedy)
    words = "it is that of the boxes around the meshes"
    yield of("hull_for_mesh", words, lambda about: [shape.box_solid for shape in about.shapes])
    if len(shapes) > 1 and not known:
        yield of("hull_for_mesh", "it is that of one box around all meshes", lambda about: [_box(about.shapes)])
    if context.collisions and not known:
        words, remedy = "it is that of the collision geometry", "weigh the visual meshes"
        yield of("hull_for_mesh", words, lambda about: [shape.solid for shape in about.collisions], remedy)
    if 1 < len(shapes) <= _ALL:
        for k, shape in enumerate(shapes):
            words, remedy = f"{shape.name} is left out", f"count {shape.name} in"
            yield Mistake("mesh_left_out", 1, words, remedy, partial(_without, k))
            words, remedy = f"{shape.name} is counted twice, or twice as dense", f"count {shape.name} once"
            yield Mistake("mesh_counted_twice", 1, words, remedy, partial(_twice, k))
    for axis, name in enumerate("xyz"):
        words = f"it is that of the twin mirrored in {name}"
        yield Mistake("mirrored", 1, words, "weigh this side's own meshes", partial(_mirrored, axis))


def _box(shapes: Sequence[Shape]) -> Body:
    low, high = zip(*(shape.box for shape in shapes), strict=True)
    return cuboid(np.min(low, axis=0), np.max(high, axis=0))


def _shell(context: Context) -> str:
    mass = context.stated.body.mass
    area = sum(shape.shell.mass for shape in context.shapes)
    thickness = 1e3 * mass / area
    return (
        "it is that of thin shells, not of solids (of the stated mass if they are "
        f"{thickness / 1040:.2g} mm thick in ABS, {thickness / 2700:.2g} mm in aluminium)"
    )


def _with(weighed: _Bodies, claim: Claim) -> Claim:
    bodies, weights = weighed(claim.context), claim.context.densities
    if weights is not None and len(bodies) == len(claim.context.shapes):
        bodies = [body.weighed(density) for body, density in zip(bodies, weights, strict=True)]
    return replace(claim, bodies=tuple(bodies), copies=(1,) * len(bodies))


def _without(number: int, claim: Claim) -> Claim:
    return _counted(number, 0, claim)


def _twice(number: int, claim: Claim) -> Claim:
    return _counted(number, 2, claim)


def _counted(number: int, count: int, claim: Claim) -> Claim:
    if len(claim.copies) != len(claim.context.shapes):  # others were weighed in their place
        return claim
    return replace(claim, copies=tuple(count if k == number else n for k, n in enumerate(claim.copies)))


def _mirrored(axis: int, claim: Claim) -> Claim:
    return replace(claim, bodies=tuple(body.mirrored(axis) for body in claim.bodies))
