"""Corrections split among positions: worked cases, and nothing nearer by brute force."""

import cmath
import math
from collections import Counter
from itertools import combinations_with_replacement, product

import numpy as np
import pytest
import scipy.optimize
from hypothesis import given, settings
from hypothesis import strategies as st

from inertia.balancing.corrections.correction_plane import KitWeight
from inertia.balancing.measured.positions import split_among


def whole(pieces):
    return sum(piece.vector for piece in pieces)


def mass(pieces):
    return sum(piece.mass for piece in pieces)


def degrees(*angles):
    return [math.radians(angle) for angle in angles]


def left_without(pieces, vector):
    """Return the least that any choice of fewer of the weights leaves, by all there are."""
    single = [piece.vector / piece.pieces for piece in pieces for _ in range(piece.pieces)]
    kept = np.indices([2] * len(single)).reshape(len(single), -1).T[:-1]
    return float(np.abs(kept @ np.array(single) - vector).min())


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


@pytest.mark.parametrize(("count", "most"), [(12, 2), (12, 5), (36, 10)])
def test_kits_with_more_choices_than_can_be_listed_take_few_weights_and_none_of_as_many_are_nearer(count, most):
    vector, angles = cmath.rect(12.3, 1.1), [2 * math.pi * k / count for k in range(count)]
    pieces = split_among(vector, angles, kit=[KitWeight("5", 5.0, None), KitWeight("2", 2.0, None)], most_pieces=most)
    number = sum(piece.pieces for piece in pieces)
    assert number <= 4
    assert all(sum(k.pieces for k in pieces if k.angle == angle) <= most for angle in angles)
    kinds = [(k, mass * cmath.exp(1j * angle)) for k, angle in enumerate(angles) for mass in (5.0, 2.0)]
    nearest = min(
        abs(sum(effect for _, effect in choice) - vector)
        for fewer in range(number + 1)
        for choice in combinations_with_replacement(kinds, fewer)
        if max(Counter(place for place, _ in choice).values(), default=0) <= most
    )
    assert abs(whole(pieces) - vector) == pytest.approx(nearest, rel=1e-4)
    assert nearest < 0.05 * abs(vector)


def test_steps_are_those_of_the_shop_however_light_the_rotor_is():
    for unit in (1e-15, 1.0, 1e9):
        (piece,) = split_among(0.74j * unit, None, step=0.1 * unit)
        assert piece.mass == pytest.approx(0.7 * unit, rel=1e-12)


@pytest.mark.parametrize(
    ("places", "more"),
    [
        (None, {"step": 4.0}),
        ([0.0, 0.5, 3.0], {"step": 4.0}),
        ([0.0, 0.5, 3.0], {"kit": [KitWeight("4", 4.0, None)], "most_pieces": 4}),
    ],
)
def test_steps_and_weights_do_not_pass_the_limit_of_the_whole(places, more):
    vector = cmath.rect(11.0, 0.1)
    assert abs(whole(split_among(vector, places, **more))) > 11.1
    limited = split_among(vector, places, most_in_all=11.0, **more)
    assert abs(whole(limited)) > 6.0
    assert mass(limited) <= 11.0
    assert split_among(vector, places, most_in_all=0.5, **more) == ()


@settings(deadline=None, max_examples=40)
@given(
    st.integers(1, 4),
    st.floats(0, 6.3),
    st.lists(st.floats(-1, 0), min_size=1, max_size=2),
    st.integers(1, 2),
    st.floats(-1.2, 0.5),
    st.floats(-1.2, 0.5),
)
def test_of_a_kit_no_choice_within_the_limit_is_nearer(
    count: int, turn: float, sizes: list[float], most: int, far: float, limit: float
) -> None:
    """Against all choices there are."""
    vector, cap = complex(10.0**far), 10.0**limit
    angles = [turn + 2 * math.pi * k / count for k in range(count)]
    kit = [KitWeight(f"w{k}", 10.0**size, None) for k, size in enumerate(sizes)]
    at_one = [numbers for numbers in product(range(most + 1), repeat=len(kit)) if sum(numbers) <= most]
    masses = [sum(n * weight.mass for n, weight in zip(numbers, kit, strict=True)) for numbers in at_one]
    nearest = min(
        abs(sum(mass * cmath.exp(1j * angle) for mass, angle in zip(choice, angles, strict=True)) - vector)
        for choice in product(masses, repeat=count)
        if sum(choice) <= cap * (1 - 1e-5)
    )
    pieces = split_among(vector, angles, most_in_all=cap, kit=kit, most_pieces=most)
    assert mass(pieces) <= cap * (1 + 1e-5)
    assert abs(whole(pieces) - vector) <= nearest + 2e-5 * max(weight.mass for weight in kit)


@pytest.mark.parametrize(("count", "limit"), [(4, 8.0), (6, 8.0), (8, 8.0), (4, math.inf), (6, math.inf)])
@pytest.mark.parametrize("enough", [0.0, 0.3])
def test_of_a_kit_no_weights_are_opposed_where_one_is_too_heavy(count: int, limit: float, enough: float) -> None:
    """Of 1 g, 3 g leave more at any position, and two opposed ones as much as none."""
    places = degrees(*(360 * k / count for k in range(count)))
    for angle in np.arange(1.5, 360, 9):
        vector = cmath.rect(1.0, math.radians(angle))
        assert split_among(vector, places, most_in_all=limit, kit=[KitWeight("3", 3.0, None)], enough=enough) == ()


@settings(deadline=None, max_examples=80)
@given(
    st.integers(2, 8),
    st.sampled_from([0.0, 0.3]),
    st.lists(st.sampled_from([0.5, 1.0, 1.5, 2.0, 2.9, 3.0, 5.8]), min_size=1, max_size=3, unique=True),
    st.integers(1, 2),
    st.complex_numbers(max_magnitude=12.0),
    st.floats(0.4, 12.0),
    st.sampled_from([0.0, 0.5]),
)
def test_of_a_kit_no_weights_are_mounted_that_can_be_left_out(
    count: int, turn: float, sizes: list[float], most: int, vector: complex, cap: float, enough: float
) -> None:
    """Against all choices of fewer of them; within the limit, against all choices there are too."""
    angles = [turn + 2 * math.pi * k / count for k in range(count)]
    kit = [KitWeight(f"{size} g", size, None) for size in sizes]
    for limit in (cap, math.inf):
        pieces = split_among(vector, angles, most_in_all=limit, kit=kit, most_pieces=most, enough=enough)
        number = sum(piece.pieces for piece in pieces)
        if 0 < number <= 12:
            assert left_without(pieces, vector) > abs(whole(pieces) - vector) + 1e-12
        if limit < math.inf and count <= 4 and not enough:
            at_one = np.array([k for k in product(range(most + 1), repeat=len(kit)) if sum(k) <= most])
            choices = np.indices([len(at_one)] * count).reshape(count, -1).T
            masses = (at_one @ sizes)[choices]
            within = masses.sum(axis=1) <= cap
            left = np.abs(masses[within] @ np.exp(1j * np.array(angles)) - vector)
            numbers = at_one.sum(axis=1)[choices][within].sum(axis=1)
            assert abs(whole(pieces) - vector) <= left.min() + 1e-7
            assert number == numbers[left <= left.min() + 1e-10].min()


@pytest.mark.parametrize(
    ("masses", "most", "limit"),
    [([0.01, 0.013], 1000, 9.0), (np.linspace(0.5, 15, 30), 1, 9.95), (np.linspace(0.5, 15, 30), 1, 12.0)],
)
def test_a_fine_kit_within_a_limit_is_searched_for_a_second_only(masses, most, limit, monkeypatch) -> None:
    """By what the solver is asked, as no clock is the same twice."""
    solve, asked = scipy.optimize.milp, []

    def counted(cost, **more):
        solution = solve(cost, **more)
        asked.append(len(cost) * (solution.mip_node_count or 0))
        return solution

    monkeypatch.setattr(scipy.optimize, "milp", counted)
    kit = [KitWeight(f"{mass:g} g", float(mass), None) for mass in masses]
    vector, places = cmath.rect(10.0, 0.64), degrees(*range(0, 360, 5))
    pieces = split_among(vector, places, most_in_all=limit, kit=kit, most_pieces=most, enough=0.0075)
    assert mass(pieces) <= limit * (1 + 1e-6)
    assert abs(whole(pieces) - vector) <= max(10.0 - limit, 0.0) + 0.6
    assert len(asked) <= 3
    assert sum(asked) <= 60_000


@settings(deadline=None, max_examples=60)
@given(
    st.integers(2, 5),
    st.floats(0, 6.3),
    st.lists(st.sampled_from([1.0, 2.0, 5.0]), min_size=1, max_size=2, unique=True),
    st.integers(1, 2),
    st.complex_numbers(min_magnitude=0.1, max_magnitude=9.0),
    st.floats(0.05, 2.0),
)
def test_of_a_kit_no_fewer_weights_are_enough(
    count: int, turn: float, sizes: list[float], most: int, vector: complex, enough: float
) -> None:
    """Against all choices there are."""
    angles = [turn + 2 * math.pi * k / count for k in range(count)]
    kit = [KitWeight(f"w{k}", size, None) for k, size in enumerate(sizes)]
    at_one = np.array([numbers for numbers in product(range(most + 1), repeat=len(kit)) if sum(numbers) <= most])
    choices = np.indices([len(at_one)] * count).reshape(count, -1).T
    added = (at_one @ sizes)[choices] @ np.exp(1j * np.array(angles))
    numbers = at_one.sum(axis=1)[choices].sum(axis=1)
    left = {n: float(np.abs(added - vector)[numbers == n].min()) for n in np.unique(numbers).tolist()}
    pieces = split_among(vector, angles, kit=kit, most_pieces=most, enough=enough)
    some = [number for number in sorted(left) if left[number] <= enough]
    if some:
        assert sum(piece.pieces for piece in pieces) == some[0]
        assert abs(whole(pieces) - vector) == pytest.approx(left[some[0]], abs=1e-9)
    else:
        assert abs(whole(pieces) - vector) <= min(left.values()) + 1e-4


def test_two_weights_do_where_six_opposed_ones_leave_less() -> None:
    vector, kit = cmath.rect(4.0, math.radians(20)), [KitWeight(f"{k} g", float(k), None) for k in (5, 2, 1)]
    pieces = split_among(vector, degrees(*range(0, 360, 45)), kit=kit, most_pieces=2, enough=0.46)
    assert sum(piece.pieces for piece in pieces) == 2
    assert abs(whole(pieces) - vector) <= 0.35  # 2 g at 0° and 2 g at 45° leave that


def test_stocks_and_the_limit_of_the_whole_are_kept_by_the_fewest_weights() -> None:
    kit = [KitWeight("5", 5.0, 1), KitWeight("2", 2.0, None)]
    pieces = split_among(10.0 + 0j, [0.0, math.pi], kit=kit, most_pieces=4, enough=1.5)
    assert {piece.item: piece.pieces for piece in pieces} == {"5": 1, "2": 2}
    assert whole(split_among(10.0 + 0j, [0.0], kit=kit, most_pieces=4, enough=3.5, most_in_all=8.0)).real == 7.0


def test_masses_without_steps_reach_the_limit_of_the_whole() -> None:
    (piece,) = split_among(cmath.rect(11.0, 0.1), None, most_in_all=5.0)
    assert piece.vector == pytest.approx(cmath.rect(5.0, 0.1))
    # Halfway between two positions 120° apart, 10 g take 10 g at both: of 10 g in all, 5 g are at each.
    pieces = split_among(cmath.rect(10.0, math.radians(60)), degrees(0, 120, 240), most_in_all=10.0)
    assert [(round(math.degrees(k.angle)), k.mass) for k in pieces] == [(0, pytest.approx(5)), (120, pytest.approx(5))]


@pytest.mark.parametrize("most", [math.inf, 3.0])
@pytest.mark.parametrize("step", [0.0, 0.5])
def test_no_masses_within_the_limit_of_the_whole_are_nearer(most: float, step: float) -> None:
    rng = np.random.default_rng(3)
    for count in (2, 3, 5, 8):
        vector, limit = cmath.rect(10.0, rng.uniform(0, 6.3)), rng.uniform(4.0, 12.0)
        places = rng.uniform(0, 6.3, count)
        pieces = split_among(vector, places.tolist(), most=most, most_in_all=limit, step=step)
        assert mass(pieces) <= limit * (1 + 1e-6)
        draws = rng.dirichlet(np.full(count, 0.5), 50_000) * limit * rng.uniform(0.5, 1.0, (50_000, 1))
        nearest = np.abs(np.minimum(draws, most) @ np.exp(1j * places) - vector).min()
        assert abs(whole(pieces) - vector) <= nearest + 1e-6 + step * count


@pytest.mark.parametrize("step", [0.0, 0.3, 1.0])
def test_masses_at_the_limit_of_a_position_are_kept(step: float) -> None:
    """The least squares put the limit there, but for a rounding."""
    rng = np.random.default_rng(1)
    for _ in range(300):
        vector, places = complex(*rng.normal(size=2)), rng.uniform(0, 6.3, rng.integers(1, 7)).tolist()
        most = abs(vector) * rng.uniform(0.05, 0.6)
        pieces = split_among(vector, places, most=most, step=step * most)
        assert all(piece.mass <= most * (1 + 1e-6) for piece in pieces)
        assert abs(whole(pieces) - vector) <= abs(vector) * (1 + 1e-9)


@pytest.mark.parametrize(
    ("limit", "nearest"), [(3.0, {210: "2 g", 240: "1 g"}), (4.0, {210: "2 g", 240: "2 g"}), (0.9, {})]
)
@pytest.mark.parametrize("enough", [0.0, 0.3])
def test_of_a_kit_the_nearest_within_a_limit_far_below_is_found(limit, nearest, enough) -> None:
    """1000 g·mm at 37° at a radius of 100 mm, by all choices there are."""
    vector, kit = cmath.rect(10.0, math.radians(217)), [KitWeight(f"{k} g", float(k), None) for k in (1, 2, 5)]
    pieces = split_among(vector, degrees(*range(0, 360, 30)), kit=kit, most_in_all=limit, enough=enough)
    assert {round(math.degrees(piece.angle)): piece.item for piece in pieces} == nearest


@pytest.mark.parametrize(("count", "masses", "most", "limit"), [(36, (1,), 1, 9.0), (12, (1, 2, 5), 3, 40.0)])
def test_of_a_kit_with_too_many_choices_weights_within_the_limit_go_towards_a_vector_far_beyond(
    count, masses, most, limit
) -> None:
    vector, places = cmath.rect(5 * limit, 3.7), (2 * math.pi * np.arange(count) / count).tolist()
    kit = [KitWeight(f"{k} g", float(k), None) for k in masses]
    pieces = split_among(vector, places, kit=kit, most_pieces=most, most_in_all=limit)
    assert mass(pieces) == limit
    assert abs(whole(pieces) - vector) < abs(vector) - 0.9 * limit
