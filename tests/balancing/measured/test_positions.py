"""Corrections split among positions: worked cases, and nothing nearer by brute force."""

import cmath
import math
from itertools import product

import numpy as np
import pytest

from inertia.balancing.corrections.correction_plane import KitWeight
from inertia.balancing.measured.positions import split_among


def whole(pieces):
    return sum(piece.vector for piece in pieces)


def degrees(*angles):
    return [math.radians(angle) for angle in angles]


def test_case_9_one_weight_a_hole():
    vector, holes = 178.484 + 614.491j, degrees(*np.arange(30, 143, 7.5))
    pieces = split_among(vector, holes, kit=[KitWeight("142 g", 142.0, None)])
    assert abs(whole(pieces) - vector) == pytest.approx(2.10035, abs=5e-4)
    assert len({piece.angle for piece in pieces}) == len(pieces)


def test_case_10_two_holes_beside_each_other():
    pieces = split_among(cmath.rect(37.3, math.radians(52)), degrees(0, 45, 60, 120))
    assert [(round(math.degrees(piece.angle)), round(piece.mass, 2)) for piece in pieces] == [(45, 20.06), (60, 17.56)]


def test_a_position_in_the_very_direction_takes_it_all():
    (piece,) = split_among(cmath.rect(3.0, math.radians(120)), degrees(0, 120, 240))
    assert (piece.mass, math.degrees(piece.angle)) == pytest.approx((3.0, 120.0))


def test_positions_that_are_full_pass_it_on():
    vector, places = 10.0 + 0j, degrees(*range(0, 360, 30))
    pieces = split_among(vector, places, most=3.0)
    assert max(piece.mass for piece in pieces) <= 3.0 + 1e-12
    assert abs(whole(pieces) - vector) < 1e-9


def test_what_cannot_be_reached_is_come_nearest():
    pieces = split_among(-1.0 + 0j, degrees(0, 30, 60))
    assert pieces == ()
    pieces = split_among(cmath.rect(1.0, math.radians(80)), degrees(0, 30, 60))
    assert [(round(math.degrees(piece.angle)), round(piece.mass, 9)) for piece in pieces] == [
        (60, round(math.cos(math.radians(20)), 9))
    ]


@pytest.mark.parametrize("seed", range(5))
def test_rounding_is_the_best_of_all(seed):
    random = np.random.default_rng(seed)
    vector = complex(*random.normal(size=2)) * 10
    places = degrees(*range(0, 360, 45))
    exact, rounded = split_among(vector, places), split_among(vector, places, step=0.5)
    below = [math.floor(piece.mass / 0.5) * 0.5 for piece in exact]
    tries = product(*([low, low + 0.5] for low in below))
    best = min(abs(sum(m * cmath.exp(1j * k.angle) for m, k in zip(one, exact, strict=True)) - vector) for one in tries)
    assert abs(whole(rounded) - vector) == pytest.approx(best, abs=1e-12)


def test_anywhere_it_is_one_mass():
    (piece,) = split_among(-2.26j, None, step=0.5)
    assert (piece.mass, math.degrees(piece.angle)) == (2.5, 270.0)
    assert split_among(0.1, None, step=0.5) == ()


def test_stocks_of_a_kit_are_kept():
    pieces = split_among(10.0 + 0j, [0.0], kit=[KitWeight("5", 5.0, 1), KitWeight("2", 2.0, None)], most_pieces=3)
    assert {piece.item: piece.pieces for piece in pieces} == {"5": 1, "2": 2}
