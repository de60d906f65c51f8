"""Motion in double-double against heyoka's quadruple precision, which shares no code with it, and closed forms."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest

from inertia.arrays import Float
from inertia.dynamics.plan import plan
from inertia.dynamics.reference.motion import Reference, reference
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.simulate import simulate
from inertia_meshes import path

KINDS = {
    "heavy": 0,
    "heavy_body": 0,
    "tables": 1,
    "dissipation": 1,
    "gradient": 0,
    "orbiting": 2,
    "functions": 1,
    "hinged": 1,
    "inverted": 0,
    "rolling": 2,
    "sliding": 1,
    "deforming": 1,
}
"""One random case of each kind that is followed quickly."""


def truly(scene: Scene, time: Float) -> Reference:
    answer = reference(plan(scene).candidates[-1], time, lambda done: True)
    assert answer is not None
    return answer


@pytest.mark.parametrize("kind", KINDS)
def test_the_error_that_is_stated_holds_against_quadruple_precision(kind: str) -> None:
    pytest.importorskip("heyoka")
    from tests.benchmarks.honesty.judge import scene_of, truth_of
    from tests.benchmarks.honesty.scenes import case

    one = case(kind, 5, KINDS[kind])
    scene = scene_of(one)
    time = np.linspace(0.0, scene.run.duration, 3)
    answer, truth = truly(scene, time), truth_of(one, scene, time)
    high = truth.attitude.astype(np.float64)
    low = (truth.attitude - high.astype(truth.attitude.dtype)).astype(np.float64)
    sign = np.sign((high * answer.high).sum(axis=1))[:, None]
    apart = 2.0 * np.linalg.norm((sign * high - answer.high) + (sign * low - answer.low), axis=1).max()
    assert apart <= answer.error + truth.error.max() + 1e-30
    assert answer.error < (1e-16 if kind == "functions" else 1e-20)  # a function knows float64 only


@pytest.mark.parametrize(
    "name",
    [
        "boom_satellite",
        "cat",
        "feynman_plate",
        "gravity_gradient",
        "manoeuvre",
        "detumbling",
        "pendulum",
        "tilted_disc",
    ],
)
def test_sample_scenes_are_followed_far_finer_than_their_runs(name: str) -> None:
    scene = Scene.load(path(f"scenes/{name}.toml"))
    run = simulate(scene)
    answer = truly(scene, run.time)
    assert answer.error < 1e-19
    assert answer.apart(run.attitude).max() <= run.error.reached + run.error.inputs


def turned_about(answer: Reference, axis: int, angles: list[Any]) -> float:
    """Return how far attitudes are from turns about an axis of space, whose angles are known to 40 digits."""
    worst = mpmath.mpf(0)
    for high, low, angle in zip(answer.high, answer.low, angles, strict=True):
        parts = [mpmath.mpf(float(a)) + mpmath.mpf(float(b)) for a, b in zip(high, low, strict=True)]
        true = [mpmath.mpf(0)] * 4
        true[axis], true[3] = mpmath.sin(angle / 2), mpmath.cos(angle / 2)
        sign = 1 if sum(p * q for p, q in zip(parts, true, strict=True)) > 0 else -1
        worst = max(worst, 2 * mpmath.norm([p - sign * q for p, q in zip(parts, true, strict=True)]))
    return float(worst)


def test_a_pendulum_is_that_of_the_elliptic_functions() -> None:
    table = {
        "body": {"mass": 2.0, "principal_moments": [0.5, 0.5, 0.25], "center_of_mass": [0.0, 0.0, -0.5]},
        "start": {"angular_velocity": [3.0, 0.0, 0.0], "frame": "part"},
        "constraint": {"kind": "hinge", "axis": [1.0, 0.0, 0.0]},
        "load": [{"kind": "gravity", "acceleration": [0.0, 0.0, -9.75]}],
        "run": {"duration": 4.0, "samples": 2},
    }
    time = np.linspace(0.0, 4.0, 5)
    answer = truly(Scene.from_dict(table), time)
    with mpmath.workdps(40):
        rate = mpmath.sqrt(mpmath.mpf("9.75"))  # m g h / (I + m h²) = 9.75 / 1
        modulus = mpmath.mpf(3) / (2 * rate)
        angles = [2 * mpmath.asin(modulus * mpmath.ellipfun("sn", rate * t, k=modulus)) for t in time.tolist()]
        assert turned_about(answer, 0, angles) <= answer.error < 1e-24


def test_a_man_on_a_stool_turns_against_his_wheel() -> None:
    parts = [
        {"name": "man", "mass": 80.0, "principal_moments": [9.0, 9.0, 3.0]},
        {
            "name": "wheel",
            "mass": 1.0,
            "principal_moments": [0.5, 0.5, 1.0],
            "parent": "man",
            "joint": [{"axis": [0.0, 0.0, 3.0], "times": [0.0, 1.0], "angles": [0.0, 2.5]}],
        },
    ]
    table = {
        "part": parts,
        "start": {"angular_velocity": [0.0, 0.0, 0.5], "frame": "part"},
        "run": {"duration": 1.0, "samples": 2},
    }
    time = np.array([0.0, 0.25, 1.0])
    answer = truly(Scene.from_dict(table), time)
    with mpmath.workdps(40):
        quintic = [mpmath.mpf("2.5") * t**3 * (10 - 15 * t + 6 * t * t) for t in map(mpmath.mpf, time.tolist())]
        angles = [t / 2 - q / 4 for t, q in zip(map(mpmath.mpf, time.tolist()), quintic, strict=True)]
        assert turned_about(answer, 2, angles) <= answer.error < 1e-21


def test_a_disc_rolls_upright_as_far_as_it_turns() -> None:
    table = {
        "body": {"mass": 1.0, "principal_moments": [0.25, 0.25, 0.5]},
        "start": {"angular_velocity": [0.0, 0.0, -2.0], "frame": "part", "attitude": [0.5**0.5, 0.0, 0.0, 0.5**0.5]},
        "constraint": {"kind": "rolling", "radius": 1.0, "axis": [0.0, 0.0, 1.0]},
        "load": [{"kind": "gravity"}],
        "run": {"duration": 3.0, "samples": 2},
    }
    answer = truly(Scene.from_dict(table), np.array([0.0, 1.5, 3.0]))
    with mpmath.workdps(40):
        for angle, high, low in zip((-3, -6), answer.high[1:], answer.low[1:], strict=True):
            root, s, c = mpmath.sqrt(0.5), mpmath.sin(mpmath.mpf(angle) / 2), mpmath.cos(mpmath.mpf(angle) / 2)
            true = [root * c, -root * s, root * s, root * c]
            parts = [mpmath.mpf(float(a)) + mpmath.mpf(float(b)) for a, b in zip(high, low, strict=True)]
            sign = 1 if sum(p * q for p, q in zip(parts, true, strict=True)) > 0 else -1
            assert 2 * mpmath.norm([p - sign * q for p, q in zip(parts, true, strict=True)]) <= answer.error


def test_what_would_take_too_long_is_given_up() -> None:
    table = {
        "body": {"principal_moments": [1.0, 2.0, 2.75]},
        "start": {"angular_velocity": [1.0, 0.5, 2.0]},
        "run": {"duration": 1e4, "samples": 2},
    }
    shares: list[float] = []
    answer = reference(
        plan(Scene.from_dict(table)).candidates[-1], np.array([0.0, 1e4]), lambda done: bool(shares.append(done))
    )
    assert answer is None
    assert len(shares) == 1
    assert 0.0 < shares[0] < 0.01
