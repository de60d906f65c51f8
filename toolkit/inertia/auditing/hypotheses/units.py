"""Units taken for one another: millimetres, centimetres, inches, grams, pounds; in the tensor alone or in more."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from inertia.auditing.bodies import Body
from inertia.auditing.claim import Claim, Context, Mistake
from inertia.auditing.densities import is_plausible

_INCH = 1 / 0.0254
_POUND = 1 / 0.45359237


class _Factors(NamedTuple):
    """What mass, centre and tensor are multiplied by."""

    code: str
    words: str
    remedy: str
    mass: float
    center: float
    inertia: float


_FACTORS = (
    _Factors("unit_scale", "the tensor is in kg mm² where kg m² are wanted", "divide it by 1e6", 1, 1, 1e6),
    _Factors("unit_scale", "the tensor is in kg cm² where kg m² are wanted", "divide it by 1e4", 1, 1, 1e4),
    _Factors("unit_scale", "the tensor is in g mm² where kg m² are wanted", "divide it by 1e9", 1, 1, 1e9),
    _Factors("unit_scale", "the tensor is in g cm² where kg m² are wanted", "divide it by 1e7", 1, 1, 1e7),
    _Factors("unit_scale", "the tensor is divided by 1e6 once too often (mm² to m²)", "multiply it by 1e6", 1, 1, 1e-6),
    _Factors("unit_scale", "the tensor is divided by 1e9 once too often", "multiply it by 1e9", 1, 1, 1e-9),
    _Factors("unit_scale", "the tensor is in kg in² where kg m² are wanted", "multiply it by 0.0254²", 1, 1, _INCH**2),
    _Factors(
        "unit_scale",
        "the tensor is in lb in² where kg m² are wanted",
        "multiply it by 2.9264e-4",
        1,
        1,
        _INCH**2 * _POUND,
    ),
    _Factors("unit_scale", "centre and tensor are in millimetres", "state them in metres", 1, 1e3, 1e6),
    _Factors("unit_scale", "centre and tensor are in inches", "state them in metres", 1, _INCH, _INCH**2),
    _Factors("unit_scale", "the centre of mass is in millimetres", "state it in metres", 1, 1e3, 1),
    _Factors("mass_scale", "the tensor is in g m² where kg m² are wanted", "divide it by 1e3", 1, 1, 1e3),
    _Factors("mass_scale", "the tensor is divided by 1e3 once too often (g to kg)", "multiply it by 1e3", 1, 1, 1e-3),
    _Factors("mass_scale", "the mass is in grams", "divide it by 1e3", 1e3, 1, 1),
    _Factors("mass_scale", "the mass is in pounds", "multiply it by 0.45359237", _POUND, 1, 1),
    _Factors("mass_scale", "the mass is divided by 1e3 once too often", "multiply it by 1e3", 1e-3, 1, 1),
)

_SCALES = (
    (1e-3, "in millimetres"),
    (1e-2, "in centimetres"),
    (0.0254, "in inches"),
    (1e3, "scaled from metres to millimetres once too often"),
)
"""What a mesh has to be multiplied by, and what is the matter with it."""

_ALL = 12
"""Meshes of a link up to which each may be the only one of another unit."""


def mistakes(context: Context) -> Iterator[Mistake]:
    """Yield mass, centre and tensor in units that are not the file's.

    Where no densities are given, the mass tells a mesh in the wrong unit from numbers in the wrong unit: the density
    that it asks for must be plausible when all mistakes are undone, and must not be before if mass or mesh are wrong.
    """
    yield from _scale_alone(context)
    plausible = context.densities is None and is_plausible(context, 1.0)
    if not plausible:
        yield from _scale_missing(context)
    for factors in _FACTORS:
        if factors.mass in (1e3, 1e-3) and plausible:
            continue
        make = partial(_scaled, factors)
        yield Mistake(factors.code, 5, factors.words, factors.remedy, make, 1 / factors.mass, density=1 / factors.mass)


def _scale_alone(context: Context) -> Iterator[Mistake]:
    """Yield the meshes scaled as the robot's file has it, the units of their own files passed over."""
    if all(shape.unit == 1 for shape in context.shapes):
        return
    factors = [1 / shape.unit for shape in context.shapes]
    density = _shrunk(context, factors)
    words = "it is that of meshes to which the scale alone is applied, and not the unit that stands in their files"
    remedy = f"scale them so that unit and scale together are right ({density ** (-1 / 3):.4g} times as large)"
    yield Mistake("unit_scale", -1, words, remedy, partial(_grown, factors, False), of_mesh=True, density=density)


def _scale_missing(context: Context) -> Iterator[Mistake]:
    """Yield meshes in another unit, which are scaled where they are placed; one of them; all, and their places."""
    shapes = context.shapes
    meshes = [k for k, shape in enumerate(shapes) if shape.surface is None] or list(range(len(shapes)))
    each = meshes if 1 < len(meshes) <= _ALL else []
    for factor, what in _SCALES:
        unstated, back = (" and its scale is not stated", "") if factor < 1 else ("", " back")
        choices = [(f"the mesh is {what}{unstated}", f"scale it{back}", meshes, False)]
        choices += [(f"{shapes[k].name} is {what}{unstated}", f"scale it{back}", [k], False) for k in each]
        if any(shape.origin.any() for shape in shapes):
            words, remedy = f"the mesh and its origin are {what}", f"scale both{back}"
            choices.append((words, remedy, list(range(len(shapes))), True))
        for words, remedy, chosen, with_origin in choices:
            factors = [factor if k in chosen else 1.0 for k in range(len(shapes))]
            make, density = partial(_grown, factors, with_origin), _shrunk(context, factors)
            yield Mistake("unit_scale", -1, words, remedy, make, of_mesh=True, density=density)


def _shrunk(context: Context, factors: Sequence[float]) -> float:
    """Return what the density becomes times that the mass asks for, where lengths of the shapes are times factors."""
    volumes = [shape.solid.mass for shape in context.shapes]
    return sum(volumes) / sum(volume * factor**3 for volume, factor in zip(volumes, factors, strict=True))


def _grown(factors: Sequence[float], with_origin: bool, claim: Claim) -> Claim:
    """Return what there is to be stated of shapes that are scaled, which is measured by the size that they have."""
    pairs = zip(claim.context.shapes, factors, strict=True)
    shapes = [shape if factor == 1 else shape.grown(factor, with_origin=with_origin) for shape, factor in pairs]
    return replace(claim.context, shapes=shapes).truth


def _scaled(factors: _Factors, claim: Claim) -> Claim:
    def written(context: Context, body: Body) -> Body:
        if context.densities is None:  # the bodies are already of the mass that is stated, wrong as it is
            inertia = body.inertia * (factors.inertia / factors.mass)
            return Body(body.mass, body.center * factors.center, inertia)
        return Body(body.mass * factors.mass, body.center * factors.center, body.inertia * factors.inertia)

    return claim.then(written)
