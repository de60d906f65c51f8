"""Units taken for one another: millimetres, centimetres, inches, grams, pounds; in the tensor alone or in more."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from inertia.auditing.bodies import Body, Shape
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
    of_mesh: bool = False


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
    _Factors("unit_scale", "the mesh is in millimetres and its scale is not stated", "scale it", 1, 1e-3, 1e-6, True),
    _Factors("unit_scale", "the mesh is in inches and its scale is not stated", "scale it", 1, 0.0254, 0.0254**2, True),
    _Factors(
        "unit_scale", "the mesh is scaled from metres to millimetres once too often", "scale it back", 1, 1e3, 1e6, True
    ),
    _Factors("mass_scale", "the tensor is in g m² where kg m² are wanted", "divide it by 1e3", 1, 1, 1e3),
    _Factors("mass_scale", "the tensor is divided by 1e3 once too often (g to kg)", "multiply it by 1e3", 1, 1, 1e-3),
    _Factors("mass_scale", "the mass is in grams", "divide it by 1e3", 1e3, 1, 1),
    _Factors("mass_scale", "the mass is in pounds", "multiply it by 0.45359237", _POUND, 1, 1),
    _Factors("mass_scale", "the mass is divided by 1e3 once too often", "multiply it by 1e3", 1e-3, 1, 1),
)


def mistakes(context: Context) -> Iterator[Mistake]:
    """Yield mass, centre and tensor in units that are not the file's.

    Where no densities are given, the mass tells a mesh in the wrong unit from numbers in the wrong unit: the density
    that it asks for must be plausible when all mistakes are undone, and must not be before if mass or mesh are wrong.
    """
    yield from _scale_alone(context)
    plausible = context.densities is None and is_plausible(context, 1.0)
    for factors in _FACTORS:
        gross = factors.of_mesh or factors.mass in (1e3, 1e-3)
        if gross and plausible:
            continue
        density = 1 / (factors.mass * (factors.center**3 if factors.of_mesh else 1.0))
        make = partial(_scaled, factors)
        yield Mistake(factors.code, 5, factors.words, factors.remedy, make, 1 / factors.mass, factors.of_mesh, density)


def _scale_alone(context: Context) -> Iterator[Mistake]:
    """Yield the meshes scaled as the robot's file has it, the units of their own files passed over."""
    if all(shape.unit == 1 for shape in context.shapes):
        return
    bodies = tuple(_grown(shape, 1 / shape.unit) for shape in context.shapes)
    old, new = sum(shape.solid.mass for shape in context.shapes), sum(body.mass for body in bodies)
    if context.densities is not None:
        bodies = tuple(body.weighed(density) for body, density in zip(bodies, context.densities, strict=True))
    words = "it is that of meshes to which the scale alone is applied, and not the unit that stands in their files"
    remedy = f"scale them so that unit and scale together are right ({(new / old) ** (1 / 3):.4g} times as large)"
    make = partial(_instead, bodies)
    yield Mistake("unit_scale", 0, words, remedy, make, of_mesh=True, density=old / new)


def _grown(shape: Shape, factor: float) -> Body:
    """Return the solid of a shape of which every length from its own origin is times a factor."""
    solid = shape.solid
    center = shape.origin + (solid.center - shape.origin) * factor
    return Body(solid.mass * factor**3, center, solid.inertia * factor**5)


def _instead(bodies: tuple[Body, ...], claim: Claim) -> Claim:
    return replace(claim, bodies=bodies, copies=(1,) * len(bodies))


def _scaled(factors: _Factors, claim: Claim) -> Claim:
    def written(context: Context, body: Body) -> Body:
        if context.densities is None:  # the bodies are already of the mass that is stated, wrong as it is
            inertia = body.inertia * (factors.inertia / factors.mass)
            return Body(body.mass, body.center * factors.center, inertia)
        volume = factors.center**3 if factors.of_mesh else 1.0
        return Body(
            body.mass * factors.mass * volume, body.center * factors.center, body.inertia * factors.inertia * volume
        )

    return claim.then(written)
