"""Other libraries, each called as its own documentation calls it."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import astuple
from typing import Any

import numpy as np

from .scenes import Motion

SCIPY_TIGHTEST = 2.3e-14
"""solve_ivp takes no smaller relative tolerance (100 ε)."""


def scipy(method: str) -> Callable[[Motion, float, float], Callable[[], Any]]:
    """Return `scipy.integrate.solve_ivp` on the quaternion and ω."""

    def prepare(motion: Motion, duration: float, tolerance: float) -> Callable[[], Any]:
        from scipy.integrate import solve_ivp

        start = np.array([0.0, 0.0, 0.0, 1.0, *motion.spin])
        rates = _rates(motion)

        def call() -> Any:
            result = solve_ivp(rates, (0.0, duration), start, method, [duration], rtol=tolerance, atol=tolerance)
            return result.y[:4, -1]

        return call

    return prepare


def _rates(motion: Motion) -> Callable[[float, Any], list[float]]:
    a, b, c = motion.moments
    weight, drive = motion.weight, motion.drive

    def rates(time: float, state: Any) -> list[float]:
        x, y, z, w, p, q, r = state.tolist()
        torque = [0.0, 0.0, 0.0]
        if weight:
            pull = _to_body(x, y, z, w, *(weight.mass * g for g in weight.gravity))
            torque = _cross(weight.offset, pull)
        if drive:
            pull = _to_body(x, y, z, w, *drive.space)
            torque = [n + f - d * o for n, f, d, o in zip(drive.body, pull, drive.damping, (p, q, r), strict=True)]
        return [
            0.5 * (w * p + y * r - z * q),
            0.5 * (w * q + z * p - x * r),
            0.5 * (w * r + x * q - y * p),
            -0.5 * (x * p + y * q + z * r),
            ((b - c) * q * r + torque[0]) / a,
            ((c - a) * r * p + torque[1]) / b,
            ((a - b) * p * q + torque[2]) / c,
        ]

    return rates


def _to_body(x: Any, y: Any, z: Any, w: Any, p: Any, q: Any, r: Any) -> list[Any]:
    """Return a vector of space along the axes of the body; of floats or of heyoka's expressions."""
    t = [2.0 * k for k in _cross((p, q, r), (x, y, z))]
    return [a + w * b + k for a, b, k in zip((p, q, r), t, _cross(t, (x, y, z)), strict=True)]


def _cross(u: Any, v: Any) -> list[Any]:
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


def heyoka(motion: Motion, duration: float, tolerance: float) -> Callable[[], Any]:
    """Return `heyoka.taylor_adaptive`, compiled beforehand."""
    stepper = _stepper(motion, tolerance)

    def call() -> Any:
        stepper.time = 0.0
        stepper.state[:] = [0.0, 0.0, 0.0, 1.0, *motion.spin]
        stepper.propagate_until(duration)
        return stepper.state[:4].copy()

    return call


@functools.cache
def _stepper(motion: Motion, tolerance: float) -> Any:
    import heyoka

    return heyoka.taylor_adaptive(equations(motion, float), [0.0, 0.0, 0.0, 1.0, *motion.spin], tol=tolerance)


def equations(motion: Motion, number: Callable[[float], Any]) -> list[tuple[Any, Any]]:
    """Return a motion in heyoka's expressions, its constants made by `number`."""
    import heyoka

    q, spin = heyoka.make_vars("x", "y", "z", "w"), heyoka.make_vars("p", "q", "r")
    x, y, z, w = q
    moments = [number(i) for i in motion.moments]
    momentum = [i * o for i, o in zip(moments, spin, strict=True)]
    torque = _cross(momentum, spin)
    if motion.weight:
        mass, offset = number(motion.weight.mass), [number(k) for k in motion.weight.offset]
        pull = _to_body(x, y, z, w, *(mass * number(g) for g in motion.weight.gravity))
        torque = [n + f for n, f in zip(torque, _cross(offset, pull), strict=True)]
    if motion.drive:
        body, space, damping = ([number(k) for k in row] for row in astuple(motion.drive))
        pull = _to_body(x, y, z, w, *space)
        torque = [n + m + f - d * o for n, m, f, d, o in zip(torque, body, pull, damping, spin, strict=True)]
    a, b, c = spin
    turn = [w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a, -(x * a + y * b + z * c)]
    rates = [*(0.5 * k for k in turn), *(n / i for n, i in zip(torque, moments, strict=True))]
    return list(zip([*q, *spin], rates, strict=True))


def mujoco_fits(motion: Motion) -> bool:
    """Say whether MuJoCo knows such loads."""
    return motion.drive is None


def mujoco(integrator: str) -> Callable[[Motion, float, float], Callable[[], Any]]:
    """Return `mujoco.mj_step` of a body on a ball joint."""

    def prepare(motion: Motion, duration: float, setting: float) -> Callable[[], Any]:
        import mujoco

        mujoco.set_mju_user_warning(_ignore)  # an unstable run has an error that says so
        steps = int(np.ceil(duration * float(np.linalg.norm(motion.spin)) / setting))
        model = mujoco.MjModel.from_xml_string(model_of(motion, integrator))
        model.opt.timestep = duration / steps
        data = mujoco.MjData(model)

        def call() -> Any:
            mujoco.mj_resetData(model, data)
            data.qvel[:] = motion.spin
            mujoco.mj_step(model, data, steps)
            return np.roll(data.qpos, -1)

        return call

    return prepare


def _ignore(message: str) -> None:
    """Keep a warning out of the log file that MuJoCo would write."""


def model_of(motion: Motion, integrator: str) -> str:
    """Return the body in MuJoCo's language; its tensor is about the centre of mass (Steiner)."""
    mass, offset, gravity = 1.0, np.zeros(3), (0.0, 0.0, 0.0)
    if motion.weight:
        mass, offset, gravity = motion.weight.mass, np.array(motion.weight.offset), motion.weight.gravity
    tensor = np.diag(motion.moments) - mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    entries = [tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2]]
    full = " ".join(repr(float(k)) for k in entries)
    diagonal = " ".join(repr(k) for k in motion.moments)
    inertial = f'fullinertia="{full}"' if motion.weight else f'diaginertia="{diagonal}"'
    return f"""<mujoco>
  <compiler boundinertia="0" boundmass="0"/>
  <option integrator="{integrator}" gravity="{" ".join(map(repr, gravity))}">
    <flag contact="disable" constraint="disable"/>
  </option>
  <worldbody><body>
    <joint type="ball"/>
    <inertial pos="{" ".join(repr(float(k)) for k in offset)}" mass="{mass}" {inertial}/>
  </body></worldbody>
</mujoco>"""
