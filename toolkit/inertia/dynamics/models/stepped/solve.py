"""Motions that have no closed form: a stepping method and its control, from the accuracy asked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from difflib import get_close_matches
from typing import TypeGuard

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.dynamics.arguments import rounded_up
from inertia.dynamics.integrators import methods
from inertia.dynamics.integrators.error_control import rounding
from inertia.dynamics.integrators.loop import Integrator, States
from inertia.dynamics.integrators.rotation import RotationProblem
from inertia.dynamics.integrators.scipy_methods import PROBES, SciPy
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.load import Load
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.motion import Motion
from inertia.errors import GeometryError, UsageError

ATTEMPTS = 8
"""Controls that are tried for one accuracy."""

ATTITUDE_LOST = 0.1
"""The error in rad from which on no accuracy is advised."""

_LONG = 1e5  # rad, of a run that is not made again to find what can be reached
_TOO_LONG = 1e7  # rad, of a run for which nothing is advised but a shorter one

_FEW = 64  # probes between two samples

_REPAYS = 3.0  # times the steps between two samples, that a restart takes
_NUDGE = 1e-6 * np.array([1.0, -1.0, 0.5])  # rad, and of ω in units of its rate
_MARGIN = 3.0  # of what a nudge grows by
_FASTER = 100.0  # times the error of the attitude in a unit of time, that ω at the next sample may be off by

_LITTLE = 0.05  # of |ω|, that axes may turn at beside it without a remark

STIFF = 1e4
"""Decay times of the damping in a run above which an implicit method is taken, if nothing else is as fast."""


def solve_stepped(
    problem: RotationProblem, time: ArrayLike, accuracy: float, method: str | None = None, *, noise: float = 0.0
) -> Motion:
    """Step a body through `time` to an attitude error of at most `accuracy`.

    The control of the method (step or tolerance) is first guessed from its order, then the run is repeated at a coarser
    level to estimate its error, and the control is refined until the estimate is within the accuracy.

    Parameters
    ----------
    problem : the body, its start and its loads
    time : (n,) s, ascending from the start on
    accuracy : rad, at every sample
    noise : rad, what the rounding of the problem itself moves the attitude by
    method : one of `methods.METHODS`; None picks Taylor for polynomial loads, LSODA where damping is stiff, else DOP853

    Returns
    -------
    Motion along the principal axes of the problem, with the invariants of its loads.

    Raises `UsageError` for times, an accuracy or a method that cannot be used, `GeometryError` where float64 or the
    method does not reach the accuracy, with one that it does.

    >>> from inertia.dynamics.loads.torque import Torque
    >>> spun = RotationProblem([1.0, 1.0, 2.0], [0.0, 0.0, 0.0], loads=(Torque([0.0, 0.0, 4.0]),))
    >>> motion = solve_stepped(spun, [0.0, 1.0], 1e-9)
    >>> motion.method, motion.reached < 1e-9
    ('Taylor', True)
    >>> motion.angular_velocity[-1].round(9).tolist()
    [0.0, 0.0, 2.0]
    """
    instants = _instants(problem, time)
    problem = _cut_at_jumps(problem, float(instants[-1]), PROBES)
    integrator, states, reached = stepped(problem, instants, accuracy, method, noise)
    return motion_of(problem, instants, integrator.name, states, reached)


def motion_of(problem: RotationProblem, instants: Float, method: str, states: States, reached: float) -> Motion:
    """Return states at instants (n,), which begin with the start, with what the loads keep of them."""
    invariants = problem.invariants(states.attitude, states.angular_velocity)
    start = problem.moments * problem.angular_velocity
    momentum = float(np.linalg.norm(start))
    scales = {name: momentum for name in invariants if name != "energy" and momentum}
    if len(problem.loads) == 1:
        integrals = problem.loads[0].integrals(instants, states.attitude, states.angular_velocity, problem)
        invariants |= {name: values for name, (values, _) in integrals.items()}
        scales |= {name: size for name, (_, size) in integrals.items()}
    if "energy" in invariants:
        pulls = [np.abs(load.potential(states.attitude, problem)).max() for load in problem.loads]
        scales["energy"] = float(0.5 * (start * problem.angular_velocity).sum() + sum(pulls)) or 1.0
    return Motion(
        attitude=states.attitude,
        angular_velocity=states.angular_velocity,
        method=method,
        reached=reached,
        invariants=invariants,
        scales=scales,
        warnings=_warnings(problem),
        remarks=_remarks(problem, float(instants[-1]), states.angular_velocity),
        steps=states.steps,
    )


def stepped(
    problem: RotationProblem, instants: Float, accuracy: float, method: str | None, noise: float = 0.0
) -> tuple[Integrator, States, float]:
    """Return the method, the states at the instants and the estimate of their largest attitude error."""
    if not accuracy > 0:
        raise UsageError(f"accuracy is {accuracy}: give an angle in rad above zero")
    integrator = _select(problem, method, float(instants[-1]))
    least = rounding(problem.angular_velocity, instants[-1] - problem.start) + noise
    states, reached = _refine(integrator, problem, instants, accuracy, noise) if accuracy >= least else (None, least)
    if states is None:
        raise _unreachable(integrator, problem, instants, accuracy, reached, noise)
    return integrator, states, reached


def restarted(
    problem: RotationProblem, time: Float, accuracy: float, method: str, known: tuple[Float, States], reached: float
) -> tuple[States, float] | None:
    """Return the states at instants from those of a run at its samples, and the error; None where that does not repay.

    From the sample before an instant the motion is stepped to the next one. What the sample is off by grows on the way
    as a nudge of it does; where the next sample is not met within that, or the accuracy is not, all has to be stepped
    again.

    Parameters
    ----------
    problem : as it was stepped; time : (n,) s, within the run; method : that ran
    known : instants (k,) s of samples and states there, of which the attitudes are off by `reached` rad at most
    """
    samples, there = known
    rows = np.searchsorted(samples, time, side="right") - 1
    attitude, spin = there.attitude[rows], there.angular_velocity[rows]
    between = samples[rows] != time
    spans = np.unique(rows[between]).tolist()
    if _REPAYS * sum(samples[k + 1] - samples[k] for k in spans) > samples[-1] - samples[0]:
        return None
    integrator, worst, steps = methods.METHODS[method], reached, 0
    for k in spans:
        length, some = float(samples[k + 1] - samples[k]), between & (rows == k)
        begun = replace(
            problem,
            attitude=there.attitude[k],
            angular_velocity=there.angular_velocity[k],
            start=samples[k],
        )
        instants = np.append(time[some], samples[k + 1])
        begun = _cut_at_jumps(begun, float(samples[k + 1]), _FEW)
        # The next sample shows pulses that are stepped over, and no step need be probed for them.
        loads = (replace(load, longest_step=length) if _is_probed(load) else load for load in begun.loads)
        begun = replace(begun, loads=tuple(loads))
        control = integrator.first(begun, instants, 0.1 * max(reached, 1e-13))
        states, estimate = integrator.solve(begun, instants, control)
        aside = replace(
            begun,
            attitude=quaternion.multiply(begun.attitude, (*(0.5 * _NUDGE), 1.0)),
            angular_velocity=begun.angular_velocity + begun.rate * _NUDGE[::-1],
        )
        grown = states.apart(integrator.run(aside, instants, control)) / float(np.linalg.norm(_NUDGE))
        off = reached * (1.0 + _MARGIN * max(grown - 1.0, 0.0)) + estimate
        met = quaternion.angle_between(states.attitude[-1], there.attitude[k + 1]) <= 2.0 * off
        faster = float(np.linalg.norm(states.angular_velocity[-1] - there.angular_velocity[k + 1]))
        if not (off <= accuracy and met and faster <= _FASTER * off * begun.fastest):
            return None
        attitude[some], spin[some] = states.attitude[:-1], states.angular_velocity[:-1]
        worst, steps = max(worst, off), steps + states.steps
    return States(attitude, spin, steps), worst


def state_between(problem: RotationProblem, time: Float, motion: Motion) -> Callable[[float], tuple[Float, Float]]:
    """Return a function that steps from the sample before an instant to it: t → attitude (4,), ω (3,).

    It is what `inertia.find_events` takes as `refine`.
    """
    integrator = methods.METHODS["DOP853" if problem.terms(problem.start) is None else "Taylor"]

    def refine(at: float) -> tuple[Float, Float]:
        k = max(int(np.searchsorted(time, at, side="right")) - 1, 0)
        there = replace(
            problem, attitude=motion.attitude[k], angular_velocity=motion.angular_velocity[k], start=float(time[k])
        )
        states = integrator.run(there, np.array([at]), 1e-14)
        return states.attitude[0], states.angular_velocity[0]

    return refine


def _is_probed(load: Load) -> TypeGuard[Torque]:
    return isinstance(load, Torque) and load.probed


def _cut_at_jumps(problem: RotationProblem, end: float, probes: int) -> RotationProblem:
    """Return the problem with breaks where a function that declares none jumps at an instant."""
    if not problem.probed or not end > problem.start:
        return problem
    loads = []
    for load in problem.loads:
        if _is_probed(load):
            jumps = load.jumps(problem.start, end, problem.attitude, problem.angular_velocity, probes)
            load = replace(load, breaks=np.union1d(load.breaks, jumps))
        loads.append(load)
    return replace(problem, loads=tuple(loads))


def _instants(problem: RotationProblem, time: ArrayLike) -> Float:
    instants = np.asarray(time, dtype=np.float64)
    if instants.ndim != 1 or not instants.size or not np.isfinite(instants).all():
        raise UsageError(f"time must be one row of finite numbers, not of shape {instants.shape}")
    if instants[0] < problem.start or (np.diff(instants) < 0).any():
        raise UsageError(f"time must ascend from {problem.start:.6g} s, where the motion starts")
    return instants


def _select(problem: RotationProblem, method: str | None, end: float) -> Integrator:
    if method is not None:
        if method not in methods.METHODS:
            close = get_close_matches(method, methods.METHODS, n=1, cutoff=0.4)
            hint = f"; did you mean {close[0]!r}?" if close else ""
            raise UsageError(f"unknown method {method!r}: use one of {', '.join(methods.METHODS)}{hint}")
        return methods.METHODS[method]
    terms = problem.terms(problem.start)
    if terms is None:
        return methods.METHODS["DOP853"]
    decay = float((terms.damping / problem.moments).max())
    stiff = decay > 10.0 * problem.rate and decay * (end - problem.start) > STIFF
    return methods.METHODS["LSODA" if stiff else "Taylor"]


def _refine(
    integrator: Integrator, problem: RotationProblem, time: Float, accuracy: float, noise: float
) -> tuple[States | None, float]:
    """Return the first run whose estimate is within the accuracy, and the estimate; None and the least without one."""
    control = integrator.first(problem, time, accuracy)
    best, stalled = np.inf, 0
    for _ in range(ATTEMPTS):
        states, estimate = integrator.solve(problem, time, control)
        estimate += noise
        if problem.probed and not isinstance(integrator, SciPy) and estimate <= accuracy:  # which may have missed one
            peer = methods.METHODS["DOP853"]
            estimate += states.apart(peer.run(problem, time, peer.first(problem, time, accuracy)))
        if estimate <= accuracy:
            return states, estimate
        finer = integrator.finer(control, estimate, accuracy)
        stalled = stalled + 1 if 0.9 * best < estimate < ATTITUDE_LOST else 0
        if finer >= control or stalled == integrator.patience:
            break
        best, control = min(best, estimate), finer
    return None, min(best, estimate)


def _unreachable(
    integrator: Integrator, problem: RotationProblem, time: Float, accuracy: float, reached: float, noise: float
) -> GeometryError:
    """Return what is wrong with an accuracy that is beyond float64 or the method, and one that has been tried."""
    phase = problem.fastest * (time[-1] - problem.start)
    goal, within = 2.0 * reached if phase < _TOO_LONG else np.inf, None
    while goal < ATTITUDE_LOST and within is None:
        if phase > _LONG:
            goal = within = 50.0 * goal
        elif _refine(integrator, problem, time, float(rounded_up(goal)), noise)[0] is not None:
            within = goal
        else:
            goal *= 5.0
    wish = f"{integrator.name} does not reach {accuracy:.2g} rad over {time[-1]:.6g} s in float64"
    if goal == np.inf:
        return GeometryError(f"{wish}, and some {phase:.1g} rad are too many to step through: ask for a shorter run")
    if within is None or within > ATTITUDE_LOST:
        return GeometryError(f"{wish}, nor {ATTITUDE_LOST:g} rad: ask for a shorter run, or for another method")
    return GeometryError(f"{wish}: ask for {rounded_up(within)} rad, a shorter run or another method")


def _remarks(problem: RotationProblem, end: float, spin: Float) -> tuple[str, ...]:
    """Say what a torque that is a function may still hide, and where dissipation turns the axes at another rate."""
    remarks = []
    if problem.probed:
        span = (end - problem.start) / PROBES
        remarks.append(
            f"Every step was probed for pulses of the torque that it missed, each {span:.2g} s at least: what is "
            "shorter needs its breaks, or a longest_step."
        )
    if (share := _beside(problem, spin)) > _LITTLE:
        remarks.append(
            "The rate of dissipation is large for this body: the angular velocity stated is I⁻¹ L, and the axes turn "
            f"at one that is up to {100.0 * share:.2g} % of it away."
        )
    return tuple(remarks)


def _beside(problem: RotationProblem, spin: Float) -> float:
    """Return the largest |Ω − ω|/|ω| over ω (n, 3), Ω being what the axes turn at (`loads.losses.Dissipation`)."""
    kappa = sum(load.dissipation for load in problem.loads)
    turning = spin[spin.any(axis=1)] if kappa else spin[:0]
    beside = kappa * np.cross(problem.moments * turning, turning) / problem.moments / problem.moments
    share = np.linalg.norm(beside, axis=1) / np.linalg.norm(turning, axis=1)
    return float(share.max(initial=0.0))


def _warnings(problem: RotationProblem) -> tuple[str, ...]:
    """Say so where the body is nearly free and close to the separatrix 2 T I₂ = L²: errors grow exponentially there."""
    low, middle, high = np.sort(problem.moments)
    momentum = problem.moments * problem.angular_velocity
    square = float((momentum**2).sum())
    if not square or low == middle or middle == high:
        return ()
    # As the body turns, too: the torque of gravity may happen to vanish where it starts.
    turns = quaternion.from_rotation_vector(np.vstack([np.zeros(3), np.eye(3)]))
    turned = (quaternion.multiply(problem.attitude, turn) for turn in turns)
    pull = max(np.abs(problem.torque(problem.start, each, problem.angular_velocity)).max() for each in turned)
    distance = abs(float((momentum**2 * (middle / problem.moments - 1.0)).sum())) / square
    if pull * middle > 1e-3 * square or distance > 1e-6:
        return ()
    growth = np.sqrt(square * (middle - low) * (high - middle) / (low * high)) / middle
    return (
        f"the body is nearly free and {distance:.2g} from its separatrix: an error grows e-fold every "
        f"{1.0 / growth:.3g} s (growth rate {growth:.3g} 1/s) while it spins about the intermediate axis",
    )
