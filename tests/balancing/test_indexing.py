"""Bodies put together at the best angles: against all ways written down one by one, and against turned meshes."""

import cmath
import itertools
import math

import numpy as np
import pytest
from tests.balancing.corrections.workpieces import round_part

from inertia.balancing.balance import balance
from inertia.balancing.indexing import Indexing, best_indexing
from inertia.balancing.rotor import Rotor
from inertia.mesh.cut import block, cut
from inertia.mesh.write import write_stl


def problem(seed, bodies, count):
    draw = np.random.default_rng(seed)
    vectors = draw.normal(size=(bodies, 2)) + 1j * draw.normal(size=(bodies, 2))
    angles = [[0.0]] + [[math.tau * k / count for k in range(count)]] * (bodies - 1)
    return vectors, draw.normal(size=2) + 0j, [0.7, 1.3], angles


@pytest.mark.parametrize("seed", range(20))
def test_no_way_is_better(seed):
    vectors, fixed, limits, angles = problem(seed, 4, 5 + seed % 3)
    result = best_indexing(vectors, fixed, limits, angles)
    ways = [
        max(
            abs(fixed[p] + sum(vectors[b, p] * cmath.rect(1, turns[b]) for b in range(4))) / limits[p] for p in range(2)
        )
        for turns in itertools.product(*angles)
    ]
    assert result.left == pytest.approx(min(ways), rel=1e-12)
    assert result.as_filed == pytest.approx(ways[0], rel=1e-12)
    assert result.ways == len(ways)


@pytest.mark.parametrize("seed", range(3))
def test_of_very_many_ways_a_good_one_is_found_and_none_is_below_the_bound(seed):
    vectors, fixed, limits, angles = problem(seed, 8, 12)
    result = best_indexing(vectors, fixed, limits, angles)
    assert result.ways == 12**7
    draw = np.random.default_rng(99)
    tried = np.exp(1j * draw.choice(angles[1], (200_000, 7)))
    others = np.abs(fixed + vectors[0] + tried @ vectors[1:]) / np.array(limits)
    assert result.bound <= result.left <= others.max(axis=1).min()


def test_bodies_of_a_rotor_are_turned_in_their_meshes(tmp_path):
    shaft = round_part((0, 0), (10, 0), (10, 200), (0, 200), sides=48)
    wheels = [
        cut(
            round_part((11, z), (60, z), (60, z + 20), (11, z + 20), (11, z), sides=48),
            [block([30.0, -5.0, z - 5.0], np.diag([15.0, 10.0, 40.0]))],
        )
        for z in (60, 120)
    ]
    for name, part in (("shaft", shaft), ("one", wheels[0]), ("two", wheels[1])):
        write_stl([part], tmp_path / f"{name}.stl", part.unit)
    fields = {
        "body": [{"file": f"{name}.stl", "material": "steel"} for name in ("shaft", "one", "two")],
        "axis": {"bearing_a": [0, 0, 10], "bearing_b": [0, 0, 190]},
        "service": {"rpm": 3000},
        "tolerance": {"grade": 6.3},
    }
    before = balance(Rotor.from_dict(fields, folder=tmp_path))
    fields["body"][2]["indexing"] = {"count": 6}
    after = balance(Rotor.from_dict(fields, folder=tmp_path))
    assert after.indexing.turns == pytest.approx((0.0, 0.0, math.pi))
    worst = [max(abs(k.residual) / k.permissible for k in each.verdict.planes) for each in (before, after)]
    assert worst == pytest.approx([after.indexing.as_filed, after.indexing.left], rel=1e-6)
    assert abs(after.initial.static) < 1e-6 * abs(before.initial.static) + 1e-9
    assert "two.stl turned by 180°" in after.notes[0]


def test_turns_are_written_to_the_digits_of_their_steps():
    turns = tuple(math.radians(k) for k in (101.25, 360 / 7, 360.0, 337.5))
    assert Indexing(turns, 0.0, 0.0, 0.0, 1).degrees == ("101.25", "51.43", "0", "337.5")
