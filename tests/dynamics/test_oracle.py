"""The Taylor oracle against closed forms and conserved quantities, at 25 digits and more."""

import mpmath
import numpy as np
import pytest
from tests.dynamics.oracle import rotate


def test_symmetric_top_precesses_as_its_closed_form_says() -> None:
    """I = (2, 2, 3), ω = (1, 0, 2): q = exp(t L/2I₁) in space, times a turn by (1 − I₃/I₁) ω₃ t about axis 3."""
    answer = rotate((2.0, 2.0, 3.0), (1.0, 0.0, 2.0), [10.0])
    with mpmath.workdps(50):
        t = mpmath.mpf(10)
        momentum = [mpmath.mpf(2), mpmath.mpf(0), mpmath.mpf(6)]
        size = mpmath.norm(momentum)
        half = t * size / 4
        x, y, z, w = [mpmath.sin(half) * m / size for m in momentum] + [mpmath.cos(half)]
        own = (1 - mpmath.mpf(3) / 2) * 2 * t / 2
        s, c = mpmath.sin(own), mpmath.cos(own)
        expected = np.array([x * c + y * s, y * c - x * s, z * c + w * s, w * c - z * s])
        assert max(abs(answer.attitude[0] - expected)) < 1e-27
    assert answer.error < 1e-27


def test_constant_torque_about_an_axis_gives_half_a_t_squared() -> None:
    answer = rotate((1.0, 2.0, 4.0), (0.0, 0.0, 0.0), [0.0, 3.0], body_torque=(0.0, 0.0, 2.0))
    with mpmath.workdps(50):
        assert abs(answer.attitude[1][2] - mpmath.sin(mpmath.mpf(9) / 8)) < 1e-28
        assert abs(answer.angular_velocity[1][2] - 1.5) < 1e-28


def test_damped_axis_slows_down_exponentially() -> None:
    answer = rotate((1.0, 2.0, 4.0), (0.0, 3.0, 0.0), [2.0], damping=0.5)
    with mpmath.workdps(50):
        assert abs(answer.angular_velocity[0][1] - 3 * mpmath.exp(mpmath.mpf(-1) / 2)) < 1e-28


@pytest.mark.parametrize(
    "loads",
    [
        {"mass": 1.0, "offset": (0.1, 0.2, 0.3), "gravity": (0.5, 0.0, -9.0)},
        {"gravity_gradient": (4.0, (1.0, 2.0, 0.5))},
    ],
)
def test_conservative_loads_keep_the_energy(loads: dict[str, object]) -> None:
    times = np.linspace(0.0, 4.0, 3)
    answer = rotate((1.0, 2.0, 2.5), (1.0, 0.5, 2.0), times, **loads)  # type: ignore[arg-type]
    with mpmath.workdps(50):
        energies = [
            energy((1.0, 2.0, 2.5), q, w, loads) for q, w in zip(answer.attitude, answer.angular_velocity, strict=True)
        ]
        assert max(abs(e - energies[0]) for e in energies) < 1e-25


def energy(moments: tuple[float, ...], q: np.ndarray, w: np.ndarray, loads: dict[str, object]) -> mpmath.mpf:
    x, y, z, s = q
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * s), 2 * (x * z + y * s)],
        [2 * (x * y + z * s), 1 - 2 * (x * x + z * z), 2 * (y * z - x * s)],
        [2 * (x * z - y * s), 2 * (y * z + x * s), 1 - 2 * (x * x + y * y)],
    ]
    total = sum(i * o * o for i, o in zip(moments, w, strict=True)) / 2
    if "gravity" in loads:
        arm = [sum(r * c for r, c in zip(row, loads["offset"], strict=True)) for row in rows]  # type: ignore[call-overload]
        return total - loads["mass"] * sum(a * g for a, g in zip(arm, loads["gravity"], strict=True))  # type: ignore[call-overload,operator]
    mu, place = loads["gravity_gradient"]  # type: ignore[misc]
    toward = [sum(rows[k][j] * place[k] for k in range(3)) for j in range(3)]
    distance = mpmath.sqrt(sum(mpmath.mpf(p) ** 2 for p in place))
    return total + 1.5 * mu / distance**5 * sum(i * t * t for i, t in zip(moments, toward, strict=True))


def test_attitude_error_is_the_angle_of_the_turn_between() -> None:
    answer = rotate((1.0, 2.0, 3.0), (0.0, 0.0, 1.0), [2.0])
    off = [[0.0, 0.0, -np.sin(1.0 + 5e-9), -np.cos(1.0 + 5e-9)]]
    assert answer.attitude_error(np.array(off)) == pytest.approx([1e-8], rel=1e-6)
