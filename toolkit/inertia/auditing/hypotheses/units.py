"""Units taken for one another: millimetres, centimetres, inches, grams, pounds; in the tensor alone or in more."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import NamedTuple

from inertia.auditing.bodies import Body
from inertia.auditing.claim import Claim, Context, Mistake
from inertia.auditing.densities import PLAUSIBLE

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
    that it asks for must be plausible when the mistake is undone, and must not be before if mass or mesh are wrong.
    """
    density = context.stated.body.mass / sum(shape.solid.mass for shape in context.shapes)
    for factors in _FACTORS:
        if context.densities is None and not _plausible(factors, density):
            continue
        make = partial(_scaled, factors)
        yield Mistake(factors.code, 5, factors.words, factors.remedy, make, 1 / factors.mass, factors.of_mesh)


def _plausible(factors: _Factors, density: float) -> bool:
    least, greatest = PLAUSIBLE
    undone = density / factors.mass / (factors.center**3 if factors.of_mesh else 1.0)
    gross = factors.of_mesh or factors.mass in (1e3, 1e-3)
    return least <= undone <= greatest and not (gross and least <= density <= greatest)


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
