"""What no body can have, decided exactly."""

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from tests.auditing.shapes import context, skewed

from inertia.auditing.bodies import Body, Shape, cuboid
from inertia.auditing.claim import Statement
from inertia.auditing.physical import faults, margin, outside
from inertia.exchange.robots.links import Figures


def statement(inertia: object, decimals: int | None = None) -> Statement:
    body = Body(1.0, np.zeros(3), np.array(inertia, float))
    return Statement(body, np.eye(3), (None, None if decimals is None else Figures(decimals, 9)))


@pytest.mark.parametrize("eps", [1e-12, 1e-9, 1e-3])
def test_the_triangle_rule_is_decided_by_the_numbers(eps: float) -> None:
    assert not list(faults(statement(np.diag([1.0, 1.0, 2.0]))))
    assert [fault.sentence for fault in faults(statement(np.diag([1.0, 1.0, 2.0 + eps])))]
    assert Fraction(2.0 + eps) > 2


def test_rounding_breaks_no_rule() -> None:
    plate = np.diag([0.0101, 0.0203, 0.0305])
    assert list(faults(statement(plate)))
    assert not list(faults(statement(plate, 4)))
    assert list(faults(statement(plate + np.diag([0, 0, 0.0001]), 4)))  # by 2 units, where 3 halves explain 1.5


def test_rounding_of_products_counts_too() -> None:
    """With n along (1, 1, 1), normal to a plate, nᵀ(½ tr(E) − E)n is −5/2 h at least for elements of E up to h."""
    plate = 0.02 * (np.eye(3) + np.full((3, 3), 1 / 3))
    worst = 0.00005 * (np.ones((3, 3)) - 2 * np.eye(3))
    assert list(faults(statement(plate + worst)))
    assert not list(faults(statement(plate + 0.99 * worst, 4)))
    assert list(faults(statement(plate + 1.01 * worst, 4)))


@pytest.mark.parametrize(
    ("moments", "decimals", "is_explained"),
    [
        ((1, 1, 3), 0, True),
        ((1, 1, 5), 0, False),
        ((0.01, 0.01, 0.03), 2, True),
        ((0.01, 0.01, 0.05), 2, False),
        ((0.1, 0.2, 0.6), 1, False),
    ],
)
def test_one_digit_is_no_excuse(moments: tuple[float, float, float], decimals: int, is_explained: bool) -> None:
    (fault,) = faults(statement(np.diag(moments), decimals))
    assert "break the triangle rule" in fault.sentence
    assert ("rounding to so few digits explains it" in fault.sentence) is is_explained


@pytest.mark.parametrize(
    ("tensor", "words"),
    [
        (np.zeros((3, 3)), "not positive definite"),
        (np.diag([1.0, 1.0, -1.0]), "not positive definite"),
        ([[1, 2, 0], [2, 1, 0], [0, 0, 1]], "not positive definite"),
        (np.diag([1.0, 1.0, 3.0]), "50 % above the sum of the others"),
    ],
)
def test_no_body_has_it(tensor: object, words: str) -> None:
    assert words in next(faults(statement(tensor))).sentence


def test_margin() -> None:
    assert margin(statement(np.diag([2.0, 2.0, 2.0]))) == pytest.approx(1.0)
    assert margin(statement(np.diag([1.0, 1.0, 2.0]))) == pytest.approx(0.0)


def test_the_centre_lies_within_the_hull() -> None:
    shape = skewed()
    body = context([shape]).truth.body
    assert shape.hull is not None
    assert not list(outside(Statement(body, np.eye(3)), shape.hull))
    away = Statement(body._replace(center=body.center + np.array([1.0, 0.0, 0.0])), np.eye(3))
    assert "outside the convex hull" in next(outside(away, shape.hull)).sentence


def test_mass_lies_within_the_hull() -> None:
    half = np.array([0.1, 0.2, 0.3])
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    triangles = np.array([corners[[a, b, c]] for a, b, c in combinations(range(8), 3)])
    shape = Shape("box", triangles, cuboid(-half, half), np.eye(3), np.zeros(3))
    assert shape.hull is not None
    # All of the mass in the eight corners is what the hull just allows.
    second = np.diag(half**2)
    limit = np.trace(second) * np.eye(3) - second
    assert not list(outside(statement(limit), shape.hull))
    assert "allows" in next(outside(statement(1.01 * limit), shape.hull)).sentence
