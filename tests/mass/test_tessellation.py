"""What lies between a mesh and the surface it stands for: the chord bound holds, and Richardson's estimate is near."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.mass.parts import surface

import inertia
from inertia.errors import GeometryError, UsageError

CYLINDERS = [(1.0, 2.0, 24), (1.0, 0.1, 96), (0.2, 3.0, 64)]


def cylinder(radius: float, height: float, count: int, *, circumscribed: bool = False) -> np.ndarray:
    """Return a prism over a regular polygon whose corners (or whose flats) lie on the cylinder."""
    outer = radius / math.cos(math.pi / count) if circumscribed else radius
    angle = 2 * math.pi * np.arange(count) / count
    low = np.stack([outer * np.cos(angle), outer * np.sin(angle), np.zeros(count)], axis=1)
    up = np.array([0, 0, height])
    high = low + up
    following = np.roll(np.arange(count), -1)
    sides = [[low, low[following], high], [high, low[following], high[following]]]
    caps = [[np.zeros_like(low), low[following], low], [np.zeros_like(low) + up, high, high[following]]]
    return np.concatenate([np.stack(corners, axis=1) for corners in (*sides, *caps)])


def sag(radius: float, count: int, *, circumscribed: bool = False) -> float:
    return radius * ((1 / math.cos(math.pi / count) - 1) if circumscribed else (1 - math.cos(math.pi / count)))


@pytest.mark.parametrize("circumscribed", [False, True])
@pytest.mark.parametrize(("radius", "height", "count"), CYLINDERS)
def test_the_chord_bound_covers_the_true_cylinder(
    radius: float, height: float, count: int, circumscribed: bool
) -> None:
    part = surface(cylinder(radius, height, count, circumscribed=circumscribed))
    chord = sag(radius, count, circumscribed=circumscribed)
    analysis = inertia.analyse(part, 1.0, chord=chord)
    bound, properties = analysis.tessellation, analysis.properties
    assert bound is not None
    volume = math.pi * radius**2 * height
    across, along = volume * (3 * radius**2 + height**2) / 12, volume * radius**2 / 2
    tensor = np.diag([across, across, along])
    assert abs(properties.volume - volume) <= bound.volume * properties.volume
    assert np.linalg.norm(properties.inertia - tensor) <= bound.inertia * np.linalg.norm(properties.inertia)
    assert np.linalg.norm(properties.center_of_mass - [0, 0, height / 2]) <= bound.center_of_mass
    # It is of use: the sides alone really lose two thirds of area times sag.
    assert bound.volume * properties.volume < 3 * chord * analysis.area


def test_the_bound_goes_with_the_density_the_unit_and_the_place() -> None:
    corners = cylinder(1.0, 2.0, 48)
    here = inertia.analyse(surface(corners), 1.0, chord=sag(1.0, 48))
    there = inertia.analyse(surface(1000 * corners + [5e4, 0, 0], unit="mm"), 7850.0, chord=1000 * sag(1.0, 48))
    assert here.tessellation is not None
    assert there.tessellation is not None
    for name in ("volume", "mass", "inertia"):
        assert getattr(there.tessellation, name) == pytest.approx(getattr(here.tessellation, name), rel=1e-6)
    assert there.tessellation.center_of_mass == pytest.approx(here.tessellation.center_of_mass, rel=1e-6)
    assert "chord" in here.tessellation.method


def test_a_weighed_mass_is_certain() -> None:
    analysis = inertia.analyse(surface(cylinder(1.0, 2.0, 48)), mass=3.0, chord=1e-3).tessellation
    assert analysis is not None
    assert analysis.mass < 1e-15
    assert analysis.volume > 1e-4


def test_without_a_tolerance_nothing_is_claimed() -> None:
    assert inertia.analyse(surface(cylinder(1.0, 2.0, 48))).tessellation is None


@pytest.mark.parametrize("chord", [0.0, -1.0, math.nan, math.inf])
def test_unusable_tolerances_are_refused(chord: float) -> None:
    with pytest.raises(UsageError, match="chord tolerance"):
        inertia.analyse(surface(cylinder(1.0, 2.0, 48)), chord=chord)


def test_a_tolerance_as_large_as_the_part_is_refused() -> None:
    with pytest.raises(GeometryError, match="nothing certain"):
        inertia.analyse(surface(cylinder(1.0, 2.0, 48)), chord=1.0)


def test_a_tolerance_is_for_surfaces_of_solids() -> None:
    with pytest.raises(UsageError, match="solid"):
        inertia.analyse(surface(cylinder(1.0, 2.0, 48)), shell=0.1, chord=1e-3)


@pytest.mark.parametrize("count", [24, 48, 96])
def test_richardson_estimates_the_error_of_the_finer_mesh(count: int) -> None:
    """Of a prism in a cylinder, with x = 2π/n: the estimate is short by a share of x² that the series give.

    Left out are c₁x² − c₂x⁴, of the volume π h (1 − x²/6 + x⁴/120) and of moments with J = π/2 (1 − x²/3 + x⁴/20). The
    estimate is x²/4 |c₁ − 5/4 c₂x²| and the error x²/4 |c₁ − 1/4 c₂x²|, which is more by a share of x² c₁·c₂/|c₁|².
    """
    coarse, fine = (inertia.mass_properties(surface(cylinder(1.0, 2.0, k)), 1.0) for k in (count, 2 * count))
    estimate = inertia.richardson(coarse, fine)
    short = (1 - estimate.volume * fine.volume / (2 * math.pi - fine.volume)) / (2 * math.pi / count) ** 2
    assert short == pytest.approx(1 / 20, abs=1 / count**2)
    tensor = 2 * math.pi * np.diag([(3 + 4) / 12, (3 + 4) / 12, 1 / 2])
    true = np.linalg.norm(fine.inertia - tensor) / np.linalg.norm(fine.inertia)
    second, fourth = np.array([5 / 18, 5 / 18, 1 / 3]), np.array([11, 11, 18]) / 360
    short = (1 - estimate.inertia / true) / (2 * math.pi / count) ** 2
    assert short == pytest.approx(second @ fourth / (second @ second), abs=1 / count**2)
    assert "Richardson" in estimate.method


def test_richardson_refuses_what_is_no_ratio() -> None:
    part = inertia.mass_properties(surface(cylinder(1.0, 2.0, 24)), 1.0)
    for options in ({"ratio": 1.0}, {"ratio": math.nan}, {"order": 0.0}):
        with pytest.raises(UsageError, match="ratio"):
            inertia.richardson(part, part, **options)
