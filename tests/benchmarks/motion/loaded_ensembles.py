"""Many bodies under gravity at once, on one core: draws a second and the error of each method that follows them.

All begin with spins about that of the heavy asymmetric top, 1 % apart, and are followed for ten of its revolutions; the
error is the largest of a few draws, whose truth is Taylor series in integers (`tests/dynamics/oracle.py`).
"""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from tests.dynamics import oracle

from inertia.arrays import Float
from inertia.dynamics.integrators import lanes
from inertia.dynamics.integrators.methods import METHODS
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.loads.gravity import Gravity
from inertia.dynamics.scene.body import SceneBody
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.scene.sections import Constraint, Settings, Start
from inertia.dynamics.spread.ensemble import ensemble

from . import peers
from .scenes import MOTIONS, Motion

COUNT, KNOWN, ROUNDS = 2048, 6, 3
"""Draws; those of them whose truth is computed; runs, of which the fastest counts."""

Run = Callable[[], tuple[Float, Float]]
"""Spins (m, 3) at the start, attitudes (m, 4) at the end."""

TOP = next(motion for motion in MOTIONS if motion.name == "heavy asymmetric top")
DURATION = TOP.duration(10)
SPINS = np.array(TOP.spin) * (1.0 + 0.01 * np.random.default_rng(17).standard_normal((COUNT, 3)))


def loaded_ensembles(say: Callable[[str], None]) -> dict[str, Any]:
    """Return {method: [[setting, draws a second, error in rad], …]}."""
    result: dict[str, Any] = {}
    for name, setting, prepare in _contestants():
        run = prepare()
        spins, attitudes = run()
        known = zip(spins[:KNOWN].tolist(), attitudes[:KNOWN], strict=True)
        error = max(_truth(*spin).attitude_error(attitude[None])[0] for spin, attitude in known)
        seconds = []
        for _ in range(ROUNDS):
            begin = time.process_time()
            run()
            seconds.append(time.process_time() - begin)
        row = [setting, float(f"{len(attitudes) / min(seconds):.3g}"), float(f"{error:.2g}")]
        result.setdefault(name, []).append(row)
        say(f"{name}: {row}")
    return result


@functools.cache
def _truth(*spin: float) -> oracle.Answer:
    assert TOP.weight is not None
    weight = {"mass": TOP.weight.mass, "offset": TOP.weight.offset, "gravity": TOP.weight.gravity}
    return oracle.rotate(TOP.moments, spin, [DURATION], **weight)


def _contestants() -> Iterator[tuple[str, float, Callable[[], Run]]]:
    for tolerance in (1e-5, 1e-7, 1e-9, 1e-11, 1e-13, 1e-15):
        yield "inertia, eight at once", tolerance, lambda tolerance=tolerance: _side_by_side(tolerance)
        yield "inertia, one by one", tolerance, lambda tolerance=tolerance: _one_by_one(tolerance)
        for size in (4, 8):
            name = f"heyoka, batch of {size}"
            yield name, tolerance, lambda tolerance=tolerance, size=size: _heyoka(tolerance, size)
    for accuracy in (1e-4, 1e-6, 1e-8, 1e-10, 1e-11):
        yield "inertia.ensemble, error estimated", accuracy, lambda accuracy=accuracy: _ensemble(accuracy)
    for setting in (0.3, 0.1, 0.03):
        yield "MuJoCo, RK4", setting, lambda setting=setting: _mujoco(setting)


def _problem(spin: Float) -> RotationProblem:
    assert TOP.weight is not None
    weight = TOP.weight
    return RotationProblem(TOP.moments, spin, loads=(Gravity(weight.gravity),), mass=weight.mass, arm=weight.offset)


def _side_by_side(tolerance: float) -> Run:
    terms = _problem(SPINS[0]).terms(0.0)
    assert terms is not None
    row = terms.packed(1.0, 1.0)
    attitude = np.tile([0.0, 0.0, 0.0, 1.0], (COUNT, 1))
    bodies = lanes.Bodies(np.tile(TOP.moments, (COUNT, 1)), attitude, SPINS, np.tile(row, (COUNT, 1)))
    return lambda: (SPINS, lanes.follow_bodies(bodies, np.array([DURATION]), tolerance)[0][:, -1])


def _one_by_one(tolerance: float) -> Run:
    some = [_problem(spin) for spin in SPINS[: COUNT // 8]]
    method, instant = METHODS["Taylor"], np.array([DURATION])

    def run() -> tuple[Float, Float]:
        return SPINS[: len(some)], np.array([method.run(each, instant, tolerance).attitude[0] for each in some])

    return run


def _ensemble(accuracy: float) -> Run:
    """Return the public verb, three runs and the table of the draws included."""
    assert TOP.weight is not None
    mass, offset = TOP.weight.mass, np.array(TOP.weight.offset)
    about = np.diag(TOP.moments) - mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    body = SceneBody(about, mass, offset)
    start = Start(TOP.spin, frame="part")
    loads = (Gravity(TOP.weight.gravity),)
    settings = Settings(DURATION, accuracy=accuracy)
    scene = Scene(body, start, settings, constraint=Constraint("fixed_point"), applied_loads=loads)
    vary = {f"start.angular_velocity[{k}]": f"{spin!r}±{0.01 * spin!r}" for k, spin in enumerate(TOP.spin)}
    names = [f"attitude[{k}]" for k in range(4)]

    def run() -> tuple[Float, Float]:
        spread = ensemble(scene, vary, COUNT, quantities=names, samples=2, jobs=1)
        return spread.values, np.array([spread.quantities[name][:, -1] for name in names]).T

    return run


def _heyoka(tolerance: float, size: int) -> Run:
    import heyoka

    system = peers.equations(TOP, float)
    start = np.zeros((7, size))
    start[3] = 1.0
    start[4:] = 1.0
    stepper = heyoka.taylor_adaptive_batch(system, start, tol=tolerance, force_avx512=size == 8)

    def run() -> tuple[Float, Float]:
        ends = np.empty((COUNT, 4))
        for first in range(0, COUNT, size):
            stepper.set_time(0.0)
            stepper.state[:3] = 0.0
            stepper.state[3] = 1.0
            stepper.state[4:] = SPINS[first : first + size].T
            stepper.propagate_until(DURATION)
            ends[first : first + size] = stepper.state[:4].T
        return SPINS, ends

    return run


def _mujoco(setting: float) -> Run:
    """Return `mujoco.rollout`, which steps many bodies in one call, in one thread."""
    import mujoco
    from mujoco import rollout

    motion: Motion = TOP
    steps = int(np.ceil(DURATION * float(np.linalg.norm(motion.spin)) / setting))
    model = mujoco.MjModel.from_xml_string(peers.model_of(motion, "RK4"))
    model.opt.timestep = DURATION / steps
    data = mujoco.MjData(model)
    count = COUNT // 8
    start = np.zeros((count, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    start[:, 1] = 1.0  # time, then a quaternion with its scalar first
    start[:, 5:8] = SPINS[:count]

    def run() -> tuple[Float, Float]:
        states, _ = rollout.rollout(model, data, start, nstep=steps)
        return SPINS[:count], np.roll(np.asarray(states)[:, -1, 1:5], -1, axis=1)

    return run
