import itertools
import math

import numpy as np
import pytest
from tests.balancing.corrections.workpieces import STEEL, drilled

from inertia.balancing.corrections.correction_plane import Sector
from inertia.balancing.corrections.drilling import RadialDrill
from inertia.balancing.corrections.rounding import Place, rounded

LEVERS = np.array([[0.75, 0.25], [0.25, 0.75]])
LIMITS = np.array([1e-4, 2e-4])


def place(number, degrees, depth, **options):
    plane = drilled("I", 90, 100, 12, **{"max_depth": 20, **options})
    return Place(number, RadialDrill(plane, STEEL, diameter=0.012), math.radians(degrees), 1e-3 * depth)


def badness(places, start, residual):
    change = sum(LEVERS[:, k.plane] * (k.vector - s.vector) for k, s in zip(places, start, strict=True))
    return (np.abs((residual + change) / LIMITS) ** 2).sum()


def test_of_all_ways_up_and_down_the_one_that_leaves_the_least():
    start = [place(0, 210.2, 9.137), place(1, 20.37, 12.381), place(1, 44.9, 5.03)]
    residual = np.array([2e-6 + 1e-6j, -1e-6j])
    places = rounded(start, LEVERS, residual, LIMITS)
    depths = [(math.floor(1e4 * k.setting) + up) / 1e4 for k in start for up in (0, 1)]
    angles = [math.radians((math.floor(2 * math.degrees(k.angle)) + up) / 2) for k in start for up in (0, 1)]
    ways = itertools.product(
        *(itertools.product(angles[2 * i : 2 * i + 2], depths[2 * i : 2 * i + 2]) for i in range(3))
    )
    every = [[Place(k.plane, k.tool, a, d) for k, (a, d) in zip(start, way, strict=True)] for way in ways]
    assert len(every) == 64
    assert badness(places, start, residual) == pytest.approx(min(badness(k, start, residual) for k in every))
    assert all(1e4 * k.setting == pytest.approx(round(1e4 * k.setting), abs=1e-9) for k in places)
    assert all(2 * math.degrees(k.angle) == pytest.approx(round(2 * math.degrees(k.angle)), abs=1e-9) for k in places)


def test_never_deeper_than_the_limit_nor_into_a_forbidden_sector():
    reach = math.degrees(math.asin(0.06))
    sector = Sector(math.radians(100.2), math.radians(150))
    start = [place(0, 100.2 - reach, 9.99, max_depth=9.95, forbidden=(sector,))]
    places = rounded(start, LEVERS, np.zeros(2, complex), LIMITS)
    assert places[0].setting == pytest.approx(9.9e-3)
    assert math.degrees(places[0].angle) == pytest.approx(math.floor(2 * (100.2 - reach)) / 2)


def test_listed_angles_stay_and_no_step_leaves_as_it_is():
    start = [place(0, 33.3, 9.137, angles=(math.radians(33.3),)), place(1, 20.37, 12.381, depth_step=0, angle_step=0)]
    places = rounded(start, LEVERS, np.zeros(2, complex), LIMITS)
    assert places[0].angle == start[0].angle
    assert places[1] == start[1]


def test_many_places_are_rounded_in_no_time_and_well():
    start = [place(k % 2, 13.37 * k, 5.0 + 0.137 * k) for k in range(24)]
    places = rounded(start, LEVERS, np.zeros(2, complex), LIMITS)
    nearest = [
        Place(k.plane, k.tool, math.radians(round(2 * math.degrees(k.angle)) / 2), round(1e4 * k.setting) / 1e4)
        for k in start
    ]
    assert badness(places, start, np.zeros(2)) < badness(nearest, start, np.zeros(2))


def test_a_depth_is_not_rounded_into_the_wall():
    start = [Place(0, place(0, 30, 5.07).tool, math.radians(30), 5.07e-3, limit=5.08e-3)]
    assert rounded(start, LEVERS, np.zeros(2, complex), LIMITS)[0].setting == pytest.approx(5.0e-3)
