"""The model of a ball that slides on a plane with friction, which turns a tippe top over."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.model import Candidate, Model, Problem
from inertia.dynamics.models.neighbours import ROUNDED, InputBound, instants_of, left_open
from inertia.dynamics.models.sliding.equations import SlidingBall
from inertia.dynamics.motion import Event, Motion
from inertia.dynamics.scene.sections import SLIP_SPEED
from inertia.errors import FieldPath, GeometryError, UsageError, placed

_EVEN = 0.1  # part of the accuracy that what is left of symmetry may cost, for Jellett's integral to be kept
_UPRIGHT = 1e-9  # rad between the plane's normal and gravity, below which the plane is level
_GRID, _FINER = 2049, 65  # instants at which the normal force is looked at for its sign, and again about a change
_GRID_TOLERANCE = 1e-9
_BALANCED = 1e-3  # rad from the normal, within which a spin is balanced on it
_REAL = 1e-9  # of the imaginary part of a root that is real
_MARGIN = 3.0  # of what the growth of a change of the start says about other mass properties
_FINEST = 1e-13  # the tolerance of neighbours whose difference is taken
_METHODS = ("DOP853", "LSODA", "Radau", "RK4")


class Sliding(Model):
    """A ball on a plane with friction."""

    name = "sliding ball"

    @property
    def methods(self) -> Mapping[str, int]:
        """The stepping methods for equations that are no polynomials."""
        from inertia.dynamics.integrators import methods

        return {name: methods.METHODS[name].order for name in _METHODS}

    def candidate(self, problem: Problem) -> Candidate | None:
        """Return the model of every ball that slides; it leaves nothing out."""
        if not problem.slides:
            return None
        why = (
            "The ball slides with friction, for which there is no closed form: attitude, angular velocity and the "
            "velocity along the plane are integrated, and the normal force follows from the contact."
        )
        return Candidate(self, problem, problem.axes, problem.moments, 0.0, why)

    def solve(self, candidate: Candidate, time: Float, method: str | None = None) -> Motion:
        """Return what stepping gives, turned from the plane's axes into space."""
        from inertia.dynamics.models.stepped.solve import stepped

        problem, scene = candidate.problem, candidate.problem.scene
        ball, turn = _ball(candidate)
        try:
            noise = float(_left_open(ball, np.union1d(time, instants_of(float(time[-1]))), ROUNDED)[-1])
            integrator, states, reached = stepped(ball, time, scene.run.accuracy, method, noise)
            attitude, spin = states.attitude, states.angular_velocity
            leaves = _lift_off(ball, float(time[-1]))
        except (UsageError, GeometryError) as error:
            why = _unstable(ball, problem.symmetric_about(_axis(ball))[1])
            with suppress(GeometryError):
                why = why or "".join(event.what for event in _lift_off(ball, float(time[-1])))
            words = GeometryError(*error.words, f"; {why}", places=error.places, code=error.code) if why else error
            raise placed(words, scene.name, FieldPath("run")) from None
        place, heat = states.carried[:, 2:4], states.carried[:, 4]
        arm = ball.contact(attitude)
        center = np.column_stack([place, -arm[:, 2]])
        velocity, slip = ball.velocities(attitude, spin, states.carried[:, :2])
        force = ball.force(attitude, spin, slip)
        kinetic = 0.5 * (ball.moments * spin**2).sum(axis=1) + 0.5 * ball.mass * (velocity**2).sum(axis=1)
        potential = -ball.mass * (center @ ball.gravity)
        invariants = {"energy and heat": kinetic + potential + heat}
        scales = {"energy and heat": float(np.abs(kinetic).max() + np.abs(potential).max() + heat.max())}
        axis = _axis(ball)
        jellett = ball.jellett(attitude, spin)
        _, moments, defect = problem.symmetric_about(axis)
        even = not ball.arm.any() or defect * problem.pace * problem.duration <= _EVEN * scene.run.accuracy
        if even:
            invariants["Jellett's integral"] = jellett
            scales["Jellett's integral"] = ball.radius * float(np.linalg.norm(ball.moments * spin, axis=1).max())
        tilt = np.arctan2(*_sides(quaternion.to_space(attitude, axis)))
        quantities = {
            "theta": tilt,
            "contact": quaternion.to_space(turn, np.column_stack([(center + arm)[:, :2], np.zeros_like(heat)])),
            "contact velocity": quaternion.to_space(turn, slip),
            "contact force": quaternion.to_space(turn, force),
            "heat": heat,
        }
        remarks: tuple[str, ...] = ()
        if even and ball.arm.any() and np.linalg.norm(ball.gravity[:2]) <= _UPRIGHT * -ball.gravity[2]:
            remarks = (_stable(ball, moments),)
            if ball.friction:  # without it nothing takes the body to where its energy is least
                end, least = _end(ball, moments, float(jellett[0]))
                remarks += (end,)
                quantities["theta of least energy"] = np.array(least)
        return replace(
            Motion(attitude, spin, integrator.name, reached, center, invariants, scales, quantities).turned(turn),
            position=quaternion.to_space(turn, center),
            events=leaves,
            warnings=tuple(f"{event.what}: what follows is held down by a plane that pulls" for event in leaves),
            remarks=remarks,
            steps=states.steps,
        )

    def energy(self, candidate: Candidate, motion: Motion) -> Float:
        """Return the energy (n,) J of the motion, and of the height over the plane at the start."""
        energy: Float = motion.invariants["energy and heat"] - motion.quantities["heat"]
        return energy

    def input_bound(self, candidate: Candidate) -> InputBound:
        """Return how far the bounds of the mass properties may move the attitude: as a change of the start does."""
        problem = candidate.problem
        unknown = _MARGIN * problem.relative_contact_bound
        if not unknown:
            return InputBound.none(problem.duration)
        instants = instants_of(problem.duration)
        moved = _left_open(_ball(candidate)[0], instants, unknown)
        return InputBound(instants, np.maximum(moved, unknown * problem.pace * instants))

    def view(self, problem: Problem) -> str:
        """Show the path and the forces of contact."""
        return "disc"


def slid(candidate: Candidate, duration: float) -> Float:
    """Return the attitude (4,) of the candidate's axes after `duration` s, as finely as it is stepped."""
    from inertia.dynamics.integrators import methods

    ball, turn = _ball(candidate)
    states = methods.METHODS["DOP853"].run(ball, np.array([duration]), _FINEST)
    return quaternion.multiply(turn, states.attitude[-1])


def _ball(candidate: Candidate) -> tuple[SlidingBall, Float]:
    """Return the ball in the plane's axes, and the turn (4,) from these to space."""
    scene = candidate.problem.scene
    held, start = scene.constraint, scene.start
    assert held.radius is not None  # the scene saw to it
    assert held.friction is not None
    turn = _upwards(held.plane)
    velocity = np.zeros(3) if start.velocity is None else quaternion.to_body(turn, start.velocity)
    ball = SlidingBall(
        moments=candidate.moments,
        angular_velocity=candidate.angular_velocity,
        attitude=quaternion.multiply(quaternion.conjugate(turn), candidate.attitude),
        mass=candidate.mass,
        arm=candidate.axes.T @ (held.fixed_point - scene.body.center_of_mass),
        radius=held.radius,
        friction=held.friction,
        slip_speed=SLIP_SPEED if held.slip_speed is None else held.slip_speed,
        gravity=quaternion.to_body(turn, scene.gravity),
        velocity=velocity[:2],
    )
    return ball, turn


def _left_open(ball: SlidingBall, instants: Float, relative: float) -> Float:
    """Return (n,) how far what is left open of the figures of the start may move the attitude, rad."""
    from inertia.dynamics.integrators import methods

    def follow(change: Float, tolerance: float) -> Float:
        there = replace(
            ball,
            attitude=quaternion.multiply(quaternion.from_rotation_vector(change[:3]), ball.attitude),
            angular_velocity=ball.angular_velocity + ball.rate * change[3:6],
            velocity=ball.velocity + ball.radius * ball.rate * change[6:],
        )
        return methods.METHODS["DOP853"].run(there, instants, tolerance).attitude

    return left_open(follow, 8, relative)


def _upwards(normal: Float) -> Float:
    """Return a turn (4,) from z to a unit vector."""
    x, y, z = normal
    if z < 0:  # by way of −z, so that nothing cancels
        return quaternion.normalise(quaternion.multiply([y, -x, 0.0, 1.0 - z], [1.0, 0.0, 0.0, 0.0]))
    return quaternion.normalise(np.array([-y, x, 0.0, 1.0 + z]))


def _axis(ball: SlidingBall) -> Float:
    """Return the direction (3,) from the centre of mass to the ball's centre; of largest moment where they are one."""
    size = float(np.linalg.norm(ball.arm))
    return ball.arm / size if size else np.eye(3)[int(np.argmax(ball.moments))]


def _sides(vectors: Float) -> tuple[Float, Float]:
    """Return what vectors (n, 3) have across z, and along it."""
    return np.hypot(vectors[:, 0], vectors[:, 1]), vectors[:, 2]


def _lift_off(ball: SlidingBall, end: float) -> tuple[Event, ...]:
    """Return the event of the first instant up to `end` s at which the plane would have to pull."""
    from inertia.dynamics.integrators import methods

    def normal(times: Float) -> Float:
        states = methods.METHODS["DOP853"].run(ball, times, _GRID_TOLERANCE)
        _, slip = ball.velocities(states.attitude, states.angular_velocity, states.carried[:, :2])
        return ball.force(states.attitude, states.angular_velocity, slip)[:, 2]

    times = np.linspace(0.0, end, _GRID)
    for _ in range(2):
        pressed = normal(times)
        pulls = np.flatnonzero(pressed < 0)
        if not pulls.size:
            return ()
        first = int(pulls[0])
        if not first:
            break
        share = pressed[first - 1] / (pressed[first - 1] - pressed[first])
        instant = float(times[first - 1] + share * (times[first] - times[first - 1]))
        times = np.linspace(times[first - 1], times[first], _FINER)
    else:
        return (_leaving(instant),)
    return (_leaving(float(times[0])),)


def _leaving(instant: float) -> Event:
    return Event(
        "lift-off", instant, f"the normal force falls to zero at t = {instant:.6g} s and the body leaves the plane"
    )


def _stable(ball: SlidingBall, moments: Float) -> str:
    """Say which spins about the normal are stable."""
    low, high = _thresholds(ball, moments)
    below = f"below {low:.6g} rad/s" if low < math.inf else "at any speed"
    above = f"above {high:.6g} rad/s" if high < math.inf else "at no speed"
    return f"Spinning about the vertical is stable {below} with the centre of mass low, and {above} with it high."


def _end(ball: SlidingBall, moments: Float, jellett: float) -> tuple[str, float]:
    """Say which motion without slip has the least energy; its tilt in rad.

    Without slip and with its centre of mass at rest, the body turns about a: with Jellett's integral λ, u the cosine of
    the tilt, α = |b|/R and D = I₁ (1 − u²) + I₃ (u − α)², its energy is λ²/(2 R² D) + m g R (1 − α u). Upright, u = 1,
    is a minimum of it while λ² (I₁ − (1 − α) I₃) < m g R³ α I₃² (1 − α)⁴; upside down, u = −1, while
    λ² ((1 + α) I₃ − I₁) > m g R³ α I₃² (1 + α)⁴. Bou-Rabee, Marsden & Romero (2004), § 5; Cohen, Am. J. Phys. 45 (1977)
    12.
    """
    axial, shape, offset, weight = _shape(ball, moments)
    spin = abs(jellett) / (ball.radius * axial)
    cosine = _least(shape, offset, 2.0 * weight / spin**2) if spin else 1.0
    upright, over = cosine == 1.0, cosine == -1.0
    pace = spin / (1.0 - offset if upright else 1.0 + offset)
    how = f"spins with its centre of mass {'low' if upright else 'high'}, at {pace:.6g} rad/s"
    if not upright and not over:
        how = f"goes round with its axis tilted by {math.degrees(math.acos(cosine)):.4g}°"
    least = f"Of the motions without slip that have its Jellett's integral, the one with the least energy {how}."
    return least, math.acos(cosine)


def _shape(ball: SlidingBall, moments: Float) -> tuple[float, float, float, float]:
    """Return I₃, I₁/I₃, α and m g R α/I₃."""
    offset, axial = float(np.linalg.norm(ball.arm)) / ball.radius, float(moments[2])
    weight = -ball.mass * float(ball.gravity[2]) * ball.radius * offset / axial
    return axial, float(moments[0] / moments[2]), offset, weight


def _thresholds(ball: SlidingBall, moments: Float) -> tuple[float, float]:
    """Return the spins in rad/s below which upright is stable, and above which upside down is; infinite for none.

    With friction where the energy is least, see `_end`. Without, a body near the vertical turns about its centre of
    mass as a top about its point, which is I₃ ω > √(4 m g b I₁).
    """
    _, shape, offset, weight = _shape(ball, moments)
    if not ball.friction:
        return math.inf, 2.0 * math.sqrt(weight * shape)
    low, high = shape - (1.0 - offset), (1.0 + offset) - shape
    return (
        (1.0 - offset) * math.sqrt(weight / low) if low > 0 else math.inf,
        (1.0 + offset) * math.sqrt(weight / high) if high > 0 else math.inf,
    )


def _unstable(ball: SlidingBall, moments: Float) -> str:
    """Say so where the start is so near an unstable spin about the normal that small errors decide what follows."""
    axis = _axis(ball)
    across, along = (float(part[0]) for part in _sides(quaternion.to_space(ball.attitude, axis)[None]))
    low, high = _thresholds(ball, moments)
    spin, upright = abs(float(ball.angular_velocity @ axis)), along > 0
    if across > _BALANCED or not ball.arm.any() or (spin <= low if upright else spin >= high):
        return ""
    return (
        f"the start is {across:.2g} rad from a spin with the centre of mass {'low' if upright else 'high'}, which is "
        f"unstable {'above' if upright else 'below'} {low if upright else high:.4g} rad/s, and small errors grow: tilt "
        "the axis more"
    )


def _least(shape: float, offset: float, pull: float) -> float:
    """Return the u of −1 … 1 with the least 1/D − k u, D = γ (1 − u²) + (u − α)²; γ = I₁/I₃."""
    inertia = np.polynomial.Polynomial([shape + offset**2, -2.0 * offset, 1.0 - shape])
    roots = (inertia.deriv() + pull * inertia**2).roots()
    inner = roots.real[(np.abs(roots.imag) < _REAL) & (np.abs(roots.real) < 1.0)]
    candidates = np.array([1.0, -1.0, *inner])
    return float(candidates[np.argmin(1.0 / inertia(candidates) - pull * candidates)])
