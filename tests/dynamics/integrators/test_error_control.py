"""How the distances between runs become an estimate of the error."""

import numpy as np
import pytest
from tests.dynamics.integrators.loaded import case

from inertia.dynamics.integrators.error_control import Adaptive
from inertia.dynamics.integrators.loop import Piece, States, Stepper
from inertia.dynamics.integrators.rotation import RotationProblem


class Turning(Adaptive):
    """A method whose runs end turned about one axis by given angles."""

    name, order, tightest, coarsest, runs, safety = "turning", 4, 1e-17, 1e-17, 3, 5.0

    def __init__(self, *turned: float) -> None:
        self.turned = turned

    def stepper(self, piece: Piece, state: np.ndarray, control: float, level: int) -> Stepper:
        raise NotImplementedError

    def run(self, problem: RotationProblem, time: np.ndarray, control: float, level: int = 0) -> States:
        half = 0.5 * self.turned[level]
        return States(np.array([[np.sin(half), 0.0, 0.0, np.cos(half)]]), np.zeros((1, 3)), 1)


@pytest.mark.parametrize(
    ("near", "far", "counted"),
    [
        (1.0, 10.0, 3.0),  # the tolerance rules
        (1.0, 100.0, 30.0),
        (1.0, 2.5, 2.5),  # rounding rules: the second distance says as much as the first
        (1.0, 0.5, 1.0),
        (0.1, 2.0, 0.6),  # two runs happen to agree
    ],
)
def test_what_the_distances_of_three_runs_say_of_the_error(near: float, far: float, counted: float) -> None:
    unit = 1e-6
    _, estimate = Turning(0.0, near * unit, (near + far) * unit).solve(case("free").problem, np.array([1.0]), 1e-9)
    assert estimate == pytest.approx(5.0 * counted * unit, rel=1e-6)
