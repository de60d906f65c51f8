"""Bodies held on the line that all their mass lies on, spherical pendulums, against Newton's equation in mpmath."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from tests.dynamics.extrapolation import follow

from inertia import GeometryError, Scene, sensitivity, simulate
from inertia.dynamics.kinematics import quaternion

MASS, G = 2.0, 9.80665


def pendulum(moments: list[float], center: list[float], spin: list[float]) -> Scene:
    return Scene.from_dict({
        "body": {"principal_moments": moments, "mass": MASS, "center_of_mass": center},
        "start": {"angular_velocity": spin, "attitude": [0.3, 0.1, 0.3, 0.9], "frame": "part"},
        "constraint": {"kind": "fixed_point"},
        "load": [{"kind": "gravity"}],
        "run": {"duration": 2.0, "samples": 3},
    })  # fmt: skip


def newton(center: list[float], spin: list[float], own: float, times: list[float]) -> list[list[Any]]:
    """Return (r, v, q): r̈ = κ (g − r (r·g)/l²) − r v²/l², κ = m l²/(m l² + I); about r it turns as it starts."""
    length2 = mpmath.fsum(mpmath.mpf(x) ** 2 for x in center)
    pull = mpmath.mpf(G) * MASS * length2 / (MASS * length2 + mpmath.mpf(own))

    def cross(a: list[Any], b: list[Any]) -> list[Any]:
        return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]

    def turned(q: list[Any], a: list[Any]) -> list[Any]:
        across = [2 * x for x in cross(q[:3], a)]
        return [x + q[3] * y + z for x, y, z in zip(a, across, cross(q[:3], across), strict=True)]

    along = mpmath.fdot(center, spin) / length2

    def rate(_: Any, y: list[Any]) -> list[Any]:
        r, v, (i, j, k, s) = y[:3], y[3:6], y[6:]
        speed2 = mpmath.fdot(v, v)
        force = [(pull * r[2] - speed2) * x / length2 - (pull if n == 2 else 0) for n, x in enumerate(r)]
        p, o, t = (x / length2 + along * z for x, z in zip(cross(r, v), r, strict=True))
        turn = [s * p + o * k - t * j, s * o + t * i - p * k, s * t + p * j - o * i, -(p * i + o * j + t * k)]
        return [*v, *force, *(x / 2 for x in turn)]

    q = [mpmath.mpf(x) for x in (0.3, 0.1, 0.3, 0.9)]
    length = mpmath.norm(q)
    q = [x / length for x in q]
    start = turned(q, [mpmath.mpf(x) for x in center])
    return follow(rate, [*start, *cross(turned(q, [mpmath.mpf(x) for x in spin]), start), *q], times)


@pytest.mark.parametrize(
    ("moments", "center", "spin"),
    [
        ([0, 0, 0], [0.0, 0.0, -1.0], [1.0, 2.0, 0.5]),
        ([0, 0, 0], [0.3, -0.7, 0.2], [1.0, 0.0, 0.5]),
        ([0.25, 0.25, 0], [0.0, 0.0, 0.5], [0.0, 3.0, -2.0]),
        ([0, 0.25, 0.25], [-0.5, 0.0, 0.0], [0.0, 0.0, 0.0]),
    ],
)
def test_a_body_held_on_the_line_of_its_mass_is_a_spherical_pendulum(
    moments: list[float], center: list[float], spin: list[float]
) -> None:
    run = simulate(pendulum(moments, center, spin))
    assert run.model == "heavy symmetric top"
    assert run.remarks[-1] == "Upright it would not stay."
    assert run.position is not None
    with mpmath.workdps(30):
        truth = newton(center, spin, max(moments), run.time[1:].tolist())
    for k, row in enumerate(truth, 1):
        np.testing.assert_allclose(run.position[k], np.array(row[:3], dtype=np.float64), atol=2e-14)
        apart = quaternion.angle_between(np.array(row[6:], dtype=np.float64), run.attitude[k])
        assert apart <= run.error.reached


def test_a_pendulum_without_thickness_has_no_neighbours() -> None:
    with pytest.raises(GeometryError, match="a body without thickness has no bodies next to it for a derivative"):
        sensitivity(pendulum([0, 0, 0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]))
