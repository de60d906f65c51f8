"""How the distances between runs become an estimate of the error."""

import mpmath
import numpy as np
import pytest
from tests.dynamics.oracle import rotate

from inertia.dynamics.integrators.error_control import Adaptive
from inertia.dynamics.integrators.loop import Piece, States, Stepper
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.taylor import Taylor
from inertia.dynamics.loads.gravity import Gravity
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.models.stepped.solve import solve_stepped
from inertia.errors import GeometryError


class Turned:
    """Runs that end turned about one axis by given angles, whatever the method."""

    def __init__(self, *turned: float) -> None:
        self.turned = turned

    def stepper(self, piece: Piece, state: np.ndarray, control: float, level: int) -> Stepper:
        raise NotImplementedError

    def run(self, problem: RotationProblem, time: np.ndarray, control: float, level: int = 0) -> States:
        half = 0.5 * self.turned[level]
        attitude = np.tile([np.sin(half), 0.0, 0.0, np.cos(half)], (len(time), 1))
        return States(attitude, np.zeros((len(time), 3)), 1)


class Turning(Turned, Adaptive):
    """A method that compares two runs."""

    name, order, tightest, coarsest = "turning", 4, 1e-17, 1e-17


class TurningSeries(Turned, Taylor):
    """The Taylor method, which compares three."""


AT_REST = RotationProblem([1.0, 2.0, 3.0], [0.0, 0.0, 1e-9], loads=(Torque([0.0, 0.0, 1e-9]),))


def test_estimate_of_two_runs_is_four_times_their_distance() -> None:
    _, estimate = Turning(0.0, 1e-6).solve(AT_REST, np.array([1.0]), 1e-12)
    assert estimate == pytest.approx(4e-6, rel=1e-4)


@pytest.mark.parametrize(
    ("near", "far", "counted"),
    [
        (1.0, 10.0, 5.0),  # the tolerance rules
        (1.0, 100.0, 50.0),
        (1.0, 0.5, 7.0),  # rounding rules, and is amplified
        (0.1, 2.0, 1.0),  # two runs happen to agree
    ],
)
def test_what_the_distances_of_three_runs_say_of_the_error(near: float, far: float, counted: float) -> None:
    unit = 1e-6
    _, estimate = TurningSeries(0.0, near * unit, (near + far) * unit).solve(AT_REST, np.array([1.0]), 1e-9)
    assert estimate == pytest.approx(2.0 * counted * unit, rel=1e-6)


@pytest.mark.parametrize("seed", range(12))
def test_rounding_that_walks_one_way_is_in_the_estimate(seed: int) -> None:
    """A free symmetric body over 30,000 rad, by two uniform turns with 40 digits (textbook § 13.20)."""
    random = np.random.default_rng(seed)
    moments = [a := float(random.uniform(0.2, 1.0)), a, float(random.uniform(0.1, 1.9)) * a]
    spin = random.normal(size=3).tolist()
    end = 3e4 / float(np.linalg.norm(spin))
    states, estimate = Taylor().solve(RotationProblem(moments, spin), np.array([end]), 1e-17)
    with mpmath.workdps(40):
        i, _, k = map(mpmath.mpf, moments)
        x, y, z = map(mpmath.mpf, spin)
        size = mpmath.sqrt((i * x) ** 2 + (i * y) ** 2 + (k * z) ** 2)
        half, own = size * end / i / 2, (1 - k / i) * z * end / 2
        vector = [mpmath.sin(half) * m / size for m in (i * x, i * y, k * z)]
        lead, c, s = mpmath.cos(half), mpmath.cos(own), mpmath.sin(own)
        true = [
            c * vector[0] + s * vector[1],
            c * vector[1] - s * vector[0],
            c * vector[2] + s * lead,
            c * lead - s * vector[2],
        ]
        sign = 1 if sum(p * q for p, q in zip(states.attitude[0].tolist(), true, strict=True)) > 0 else -1
        error = 2 * mpmath.norm([p - sign * q for p, q in zip(states.attitude[0].tolist(), true, strict=True)])
    assert error < estimate < 1e-6


def test_accuracy_of_1e_13_is_reached_under_a_torque() -> None:
    problem = RotationProblem([1.0, 2.0, 3.0], [1.0, 0.5, 2.0], loads=(Torque([0.1, 0.2, 0.3]),))
    motion = solve_stepped(problem, [0.0, 4.0, 8.0], 1e-13)
    truth = rotate([1.0, 2.0, 3.0], [1.0, 0.5, 2.0], [0.0, 4.0, 8.0], body_torque=(0.1, 0.2, 0.3))
    assert truth.attitude_error(motion.attitude).max() < motion.reached < 1e-13


def test_runs_that_part_between_few_samples_are_told_apart() -> None:
    """A top balanced on its point falls from rounding alone; three samples may show it near where it fell before."""
    upright = RotationProblem(
        [0.12658714496482007, 0.12658714496482007, 0.017988492487752746],
        [0.0, 0.0, 8.255814010263576],
        loads=(Gravity(),),
        mass=2.08680121623028,
        arm=[9.797367552586216e-22, -7.466377336641522e-22, 0.1542134675309233],
    )
    with pytest.raises(GeometryError, match=r"nor 0\.1 rad"):
        solve_stepped(upright, [0.0, 5.7, 11.45], 1e-6)
