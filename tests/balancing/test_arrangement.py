"""Positions and orders of parts: against all of them written down, and bounds against many tried at random."""

import itertools

import numpy as np
import pytest

from inertia.balancing import arrangement_program
from inertia.balancing.arrangement import Choice
from inertia.balancing.indexing import best_answer


def orders(count, seed, planes=2):
    """Return what part i brings at place j: weights that scatter by 3 %, evenly around the shaft."""
    draw = np.random.default_rng(seed)
    weights = 1 + 0.03 * draw.normal(size=count)
    places = np.exp(2j * np.pi * np.arange(count) / count)
    return weights[:, None, None] * places[None, :, None] * np.array([0.6, 0.4])[:planes]


def positions(count, seed, size=0.05):
    draw = np.random.default_rng(seed)
    vector = size * (draw.normal(size=2) + 1j * draw.normal(size=2))
    return vector * np.exp(2j * np.pi * np.arange(count) / count)[:, None]


def left(choice, places, turns=()):
    whole = choice.start.copy()
    for option, k in zip(choice.options, turns, strict=True):
        whole = whole + option[k]
    for order, place in zip(choice.orders, places, strict=True):
        for part, where in enumerate(place):
            whole = whole + order[part, where]
    return float(np.abs(whole).max())


@pytest.mark.parametrize("seed", range(6))
def test_no_order_and_no_position_is_better(seed):
    choice = Choice(
        np.array([0.02 + 0.01j, -0.01j]), (positions(3, seed), positions(2, seed + 50)), (orders(5, seed + 100),)
    )
    answer = best_answer(choice)
    ways = [
        left(choice, [place], turns)
        for place in itertools.permutations(range(5))
        for turns in itertools.product(range(3), range(2))
    ]
    assert answer.left == pytest.approx(min(ways), rel=1e-12)
    assert answer.bound == answer.left == pytest.approx(left(choice, answer.places, answer.positions), rel=1e-12)
    assert choice.ways == len(ways)


def test_the_halves_of_ten_places_have_the_best_of_all_orders():
    order = orders(10, 3)
    order[3:] = order[3]  # seven of the parts are equal, so that it counts where the three others are
    choice = Choice(np.array([0.02 + 0.01j, 0.01j]), (), (order,))
    answer = best_answer(choice)
    ways = []
    for places in itertools.permutations(range(10), 3):
        others = [place for place in range(10) if place not in places]
        ways.append(left(choice, [[*places, *others]]))
    assert answer.left == answer.bound == pytest.approx(min(ways), rel=1e-12)


def test_equal_parts_stay_where_they_are():
    order = np.broadcast_to(orders(10, 0)[:1], (10, 10, 2)).copy()
    answer = best_answer(Choice(np.array([0.3 + 0j, 0.1j]), (), (order,)))
    assert answer.places == (tuple(range(10)),)
    assert answer.left == answer.bound == pytest.approx(0.3)


def test_where_too_much_is_open_a_bound_says_how_far_the_best_may_be(monkeypatch):
    monkeypatch.setattr(arrangement_program, "NODES", 20)
    choice = Choice(np.array([0.02 + 0j, 0.015j]), (), (orders(13, 1),))
    answer = best_answer(choice)
    draw = np.random.default_rng(0)
    tried = min(left(choice, [draw.permutation(13)]) for _ in range(2000))
    assert 0 <= answer.bound <= answer.left < tried
    assert answer.left == pytest.approx(left(choice, answer.places), rel=1e-12)


def test_the_program_proves_what_halves_cannot():
    options = tuple(positions(8, seed, 0.1) for seed in range(8))
    choice = Choice(np.array([100.0 + 0j, 99.0 + 1j]), options)
    answer = best_answer(choice)
    assert answer.left - 1e-4 < answer.bound <= answer.left
    one_by_one = choice.start[0].real - sum(np.abs(option[:, 0]).max() for option in options)
    assert answer.bound > one_by_one  # no part can do more than point away from what is fixed
