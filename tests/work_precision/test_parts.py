"""The measured rows: their errors against rational arithmetic, what is skipped, what is refused."""

import itertools
import math
import os
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tests.mass.parts import cells, exact, surface
from tests.mesh.solids import cube, part, sphere

import inertia
from inertia.errors import GeometryError, InertiaError, UsageError
from inertia.mesh.part import Part
from inertia.mesh.repairs.simplify import halvings
from inertia.work_precision.rows import PartRow
from inertia.work_precision.trade import PartTrade, trade
from inertia_meshes import path, rational

RUNGS = ["float64", "double-double", "exact"]


def lumpy() -> Part:
    """Return a ball with dents, off the origin."""
    vertices, faces = sphere(splits=4)
    dents = np.random.default_rng(7).uniform(0.95, 1.0, (len(vertices), 1))
    return part((vertices * dents + np.array([3.0, -1.0, 2.0]), faces), unit="mm")


@pytest.fixture(scope="module")
def lumps() -> PartTrade:
    return trade(lumpy(), density=7850.0, repeats=1)


def assert_errors(row: PartRow, truth: rational.Moments, density: int, size: Fraction) -> None:
    """Compare the stated errors with those against `truth`, the moments of mass."""
    properties = row.properties
    volume = abs(Fraction(properties.volume) * density / truth.volume - 1)
    center = zip(*properties.center_of_mass_pair()[0].tolist(), truth.center_of_mass, strict=True)
    shift = [Fraction(high) + Fraction(low) - true for high, low, true in center]
    tensor = [value for line in truth.inertia for value in line]
    off = [Fraction(a) - b for a, b in zip(properties.inertia.ravel().tolist(), tensor, strict=True)]
    assert row.error is not None
    assert row.error.volume == pytest.approx(float(volume), rel=1e-12, abs=0)
    assert row.error.center_of_mass == pytest.approx(norm(shift) / float(size), rel=1e-12, abs=0)
    assert row.error.inertia == pytest.approx(norm(off) / norm(tensor), rel=1e-12, abs=0)


def norm(values: list[Fraction]) -> float:
    largest = max(map(abs, values))
    return float(largest) * math.sqrt(sum((value / largest) ** 2 for value in values)) if largest else 0.0


def test_every_method_and_then_simpler_meshes(lumps: PartTrade) -> None:
    assert [row.method for row in lumps.rows if row.mesh == "whole"] == RUNGS
    simpler = lumps.rows[3:]
    assert [row.mesh for row in simpler[:3]] == ["1/2", "1/4", "1/8"]
    assert {row.method for row in simpler} == {"float64"}
    assert (lumps.reference.method, lumps.skipped) == ("exact", ())


def test_every_error_is_the_distance_from_the_rational_answer_for_the_whole_mesh(lumps: PartTrade) -> None:
    whole = lumpy()
    size = Fraction(np.ptp(whole.triangles.corners().reshape(-1, 3), axis=0).max()) / 1000
    truth = exact(whole, 7850)
    for row in lumps.rows:
        assert_errors(row, truth, 7850, size)


def test_no_error_over_the_whole_mesh_is_above_its_bound(lumps: PartTrade) -> None:
    for row in lumps.rows[:3]:
        assert row.error is not None
        assert row.error.volume <= row.bound.volume
        assert row.error.center_of_mass <= row.bound.center_of_mass
        assert row.error.inertia <= row.bound.inertia
        assert row.reached == row.bound.worst
    assert lumps.rows[0].reached > lumps.rows[1].reached


def test_the_rows_of_simpler_meshes_are_those_meshes(lumps: PartTrade) -> None:
    whole = lumpy()
    meshes = list(itertools.islice(halvings(whole.triangles), len(lumps.rows) - 3))
    for row, mesh in zip(lumps.rows[3:], meshes, strict=True):
        own = rational.moments(mesh.surface.corners()).volume / 1000**3
        assert row.triangles == mesh.surface.count
        assert abs(Fraction(row.properties.volume) - own) <= Fraction(row.bound.volume) * own
        assert row.simplification is not None
        assert row.simplification.tolerance == pytest.approx(mesh.tolerance / 1000)
        assert row.error is not None
        assert row.reached == row.error.worst > row.bound.worst


def test_halving_ends_with_the_first_mesh_that_is_useless(lumps: PartTrade) -> None:
    reached = [row.reached for row in lumps.rows[3:]]
    assert reached[-1] > 0.1 >= max(reached[:-1])


def test_making_a_mesh_costs_what_those_before_it_cost_too(lumps: PartTrade) -> None:
    made = [row.simplification.seconds for row in lumps.rows[3:] if row.simplification]
    assert made == sorted(made)


def test_the_density_weighs_and_changes_no_relative_error(lumps: PartTrade) -> None:
    steel, water = (trade(lumpy(), repeats=1, **how) for how in ({"material": "steel"}, {}))
    assert steel.analysis.density == 7850.0
    assert [row.properties.mass for row in steel.rows] == [row.properties.mass for row in lumps.rows]
    assert water.analysis.density_from == "assumed"
    for one, other in zip(steel.rows[3:], water.rows[3:], strict=True):
        assert one.error is not None
        assert other.error is not None
        assert one.error.worst == pytest.approx(other.error.worst, rel=1e-9)


def test_a_file_is_read_again_for_its_time() -> None:
    cost = trade(inertia.read(path("sphere.stl")), repeats=2)
    assert set(cost.steps) == {"read", "closedness", "results"}
    assert {timing.runs for timing in (*cost.steps.values(), *(row.time for row in cost.rows))} == {2}
    assert set(trade(lumpy(), repeats=1).steps) == {"closedness", "results"}


def test_the_figures_are_of_this_machine() -> None:
    machine = trade(part(cube()), repeats=1).machine
    assert machine.python == ".".join(map(str, sys.version_info[:3]))
    assert machine.numpy == np.__version__
    assert 1 <= machine.cores <= (os.cpu_count() or 1)
    assert machine.cpu


def test_a_recommendation_for_the_accuracy_asked_for() -> None:
    cost = trade(part(cube()), 1e-3, repeats=1)
    (advice,) = cost.recommendations
    assert (cost.accuracy, advice.finest) == (1e-3, 1e-3)
    assert advice.row in cost.rows


class Ticking:
    """A clock that moves on by a second whenever it is looked at."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        self.now += 1.0
        return self.now


def test_what_does_not_fit_into_the_budget_is_listed_with_its_estimate() -> None:
    cost = trade(lumpy(), repeats=3, budget=5.0, clock=Ticking())
    assert [row.method for row in cost.rows] == ["float64"]
    assert [(item.what, item.seconds) for item in cost.skipped[:2]] == [
        ("double-double over the whole mesh", 1.0),
        ("exact over the whole mesh", 1.0),
    ]
    assert cost.skipped[2].what == "meshes of about 1/2 of the triangles and fewer"
    assert cost.rows[0].time.runs == 1
    assert cost.rows[0].error is None
    assert cost.reference.method == "float64"


def test_what_is_left_of_the_budget_is_used() -> None:
    budgets = (20.0, 30.0, 200.0)
    rows = [len(trade(lumpy(), repeats=1, budget=budget, clock=Ticking()).rows) for budget in budgets]
    assert rows == sorted(rows)
    assert rows[0] < rows[-1]
    halfway = trade(lumpy(), repeats=1, budget=30.0, clock=Ticking())
    assert halfway.skipped[-1].what.startswith("meshes of about 1/")
    assert halfway.skipped[-1].seconds == 1.0


def test_without_the_exact_answer_the_next_best_is_the_reference() -> None:
    cost = trade(lumpy(), repeats=1, budget=14.0, clock=Ticking())
    assert cost.reference.method == "double-double"
    first, second = cost.rows[:2]
    assert first.error is not None
    assert first.error.worst <= first.bound.worst
    assert second.error is None


def test_a_part_too_thin_for_float64_still_has_the_other_rows() -> None:
    thin = part(plate(1e-17), unit="m")
    cost = trade(thin, repeats=1)
    assert [row.method for row in cost.rows] == ["double-double", "exact"]
    (item, *_) = cost.skipped
    assert (item.what, item.seconds) == ("float64 over the whole mesh", None)
    assert "error bound" in item.why


def test_a_needle_askew_is_recommended_a_method_that_keeps_its_smallest_moment() -> None:
    vertices, faces = plate(1.0)
    turned = vertices @ np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    along = np.array([0.6, 0.0, 0.8])
    needle = part((turned + np.outer(turned @ along, along) * 1e6, faces))
    cost = trade(needle, 1e-3, repeats=1)
    assert cost.rows[0].method == "float64"
    assert cost.rows[0].reached < 1e-3
    assert cost.rows[0].properties.loses_smallest_moment
    (advice,) = cost.recommendations
    assert advice.row is not None
    assert not advice.row.properties.loses_smallest_moment
    assert not cost.analysis.properties.loses_smallest_moment  # by whichever of the two is quicker on the day


def plate(height: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a plate, turned."""
    vertices, faces = cube()
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    return (vertices * np.array([1.0, 1.0, height])) @ turn.T, faces


def test_a_mesh_with_nothing_to_spare_says_so() -> None:
    cost = trade(part(cube()), repeats=1)
    assert [row.method for row in cost.rows] == RUNGS
    (item,) = cost.skipped
    assert (item.what, item.seconds) == ("meshes of about 1/2 of the triangles and fewer", None)
    assert "no tolerance" in item.why


def test_a_file_that_has_gone_has_no_time_of_reading(tmp_path: Path) -> None:
    file = tmp_path / "gone.stl"
    file.write_bytes(path("cube.stl").read_bytes())
    whole = inertia.read(file)
    file.unlink()
    assert set(trade(whole, repeats=1).steps) == {"closedness", "results"}


def test_progress_rises_to_one() -> None:
    fractions: list[float] = []
    trade(lumpy(), repeats=1, progress=fractions.append)
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0


@pytest.mark.parametrize("accuracy", [0, -1.0, math.nan, math.inf, 1e-17, "fine"])
def test_an_accuracy_that_cannot_be_had_is_refused(accuracy: float) -> None:
    with pytest.raises(UsageError, match="accuracy"):
        trade(part(cube()), accuracy)


def test_an_open_mesh_is_refused_in_the_words_of_the_analysis() -> None:
    whole = inertia.read(path("broken/missing_face.stl"))
    message = []
    for verb in (inertia.analyse, inertia.trade):
        with pytest.raises(GeometryError) as raised:
            verb(whole)
        message.append(str(raised.value))
    assert message[0] == message[1]


@pytest.mark.parametrize(
    ("whole", "how", "message"),
    [
        (surface(np.zeros((0, 3, 3))), {}, "no triangles"),
        (cells("tetra", [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), {}, "mesh of cells"),
        (part(cube()), {"density": {"1": 5.0}}, "one density"),
        (part(cube()), {"density": -5.0}, "density"),
        (part(cube()), {"density": 5.0, "material": "steel"}, "give one"),
        (part(cube()), {"repeats": 0}, "repeats"),
        (part(cube()), {"budget": math.nan}, "budget"),
    ],
)
def test_what_cannot_be_measured_is_refused(whole: Part, how: dict, message: str) -> None:
    with pytest.raises(InertiaError, match=message):
        trade(whole, **how)


def test_a_part_far_from_the_origin_reaches_what_a_near_one_does():
    vertices, faces = cube()
    choice = trade(part((vertices + 1e6, faces)), accuracy=1e-12, repeats=1).recommendations[0]
    assert choice.row is not None
    assert choice.row.reached <= 1e-12


@pytest.mark.parametrize(("far", "least"), [("1000", 1e-15), ("1000000", 1e-12)])
def test_errors_and_bounds_are_against_the_decimals_that_the_file_writes(
    far: str, least: float, tmp_path: Path
) -> None:
    corners = [
        (f"{far}.1", "0.1", "0.2"),
        (f"{far}.7", "0.2", "0.1"),
        (f"{far}.2", "0.9", "0.3"),
        (f"{far}.3", "0.4", "0.8"),
    ]
    file = tmp_path / "part.obj"
    file.write_text("".join(f"v {' '.join(c)}\n" for c in corners) + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    result = trade(inertia.read(file, unit="m"), density=1.0, repeats=1)
    a, b, c = ([Fraction(p) - Fraction(q) for p, q in zip(corners[k], corners[0], strict=True)] for k in (1, 2, 3))
    cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]]
    volume = abs(sum((x * y for x, y in zip(a, cross, strict=True)), Fraction(0))) / 6
    whole = {row.method: row for row in result.rows if row.mesh == "whole"}
    for row in whole.values():
        off = abs(Fraction(row.properties.volume) / volume - 1)
        assert row.error is not None
        assert row.error.volume == pytest.approx(float(off), rel=1e-6, abs=1e-18)
        assert row.error.volume <= row.bound.volume
    assert whole["float64"].bound.volume > least
    assert whole["exact"].bound.volume < 2e-16
