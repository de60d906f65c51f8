"""The loop over the samples, with methods of the test's own: a step is all that it needs."""

from collections.abc import Callable

import numpy as np
import pytest
from tests.dynamics.integrators.loaded import angles

from inertia.dynamics.integrators import loop
from inertia.dynamics.integrators.error_control import Adaptive, FixedStep
from inertia.dynamics.integrators.loop import Piece, Stepper, pieces
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.loads.torque import Torque, TorqueTable
from inertia.errors import GeometryError

KINKED = Torque(table=TorqueTable([-9.0, 1.0, 2.5, 9.0], np.zeros((4, 3))))
BALL = RotationProblem([2.0, 2.0, 2.0], [0.0, 0.0, 3.0], loads=(KINKED,), start=-0.5)
"""A ball turns at a steady 3 rad/s, whatever the table's kinks cut."""


def turned(state: np.ndarray, angle: float) -> np.ndarray:
    """Return the state after a turn about axis 3."""
    _, _, z, w = state[:4]
    s, c = np.sin(0.5 * angle), np.cos(0.5 * angle)
    return np.array([0.0, 0.0, z * c + w * s, w * c - z * s, *state[4:]])


class Equal(FixedStep):
    name, order = "equal", 2

    def step(self, piece: Piece) -> Callable[[float, float, np.ndarray], np.ndarray]:
        return lambda time, length, state: turned(state, length * state[6])


class Wide(Adaptive):
    """Steps over several samples at once."""

    name, order = "wide", 2

    def stepper(self, piece: Piece, state: np.ndarray, control: float, level: int) -> Stepper:
        return WideSteps(state, control)


class WideSteps(Stepper):
    def __init__(self, state: np.ndarray, length: float) -> None:
        self.state, self.length = state, length

    def step(self, target: float) -> str | None:
        if self.steps == 6:
            return "at its seventh step"
        if self.steps:
            self.state = turned(self.state, self.length * self.state[6])
        self.steps += 1
        self.time = self.steps * self.length
        return None

    def values(self, times: np.ndarray) -> np.ndarray:
        begin = self.time - self.length
        assert (begin < times).all()
        assert (times <= self.time).all()
        return np.array([turned(self.state, (time - begin) * self.state[6]) for time in times])


def about_axis_3(angle: np.ndarray) -> list[np.ndarray]:
    return [np.array([[np.cos(a), -np.sin(a), 0.0], [np.sin(a), np.cos(a), 0.0], [0.0, 0.0, 1.0]]) for a in angle]


@pytest.mark.parametrize(("method", "control"), [(Equal(), 0.3), (Wide(), 1.75)], ids=["equal", "wide"])
def test_every_sample_is_reached_whether_steps_end_there_or_span_it(method: FixedStep | Wide, control: float) -> None:
    times = np.array([-0.5, -0.5, -0.4, 0.3, 1.0, 1.0, 1.1, 2.2, 2.5, 3.0, 3.0])
    run = method.run(BALL, times, control)
    assert angles(run.attitude, about_axis_3(3.0 * (times + 0.5))).max() < 2e-15
    assert run.angular_velocity == pytest.approx(np.tile([0.0, 0.0, 3.0], (11, 1)), rel=1e-15)


def test_kinks_cut_a_run_into_pieces() -> None:
    cut = pieces(BALL, np.array([-0.5, 0.3, 1.0, 1.1, 2.5, 3.0]))
    assert [(piece.start, piece.end, piece.first, piece.last) for piece in cut] == [
        (-0.5, 1.0, 1, 3),
        (1.0, 2.5, 3, 5),
        (2.5, 3.0, 5, 6),
    ]
    assert cut[1].targets.tolist() == [4.0 * (1.1 - 1.0), 4.0 * 1.5, 4.0 * 1.5]


def test_equal_steps_come_in_fours_between_samples() -> None:
    """1.5 s and 0.5 s to steps of at most 0.1 s: 16 and 8; at the other levels three and five for each four."""
    free = RotationProblem([2.0, 2.0, 2.0], [0.0, 0.0, 3.0])
    runs = [Equal().run(free, np.array([1.5, 2.0]), 0.1, level) for level in range(3)]
    assert [run.steps for run in runs] == [24, 18, 30]


def test_a_step_that_cannot_be_taken_stops_the_run_with_its_reason() -> None:
    with pytest.raises(GeometryError, match="wide stopped at its seventh step: check the loads"):
        Wide().run(BALL, np.array([0.9]), 0.1)


def test_steps_beyond_the_limit_stop_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loop, "MAX_STEPS", 3)
    with pytest.raises(GeometryError, match="wide stopped after 3 steps"):
        Wide().run(BALL, np.array([0.9]), 0.1)
