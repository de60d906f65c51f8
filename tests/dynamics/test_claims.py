"""The accuracy that a run claims is true: for any tensor, near unstable motions, and for a part that has bounds."""

from typing import Any

import mpmath as mp
import numpy as np
import pytest
from tests.dynamics.models.free.free_oracle import angle, free_top, matrix
from tests.dynamics.oracle import rotate

import inertia
from inertia import Scene, SceneBody, Settings, Start
from inertia.dynamics.plan import plan
from inertia.dynamics.simulate import simulate
from inertia.errors import GeometryError
from inertia_meshes import path


def free_errors(table: dict[str, Any], run: Any) -> np.ndarray:
    """Return the angles (n,) from the attitudes of a free body to those of its full tensor, diagonalised by mpmath."""
    with mp.workdps(60):
        moments, axes = mp.eigsy(mp.matrix(table["body"]["inertia"]))
        if mp.det(axes) < 0:
            axes[:, 2] = -axes[:, 2]
        start = matrix(table["start"].get("attitude", [0, 0, 0, 1]))
        spin = mp.matrix(table["start"]["angular_velocity"])
        if table["start"]["frame"] == "space":
            spin = start.T * spin
        truth = free_top(list(moments), list(axes.T * spin), run.time.tolist())
        return np.array(
            [
                angle(matrix(q), start * axes * turn * axes.T)
                for q, (turn, _) in zip(run.attitude.tolist(), truth, strict=True)
            ]
        )


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("frame", ["part", "space"])
def test_a_free_body_with_a_full_tensor_holds_its_claim_for_a_million_radians(seed: int, frame: str) -> None:
    random = np.random.default_rng(seed)
    second = random.normal(size=(3, 3))
    second = second @ second.T
    turn = random.normal(size=4)
    table: dict[str, Any] = {
        "body": {"inertia": (np.trace(second) * np.eye(3) - second).tolist()},
        "start": {
            "angular_velocity": random.normal(size=3).tolist(),
            "frame": frame,
            "attitude": (turn / np.linalg.norm(turn)).tolist(),
        },
        "run": {"duration": 1e6, "samples": 3},
    }
    run = simulate(Scene.from_dict(table))
    error = free_errors(table, run).max()
    assert run.model == "asymmetric top"
    assert error <= run.error.reached < 3e-14


def test_a_full_tensor_near_the_intermediate_axis_holds_its_claim() -> None:
    # The body tumbles, and one rounding of its tensor on the way in would move it by a tenth of a radian.
    axes = np.array([[2.0, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
    tensor = axes @ np.diag([1.0, 2.0, 3.0]) @ axes.T
    table = {
        "body": {"inertia": (0.5 * (tensor + tensor.T)).tolist()},
        "start": {"angular_velocity": (axes @ [0, 1.0, 1e-9]).tolist(), "frame": "part"},
        "run": {"duration": 400.0, "samples": 9},
    }
    run = simulate(Scene.from_dict(table))
    assert free_errors(table, run).max() <= run.error.reached < 1e-13


def heavy(tensor: Any, center: Any, spin: Any, **run: Any) -> dict[str, Any]:
    return {
        "body": {"inertia": np.asarray(tensor).tolist(), "mass": 3.0, "center_of_mass": list(center)},
        "start": {"angular_velocity": list(spin), "frame": "part"},
        "constraint": {"kind": "fixed_point"},
        "load": [{"kind": "gravity"}],
        "run": {"samples": 5, **run},
    }


@pytest.mark.parametrize("duration", [2.0, 5.0, 7.0])
def test_a_top_that_falls_is_not_taken_for_symmetric_where_what_it_lacks_grows(duration: float) -> None:
    # exp(2.29 t): what 5e-14 off symmetry leaves out is 4e-9 rad after 5 s, and decides the fall after 13 s.
    table = heavy(np.diag([1.0, 1.0, 0.5]), [1e-14, 0, 0.2], [0, 0, 0.5], duration=duration, accuracy=1e-6)
    run = simulate(Scene.from_dict(table))
    truth = _about_the_point(table, run.time)
    assert truth.attitude_error(run.attitude).max() <= run.error.reached <= 1e-6


def test_a_top_whose_fall_no_float64_knows_is_refused() -> None:
    table = heavy(np.diag([1.0, 1.0, 0.5]), [1e-14, 0, 0.2], [0, 0, 0.5], duration=20.0, accuracy=1e-6)
    with pytest.raises(GeometryError, match="does not reach"):
        simulate(Scene.from_dict(table))


def test_a_top_that_is_exactly_upright_and_symmetric_stays_so() -> None:
    table = heavy(np.diag([1.0, 1.0, 0.5]), [0, 0, 0.2], [0, 0, 0.5], duration=20.0)
    run = simulate(Scene.from_dict(table))
    angle = 2 * np.arctan2(run.attitude[:, 2], run.attitude[:, 3])
    assert np.abs(run.attitude[:, :2]).max() == 0
    assert np.abs(np.sin(angle - 0.5 * run.time)).max() <= run.error.reached < 1e-14
    assert any("unstable" in warning for warning in run.warnings)


def _about_the_point(table: dict[str, Any], time: np.ndarray) -> Any:
    """Return the truth for a body with a diagonal tensor whose centre of mass is off axis by next to nothing."""
    x, y, z = center = table["body"]["center_of_mass"]
    shift = 3.0 * np.array([y * y + z * z, z * z + x * x, x * x + y * y])
    with mp.workdps(60):
        # Principal axes about the point: turned by about 3 x z/(I1 − I3) about y, less than 1e-13.
        moments = mp.matrix(np.diag(np.diagonal(table["body"]["inertia"])).tolist())
        c = mp.matrix(center)
        tensor = moments + 3 * ((c.T * c)[0] * mp.eye(3) - c * c.T)
        values, axes = mp.eigsy(tensor)
        order = sorted(range(3), key=lambda k: abs(axes[0, k]), reverse=True)
        order = [order[0], *sorted(order[1:], key=lambda k: abs(axes[1, k]), reverse=True)]
        columns = [axes[:, k] * mp.sign(axes[n, k]) for n, k in enumerate(order)]
        frame = mp.matrix([[column[i] for column in columns] for i in range(3)])
    assert np.allclose([float(values[k]) for k in order], np.diagonal(table["body"]["inertia"]) + shift)
    return _Turned(frame, [values[k] for k in order], table, time)


class _Turned:
    """The truth in part axes, from that in principal axes."""

    def __init__(self, frame: Any, moments: list[Any], table: dict[str, Any], time: np.ndarray) -> None:
        exact = lambda v: [mp.mpf(k).as_integer_ratio() for k in v]  # noqa: E731
        from fractions import Fraction

        with mp.workdps(60):
            half = [(frame[2, 1] - frame[1, 2]) / 4, (frame[0, 2] - frame[2, 0]) / 4, (frame[1, 0] - frame[0, 1]) / 4]
            self.turn = [*half, mp.sqrt(1 - sum(h * h for h in half))]
            spin = list(frame.T * mp.matrix(table["start"]["angular_velocity"]))
            arm = list(frame.T * mp.matrix(table["body"]["center_of_mass"]))

        def fractions(values: list[Any]) -> list[Fraction]:
            return [Fraction(*pair) for pair in exact(values)]

        self.answer = rotate(
            fractions(moments),  # type: ignore[arg-type]
            fractions(spin),  # type: ignore[arg-type]
            time.tolist(),
            attitude=fractions(self.turn),  # type: ignore[arg-type]
            mass=table["body"]["mass"],
            offset=fractions(arm),  # type: ignore[arg-type]
            gravity=(0.0, 0.0, -9.80665),
        )

    def attitude_error(self, attitude: np.ndarray) -> np.ndarray:
        with mp.workdps(60):
            back = matrix(self.turn).T
            return np.array(
                [
                    angle(matrix(q), matrix(list(true)) * back)
                    for q, true in zip(attitude.tolist(), self.answer.attitude, strict=True)
                ]
            )


def upright_top(spin: float, accuracy: float | str | None = None) -> Scene:
    part = inertia.read(path("spinning_top.stl"), unit="mm")
    body = SceneBody.of(inertia.mass_properties(part, material="oak", accuracy=accuracy))
    table = heavy(np.eye(3), [0, 0, 0], [0, 0, spin], duration=3.0)
    scene = Scene.from_dict(table)
    return Scene(body, Start([0, 0, spin], frame="part"), Settings(3.0, 31), scene.constraint, scene.applied_loads)


def test_a_part_whose_bounds_decide_its_fall_is_claimed_up_to_then_only() -> None:
    run = simulate(upright_top(20.0))
    error = run.error
    # It sleeps above 81.9 rad/s; below, a tilt grows e-fold in 0.053 s, from 3e-14 of the tensor to 1e-10 rad in 0.4 s.
    assert 0.2 < error.until < 0.7
    assert error.inputs == np.pi
    assert error.reached <= error.requested
    assert any(f"the accuracy holds up to {error.until:.3g} s" in warning for warning in run.warnings)
    stable = simulate(upright_top(200.0)).error
    assert 1.0 < stable.until <= 3.0  # 1e-13 · 200 rad/s · t
    assert 1e-14 < stable.inputs < 1e-9


def test_a_part_that_is_known_exactly_has_no_bound() -> None:
    error = simulate(upright_top(20.0, "exact")).error
    assert (error.inputs, error.until) == (0.0, 3.0)
    scene = Scene.load(path("scenes/t_handle.toml"))  # which integrates its part exactly
    assert plan(scene).candidate.input_bound.until(1e-10) == scene.run.duration


@pytest.mark.parametrize(
    ("wobble", "duration", "digits"), [(1e-125, 20.0, 280), (1e-125, 50.0, 280), (5e-324, 20.0, 680)]
)
def test_a_wobble_however_small_is_not_left_out_where_it_grows(wobble: float, duration: float, digits: int) -> None:
    # exp(5.77 t): 1e-125 of the spin has become 1 after 50 s.
    table = {
        "body": {"principal_moments": [1, 2, 3]},
        "start": {"angular_velocity": [0, 10, wobble]},
        "run": {"duration": duration, "samples": 2},
    }
    run = simulate(Scene.from_dict(table))
    ((turn, _),) = free_top([1, 2, 3], [0, 10, wobble], [duration], digits)
    with mp.workdps(60):
        error = angle(matrix(run.attitude[-1].tolist()), turn)
    assert error <= run.error.reached <= 1e-10


def test_a_wobble_too_small_for_any_model_is_refused_where_it_takes_over() -> None:
    table = {
        "body": {"principal_moments": [1, 2, 3]},
        "start": {"angular_velocity": [0, 10, 1e-125]},
        "run": {"duration": 100.0},
    }
    with pytest.raises(GeometryError, match="does not reach"):
        simulate(Scene.from_dict(table))


def test_a_coarse_accuracy_takes_moments_as_equal_that_are_in_no_class() -> None:
    table = {
        "body": {"principal_moments": [1.0, 1.00007, 1.6]},
        "start": {"angular_velocity": [0.1, 0.2, 1.0]},
        "run": {"duration": 1.0, "samples": 5, "accuracy": 0.01},
    }
    run = simulate(Scene.from_dict(table))
    truth = rotate([1.0, 1.00007, 1.6], [0.1, 0.2, 1.0], run.time.tolist())
    assert run.model == "symmetric top"
    assert truth.attitude_error(run.attitude).max() <= run.error.reached


@pytest.mark.parametrize("duration", [1e13, 3.77e14, 1e15])
def test_a_claim_holds_for_1e15_radians(duration: float) -> None:
    table = {
        "body": {"inertia": [[0.55, -0.0125, -0.000125], [-0.0125, 1.25, 0.0025], [-0.000125, 0.0025, 0.75]]},
        "start": {"angular_velocity": [0.07, 0.09, -0.99], "frame": "part"},
        "run": {"duration": duration, "samples": 40, "accuracy": 1e-6},
    }
    run = simulate(Scene.from_dict(table))
    assert free_errors(table, run).max() <= run.error.reached < 1e-13


@pytest.mark.parametrize(("arm", "model"), [(1e-19, "asymmetric top"), (1e-16, "Euler equations")])
def test_a_weight_that_is_left_out_counts_as_its_effect_grows(arm: float, model: str) -> None:
    # Spinning about its intermediate axis, where a disturbance grows by exp(11.5).
    table = heavy(np.diag([1.0, 2.0, 3.0]), [0, 0, arm], [0, 10.0, 0], duration=2.0, accuracy=1e-10)
    run = simulate(Scene.from_dict(table))
    truth = rotate(
        [1.0, 2.0, 3.0], [0, 10.0, 0], run.time.tolist(), mass=3.0, offset=(0, 0, arm), gravity=(0, 0, -9.80665)
    )
    assert run.model in (model, "steady axis")
    assert truth.attitude_error(run.attitude).max() <= run.error.reached <= 1e-10
    assert (run.model == "Euler equations") == (model == "Euler equations")


def test_bounds_of_a_part_count_where_it_is_stepped_as_where_it_has_a_closed_form() -> None:
    part = inertia.read(path("t_handle.stl"), unit="mm")
    body = SceneBody.of(inertia.mass_properties(part, material="steel"))
    start, settings = Start([0.001, 10, 0]), Settings(10.0, 11)
    free = simulate(Scene(body, start, settings)).error
    damped = simulate(Scene(body, start, settings, applied_loads=(inertia.Damping(1e-7),))).error
    assert damped.until == pytest.approx(free.until, rel=0.2)
    assert damped.inputs == pytest.approx(free.inputs, rel=1.0)


@pytest.mark.parametrize("method", [None, "DOP853"])
def test_the_gravity_gradient_on_a_needle_holds_its_claim(method: str | None) -> None:
    # What two moments differ by turns it about its length: a rounding of either would be a thousandth of that.
    moments, spin, primary = [1.0, 1e-9, 1.0 + 2.0**-40], [0.0, 1e-3, 0.0], [0.3, 0.7, 0.6]
    table = {
        "body": {"principal_moments": moments},
        "start": {"angular_velocity": spin, "frame": "part"},
        "load": [{"kind": "gravity_gradient", "mu": 1 / 3, "position": primary}],
        "run": {"duration": 3.0, "samples": 4, "accuracy": 1e-8} | ({} if method is None else {"method": method}),
    }
    run = simulate(Scene.from_dict(table))
    true = rotate(moments, spin, run.time.tolist(), gravity_gradient=(1 / 3, primary))
    assert true.attitude_error(run.attitude).max() <= run.error.reached < 1e-8
