"""The methods that are measured: each takes a motion and a setting, and returns a call that gives the last attitude.

What is made ready outside the call is what a user makes once: a problem, a compiled stepper, a model.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from tests.dynamics.integrators.loaded import AxialDamping

from inertia.dynamics.integrators import runge_kutta, splitting, taylor
from inertia.dynamics.integrators.methods import METHODS
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.loads.gravity import Gravity
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.models.free.motion import free_motion
from inertia.native import Kernel

from . import peers
from .scenes import Motion

Call = Callable[[], Any]
Prepare = Callable[[Motion, float, float], Call]
"""(motion, duration in s, setting) → call."""

STEPS = tuple(float(x) for x in 0.8 * 0.5 ** np.arange(0.0, 9.0, 0.75))
"""Steps in units of 1/|ω|."""

KERNELS = [
    kernel
    for module in (taylor, splitting, runge_kutta)
    for kernel in vars(module).values()
    if isinstance(kernel, Kernel)
]

MUJOCO_STEPS = STEPS[3:]
"""Coarser ones make it unstable."""


@dataclass(frozen=True)
class Contestant:
    """A method and its settings: tolerances, or steps in units of 1/|ω|, the coarsest first."""

    name: str
    prepare: Prepare
    settings: tuple[float, ...]
    fits: Callable[[Motion], bool] = lambda motion: True


def closed_form(motion: Motion, duration: float, setting: float) -> Call:
    """Return `inertia.dynamics.models.free.motion.free_motion`."""
    return lambda: free_motion(motion.moments, motion.spin, [duration])[0][0]


def stepped(name: str) -> Prepare:
    """Return one of the package's stepping methods, one run of it without the estimate of its error."""

    def prepare(motion: Motion, duration: float, setting: float) -> Call:
        problem = problem_of(motion)
        for kernel in KERNELS:
            _ = kernel.function  # compiled, as heyoka's stepper is
        method, time = METHODS[name], np.array([duration])
        control = setting if hasattr(method, "tightest") else setting / float(np.linalg.norm(motion.spin))
        return lambda: method.run(problem, time, control).attitude[0]

    return prepare


def problem_of(motion: Motion) -> RotationProblem:
    """Return a motion as the package's own problem."""
    loads: list[Any] = []
    body: dict[str, Any] = {}
    if motion.weight:
        body = {"mass": motion.weight.mass, "arm": motion.weight.offset}
        loads.append(Gravity(motion.weight.gravity))
    if motion.drive:
        drive = motion.drive
        loads += [Torque(drive.body), Torque(drive.space, frame="space"), AxialDamping(drive.damping)]
    return RotationProblem(motion.moments, motion.spin, loads=tuple(loads), **body)


def _half_decades(first: int, last: int) -> tuple[float, ...]:
    return tuple(float(f"{10.0 ** (-0.5 * k):.2g}") for k in range(2 * first, 2 * last + 1))


CLOSED, TAYLOR = "inertia, closed form", "inertia, Taylor"

CONTESTANTS = (
    Contestant(CLOSED, closed_form, (0.0,), lambda motion: motion.free),
    Contestant(TAYLOR, stepped("Taylor"), _half_decades(2, 17)),
    *(Contestant(f"inertia, splitting {n}", stepped(f"splitting {n}"), STEPS) for n in (2, 4, 6, 8)),
    Contestant("inertia, RK4", stepped("RK4"), STEPS),
    Contestant("heyoka", peers.heyoka, _half_decades(2, 16)),
    Contestant("MuJoCo, RK4", peers.mujoco("RK4"), MUJOCO_STEPS, peers.mujoco_fits),
    Contestant("MuJoCo, implicitfast", peers.mujoco("implicitfast"), MUJOCO_STEPS, peers.mujoco_fits),
    *(
        Contestant(f"SciPy {name}", peers.scipy(name), (1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13, peers.SCIPY_TIGHTEST))
        for name in ("DOP853", "LSODA", "RK45")
    ),
)


def selected(motion: Motion) -> str:
    """Return the method that the package selects for a motion."""
    return CLOSED if motion.free else TAYLOR
