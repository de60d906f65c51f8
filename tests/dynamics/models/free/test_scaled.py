"""Closed forms of driven and damped bodies against the integers of the oracle, and mpmath's ODE solver for damping."""

from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from tests.dynamics.oracle import rotate

from inertia.dynamics.plan import plan
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.simulate import simulate
from inertia.errors import GeometryError

MOMENTS = [1.0, 2.0, 3.0]


def scene(
    moments: list[float], spin: list[float], *loads: dict[str, Any], duration: float = 20.0, **more: Any
) -> Scene:
    return Scene.from_dict(
        {
            "body": {"principal_moments": moments},
            "start": {"angular_velocity": spin, **more},
            "load": list(loads),
            "run": {"duration": duration, "samples": 21, "accuracy": 1e-9},
        }
    )


def torque(*components: float, frame: str = "part") -> dict[str, Any]:
    return {"kind": "torque", "torque": list(components), "frame": frame}


def damping(coefficient: float) -> dict[str, Any]:
    return {"kind": "damping", "coefficient": coefficient}


CASES = {
    "driven": ([1, 2, 3], [0, 0, 1.5], {"body_torque": (0.0, 0.0, 0.25)}),
    "from rest": ([1, 2, 3], [0, 0, 0], {"body_torque": (0.5, 0.0, 0.0)}),
    "braked and turned back": ([1, 2, 3], [2.0, 0, 0], {"body_torque": (-0.3, 0.0, 0.0)}),
    "damped": ([1, 2, 3], [0, 0, 4], {"damping": 0.3}),
    "driven and damped": ([1, 2, 3], [0, 0, -4], {"damping": 0.3, "body_torque": (0.0, 0.0, 0.5)}),
    "about the middle axis": ([1, 2, 3], [0, 1.5, 0], {"damping": 0.05, "body_torque": (0.0, 0.1, 0.0)}),
    "damped sphere": ([2, 2, 2], [1, -2, 0.5], {"damping": 0.2}),
    "driven sphere": ([2, 2, 2], [1, -2, 0.5], {"damping": 0.2, "body_torque": (0.25, -0.5, 0.125)}),
    "in space, from rest": ([1, 2, 3], [0, 0, 0], {"space_torque": (0.1, -0.2, 0.4)}),
    "in space, along L": ([2, 3, 4], [1, 2, -0.5], {"space_torque": (0.25, 0.75, -0.25)}),
    "in space, against L": ([2, 2, 3], [1, 0, 2], {"space_torque": (-0.125, 0.0, -0.375)}),
}


@pytest.mark.parametrize("name", CASES)
def test_closed_forms_are_true_to_their_claim(name: str) -> None:
    moments, spin, loads = CASES[name]
    tables = [
        damping(value) if kind == "damping" else torque(*value, frame="space" if kind == "space_torque" else "part")
        for kind, value in loads.items()
    ]
    run = simulate(scene(moments, spin, *tables))
    assert run.model == "scaled free motion"
    truth = rotate(moments, spin, run.time.tolist(), **loads)
    error = truth.attitude_error(run.attitude).max()
    assert error < run.error.reached < 1e-11
    assert (
        truth.angular_velocity_error(run.angular_velocity).max() < 1e-13 * (1 + np.abs(run.angular_velocity).max()) * 20
    )


def test_attitude_and_tensor_at_an_angle() -> None:
    """The torque of space is along L also where body axes, part axes and space axes differ."""
    turn = [Fraction(1, 3), Fraction(2, 3), Fraction(2, 3), Fraction(0)]
    start = [float(x) for x in turn]
    start = (np.array(start) / np.linalg.norm(start)).tolist()
    run = simulate(scene([2, 3, 4], [0, 0, 0], torque(0.3, 0.1, -0.2, frame="space"), attitude=start))
    truth = rotate([2, 3, 4], [0, 0, 0], run.time.tolist(), attitude=start, space_torque=(0.3, 0.1, -0.2))
    assert truth.attitude_error(run.attitude).max() < run.error.reached < 1e-11


def test_damping_for_a_long_time() -> None:
    """ω = ω₀ e^{−ct/I} and θ = ω₀ (I/c)(1 − e^{−ct/I}), by mpmath, over 1e6 s, where steps are refused."""
    run = simulate(scene(MOMENTS, [0, 0, 40], damping(0.3), duration=1e6))
    with mpmath.workdps(40):
        c = mpmath.mpf(0.3) / 3
        angle = [40 * (1 - mpmath.exp(-c * mpmath.mpf(t))) / c for t in run.time.tolist()]
        half = [float(mpmath.sin(a / 2)) for a in angle]
    assert np.abs(np.abs(run.attitude[:, 2]) - np.abs(half)).max() < run.error.reached < 1e-11


@pytest.mark.parametrize(
    ("moments", "spin", "loads"),
    [
        ([1, 2, 3], [0, 0.1, 1], [damping(0.1)]),  # damping turns L
        ([1, 2, 3], [0, 0, 1], [torque(0.1, 0, 1)]),  # torque across the spin
        ([2, 2, 3], [0.1, 0, 1], [torque(0, 0, 1)]),  # symmetric, but the spin is not along the axis
        ([1, 2, 3], [0.1, 0, 1], [torque(0.1, 0, 3)]),  # along L at the start, but fixed in the body
        ([1, 2, 3], [0.1, 0, 1], [torque(0.1, 0, 3, frame="space"), damping(0.1)]),
        ([1, 2, 3], [0, 0, 1], [{"kind": "gravity_gradient", "mu": 1.0, "position": [3, 1, 0]}]),
    ],
)
def test_other_bodies_are_stepped(moments: list[float], spin: list[float], loads: list[dict[str, Any]]) -> None:
    assert plan(scene(moments, spin, *loads)).model == "Euler equations"


def test_spin_that_is_nearly_along_the_middle_axis_is_not_taken_for_it() -> None:
    """The wobble grows as exp(0.577 · 60)."""
    assert plan(scene(MOMENTS, [1e-15, 1, 0], torque(0, 1e-3, 0), duration=60.0)).model == "Euler equations"
    assert plan(scene(MOMENTS, [1e-15, 0, 1], torque(0, 0, 1e-3), duration=60.0)).model == "scaled free motion"


def test_reasons_say_what_is_simple() -> None:
    assert "acts along it" in plan(scene(MOMENTS, [0, 0, 1], damping(1.0))).why[-1]
    assert "in a time that runs as |L|" in plan(scene(MOMENTS, [0, 0, 0], torque(1, 1, 1, frame="space"))).why[-1]


def test_angle_beyond_float64_is_refused() -> None:
    with pytest.raises(GeometryError, match="Taylor does not reach"):
        simulate(scene(MOMENTS, [0, 0, 1], torque(0, 0, 1), duration=1e12))


@pytest.mark.parametrize(
    ("moments", "spin", "load", "says"),
    [
        ([3, 4, 6], [0, 1, 0], torque(0, 0.1, 0), "a factor e in 2 s where the spin is fastest"),
        ([3, 4, 6], [0, 0, 0], torque(0, 0.1, 0), "a factor e in 6 s where the spin is fastest"),
        ([3, 4, 6], [0, 1, 0], damping(0.1), "a factor e in 3 s"),
        ([3, 4, 6], [1, 0, 0], torque(0.1, 0, 0), ""),
        ([4, 4, 4], [0, 1, 0], torque(0, 0.1, 0), ""),
        ([3, 4, 6], [0, 1e-3, 0], damping(0.1), ""),
    ],
)
def test_a_driven_spin_about_the_intermediate_axis_is_called_unstable(
    moments: list[float], spin: list[float], load: dict[str, Any], says: str
) -> None:
    """A disturbance grows at ω √((I₂ − I₁)(I₃ − I₂)/(I₁ I₃)) = ω/3; ω comes to 1.5 rad/s, or 0.5 from rest."""
    run = simulate(scene(moments, spin, load))
    assert run.model == "scaled free motion"
    found = [note for note in run.warnings if "the intermediate moment is unstable" in note]
    assert len(found) == bool(says)
    assert not says or says in found[0]
