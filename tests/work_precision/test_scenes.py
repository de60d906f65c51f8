"""The measured runs of a scene: their errors against the true motion, what is skipped, what is refused."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest
from tests.dynamics import oracle
from tests.dynamics.scenes import DISC, scene

from inertia.dynamics.integrators import methods
from inertia.dynamics.integrators.splitting import Splitting
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.scene.sections import Settings
from inertia.dynamics.simulate import simulate
from inertia.errors import GeometryError, UsageError
from inertia.work_precision.rows import SceneRow, front
from inertia.work_precision.scenes import LADDER
from inertia.work_precision.trade import SceneTrade, trade
from inertia_meshes import path

MOMENTS, SPIN = (1.0, 2.0, 2.75), (1.0, 0.5, 2.0)
TIMES = [0.0, 1.0, 2.0]
SHORT = {"duration": 2.0, "samples": 3}
FREE = {"body": {"principal_moments": MOMENTS}, "start": {"angular_velocity": SPIN}, "run": SHORT}
HEAVY = {
    "body": {"principal_moments": (0.955, 1.955, 2.75), "mass": 0.5, "center_of_mass": (0.0, 0.0, 0.3)},
    "start": {"angular_velocity": SPIN, "frame": "part"},
    "constraint": {"kind": "fixed_point"},
    "load": [{"kind": "gravity", "acceleration": (0.0, 0.0, -9.8)}],
    "run": SHORT,
}
FEW = ("Taylor", "DOP853", "LSODA")


def traded(table: dict[str, Any], **options: Any) -> SceneTrade:
    return trade(Scene.from_dict(table), **{"repeats": 1, "budget": 40.0} | options)


@pytest.fixture(scope="module", autouse=True)
def few_methods() -> Iterator[None]:
    """Leave three stepping methods, for the sake of time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(methods, "METHODS", {name: methods.METHODS[name] for name in FEW})
        yield


@pytest.fixture(scope="module")
def free() -> SceneTrade:
    return traded(FREE)


@pytest.fixture(scope="module")
def heavy() -> SceneTrade:
    return traded(HEAVY, accuracy=3e-8)


def test_every_method_is_there(free: SceneTrade, heavy: SceneTrade) -> None:
    assert {row.method for row in free.rows} == {"closed form: Jacobi elliptic functions", *FEW}
    assert {row.method for row in heavy.rows} == set(FEW)


def test_a_closed_form_is_one_row_for_all_accuracies(free: SceneTrade) -> None:
    (closed,) = [row for row in free.rows if row.planned]
    assert closed.asked == (1e-3, 1e-5, 1e-7, 1e-9, 1e-10, 1e-11, 1e-13)  # the scene's own 1e-10 among them
    assert closed.steps == 0
    assert closed.error is not None
    assert closed.error <= closed.estimate


def true_error(table: dict[str, Any], truth: oracle.Answer, row: SceneRow) -> float:
    """Return how far a row is off, simulated again."""
    asked = SHORT | {"accuracy": row.asked[0]} | ({} if row.planned else {"method": row.method})
    return float(truth.attitude_error(simulate(Scene.from_dict(table | {"run": asked})).attitude).max())


def test_every_error_is_the_angle_to_the_true_motion(free: SceneTrade, heavy: SceneTrade) -> None:
    pulled = oracle.rotate(MOMENTS, SPIN, TIMES, mass=0.5, offset=(0.0, 0.0, 0.3), gravity=(0.0, 0.0, -9.8))
    for table, cost, truth in ((FREE, free, oracle.rotate(MOMENTS, SPIN, TIMES)), (HEAVY, heavy, pulled)):
        for row in cost.rows:
            true = true_error(table, truth, row)
            assert (row.error or 0.0) == pytest.approx(true, rel=1e-6, abs=1e-14)
            assert true <= row.reached + 1e-15  # Steiner's theorem rounds the moments


@pytest.mark.parametrize("kind", ["free", "heavy"])
def test_the_reference_is_finer_than_any_row_by_far(kind: str, free: SceneTrade, heavy: SceneTrade) -> None:
    cost = {"free": free, "heavy": heavy}[kind]
    assert cost.reference not in cost.rows
    assert cost.reference.method == "Gauss collocation, in double-double"
    assert cost.reference.estimate < 1e-2 * min(row.error for row in cost.rows if row.error)
    assert cost.reference.reached == cost.reference.estimate < 1e-20


def test_the_planner_selects_taylor_for_a_heavy_body(heavy: SceneTrade) -> None:
    planned = [row for row in heavy.rows if row.planned]
    assert {row.method for row in planned} == {"Taylor"}
    assert {rung for row in planned for rung in row.asked} >= {1e-3, 3e-8, 1e-11}


def test_where_nothing_finer_can_be_had_the_run_surest_of_itself_is_the_reference(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("inertia.work_precision.scenes.reference", lambda *_: None)
    monkeypatch.setattr(methods, "METHODS", {name: methods.METHODS[name] for name in FEW[:2]})
    own = traded(HEAVY)
    assert own.reference in own.rows
    assert own.reference.estimate == min(row.estimate for row in own.rows)


def test_no_run_is_worse_than_what_it_asks_for(free: SceneTrade, heavy: SceneTrade) -> None:
    for row in (*free.rows, *heavy.rows):
        assert row.reached <= row.asked[-1] * (1 + 1e-3)


def test_one_recommendation_for_the_accuracy_asked_for(heavy: SceneTrade) -> None:
    (advice,) = heavy.recommendations
    assert advice.coarsest == advice.finest == heavy.accuracy == 3e-8
    assert advice.row is not None
    assert advice.row.reached <= 3e-8


def test_a_method_that_cannot_take_the_loads_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    two = {"Taylor": methods.METHODS["Taylor"], "splitting 4": Splitting(4)}
    monkeypatch.setattr(methods, "METHODS", two)
    lossy = {**FREE, "load": [{"kind": "dissipation", "rate": 0.01}]}
    cost = traded(lossy)
    reasons = {item.what: item.why for item in cost.skipped}
    assert reasons == {"splitting 4": "splitting 4 has no exact flow for internal dissipation: use Taylor or DOP853"}
    assert {row.method for row in cost.rows} == {"Taylor"}


def test_a_rolling_body_has_two_methods_and_a_deforming_one_has_one() -> None:
    coin = Scene.load(path("scenes/rolling_disc.toml"))
    rolling = trade(replace(coin, run=Settings(0.5, 3, 1e-7)), repeats=1, budget=40.0)
    planned, chosen = ({row.method for row in rolling.rows if row.planned is own} for own in (True, False))
    assert any("nutation" in method for method in planned)
    assert chosen == {"DOP853 (order 8)"}
    cat = Scene.load(path("scenes/cat.toml"))
    turned = trade(cat, repeats=1, budget=40.0)
    assert all(row.planned for row in turned.rows)
    for cost in (rolling, turned):
        assert cost.reference.estimate < 1e-2 * min(row.error for row in cost.rows if row.error)


def test_repeats_are_counted() -> None:
    assert traded(FREE, repeats=3).rows[0].time.runs == 3


def test_what_a_scene_forces_is_measured_beside_what_the_planner_would_select() -> None:
    forced = traded(FREE | {"run": SHORT | {"method": "LSODA"}})
    assert forced.rows[0].planned
    assert forced.rows[0].model == "asymmetric top"


def test_a_budget_that_is_too_small_is_refused() -> None:
    ticks = itertools.count()
    with pytest.raises(UsageError, match=r"no run fits into the budget of 0\.5 s: give a larger budget"):
        traded(FREE, budget=0.5, clock=lambda: float(next(ticks)))


def test_what_does_not_fit_into_the_budget_is_listed_with_its_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(methods, "METHODS", {"DOP853": methods.METHODS["DOP853"]})
    cost = traded(FREE | {"run": {"duration": 4000.0, "samples": 3}}, budget=2.0)
    assert [row.planned for row in cost.rows] == [True]
    (late,) = cost.skipped
    assert (late.what, late.why) == ("DOP853 at 0.001 rad and finer", "it does not fit into the budget")
    assert late.seconds is not None
    assert late.seconds > 0.5


@pytest.mark.parametrize("accuracy", [0.0, 1e-16, 2.0, float("nan"), "exact"])
def test_an_accuracy_that_is_no_angle_is_refused(accuracy: Any) -> None:
    with pytest.raises(UsageError, match="give an angle in rad"):
        traded(FREE, accuracy=accuracy)


def test_a_scene_that_nothing_follows_is_refused() -> None:
    falling = scene(DISC, start__angular_velocity=[0.01, 0.0, 0.0], run__duration=20.0)
    with pytest.raises(GeometryError, match=r"the scene: .*flat"):
        trade(falling, repeats=1, budget=40.0)


def test_the_front_holds_what_no_other_row_betters(free: SceneTrade) -> None:
    best = front(free.rows)
    for row in free.rows:
        bettered = any(
            other.time.median <= row.time.median and other.reached <= row.reached
            for other in free.rows
            if other is not row
        )
        assert bettered == (row not in best)


def test_progress_ends_at_one() -> None:
    done: list[float] = []
    traded(FREE, accuracy=1e-3, progress=done.append)
    assert done == sorted(done)
    assert done[-1] == 1.0
    assert LADDER[0] == 1e-3
