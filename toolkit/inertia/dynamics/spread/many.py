"""Draws of a rigid body followed all at once: free ones in closed form, loaded or held ones by Taylor series.

What a draw needs is made for all of them as arrays. A draw that is near anything that a scene refuses is left to be
made as a scene, and one whose estimate does not reach the accuracy to be followed by itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float
from inertia.dynamics.integrators.lanes import Bodies, fits, follow_bodies, solve_bodies, tolerances
from inertia.dynamics.integrators.terms import HEAD, VECTOR, Terms
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.gravity import Gravity, GravityGradient
from inertia.dynamics.loads.load import Load
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.models.free.flips import first_flip, flip_period
from inertia.dynamics.models.free.motion import MOST_EVENTS, free_ensemble, rounding
from inertia.dynamics.run import Run
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.spread.draws import Draws, field_of, hinged
from inertia.dynamics.spread.fields import changed
from inertia.dynamics.spread.quantities import States
from inertia.errors import InertiaError
from inertia.records import dataclass

_FREE = ("spherical top", "steady axis", "symmetric top", "asymmetric top")
_KNOWN = ("deviation", "tilt", "spin", "energy", "attitude", "angular_velocity", "angular_momentum")
_LONGEST = 1e4  # rad, of a run by steps


@dataclass(frozen=True, eq=False)
class Motions:
    """The draws that were followed.

    Attributes
    ----------
    rows : (m,) of the draws; states : their motions; reached : (m,) rad
    model : the name of the model; events : {name: (m,) s} when it first happened
    """

    rows: NDArray[np.intp]
    states: States
    reached: Float
    model: str
    events: Mapping[str, Float]


def method_for(nominal: Run, paths: tuple[str, ...], names: tuple[str, ...]) -> str | None:
    """Return "free" or "Taylor" where one method can follow all draws as arrays; None where each is its own run.

    Parameters
    ----------
    nominal : the run without deviations
    paths : of what varies
    names : of the quantities that are asked for
    """
    scene = nominal.scene
    body, held = scene.body, scene.constraint
    if any(name.partition("[")[0] not in _KNOWN for name in names) or scene.run.model is not None:
        return None
    if any(field_of(path) not in _VARIED for path in paths) or body.assembly is not None:
        return None
    frames = [scene.start.frame, *(getattr(load, "frame", "") for load in scene.applied_loads)]
    if any(path.startswith("body.inertia") for path in paths) and "principal" in frames:
        return None  # the principal axes are those nearest to the scene's, for each draw by itself
    loaded = any(path.startswith("load") for path in paths)
    if nominal.model in _FREE and held.kind == "free" and not loaded and scene.run.method is None:
        return "free"
    long = float(np.linalg.norm(nominal.angular_velocity, axis=1).max()) * scene.run.duration > _LONGEST
    breaks = [load.breaks.size for load in scene.applied_loads if not (isinstance(load, Torque) and load.table)]
    if long or any(breaks):
        return None
    if nominal.model == "hinged body":
        momentum = any(name.startswith("angular_momentum") for name in names)
        return "Taylor" if held.drive == "free" and not held.stiffness and not momentum else None
    stepped = nominal.model == "Euler equations" and nominal.error.method == "Taylor"
    return "Taylor" if stepped or nominal.model == "heavy symmetric top" else None


_VARIED = frozenset(
    {f"body.{name}" for name in ("mass", "density", "scale", "center_of_mass", "inertia", "principal_moments")}
    | {"start.angular_velocity", "start.attitude", "constraint.point", "load"}
)


def follow_many(scene: Scene, paths: tuple[str, ...], values: Float, method: str, energy: bool) -> Motions:
    """Follow draws (m, k) of numbers at the instants of a scene; those that are not in the result are left to others.

    Parameters
    ----------
    scene : in which numbers are changed; paths : of the numbers
    method : of `method_for`
    energy : whether the energy is asked for; it is not a number without
    """
    draws = Draws.of(scene, paths, values)
    time = np.linspace(0.0, scene.run.duration, scene.run.samples)
    follow = _free if method == "free" else _loaded
    rows, attitude, spin, reached, loads = follow(scene, paths, values, draws, time, True)
    some = draws.some(rows)
    states = _states(some, attitude, spin, loads, energy)
    if rows.size and not draws.exact:
        aside = Draws.of(scene, paths, values, aside=True).some(rows)
        every, moved, turned, _, _ = follow(scene, paths, values[rows], aside, time, False)
        off = np.full(len(rows), np.inf)
        there = _states(aside.some(every), moved, turned, [], False).attitude
        off[every] = quaternion.angle_between(there, states.attitude[every]).max(axis=1)
        reached = reached + 2.0 * off
    events = {}
    if method == "free":
        flips = first_flip(some.moments, some.spin, scene.run.duration)
        few = scene.run.duration <= MOST_EVENTS * flip_period(some.moments, some.spin)  # as `solve_free` lists them
        if (few & np.isfinite(flips)).any():
            events["flip"] = np.where(few, flips, np.nan)
    good = reached <= scene.run.accuracy
    model = "asymmetric top" if method == "free" else "hinged body" if hinged(scene) else "Euler equations"
    return Motions(rows[good], states.some(good), reached[good], model, {name: t[good] for name, t in events.items()})


_Followed = tuple[NDArray[np.intp], Float, Float, Float, list[tuple[Load, ...]]]
"""Draws (m,), attitudes (m, n, 4) and spins (m, n, 3) of the principal axes, errors (m,) in rad, and loads."""


def _free(scene: Scene, paths: tuple[str, ...], values: Float, draws: Draws, time: Float, estimated: bool) -> _Followed:
    """Follow bodies that nothing turns, by their closed forms."""
    rows = np.flatnonzero(draws.sound & draws.spin.any(axis=1))
    some = draws.some(rows)
    relative, spin = free_ensemble(some.moments, some.spin, time)
    reached = rounding(some.moments, some.spin, time).max(axis=1)
    return rows, quaternion.multiply(some.attitude[:, None], relative), spin, reached, [()] * len(rows)


def _loaded(
    scene: Scene, paths: tuple[str, ...], values: Float, draws: Draws, time: Float, estimated: bool
) -> _Followed:
    """Follow bodies under loads, by Taylor series; where the error need not be `estimated`, once only."""
    starts = np.unique(np.concatenate([np.zeros(1), *(load.breaks for load in scene.applied_loads)]))
    starts = starts[(starts >= 0) & (starts < time[-1])].tolist()
    packed, every = _terms(scene, paths, values, draws, starts)
    rows = np.flatnonzero(draws.sound & (draws.spin.any(axis=1) | _turn(packed)) & np.isfinite(packed).all(axis=(1, 2)))
    terms = [packed[rows, k] for k in range(len(starts))]
    if not all(map(fits, terms)):
        rows, terms = rows[:0], [each[:0] for each in terms]
    some = draws.some(rows)
    later = tuple(zip(starts[1:], terms[1:], strict=True))
    bodies = Bodies(some.moments, some.attitude, some.spin, terms[0], later)
    acting = [every[k] for k in rows]
    if estimated:
        return rows, *solve_bodies(bodies, time, scene.run.accuracy), acting
    attitude, spin = np.full((len(rows), len(time), 4), np.nan), np.full((len(rows), len(time), 3), np.nan)
    for at, tolerance in tolerances(bodies, time, scene.run.accuracy):
        attitude[at], spin[at] = follow_bodies(bodies.some(at), time, tolerance)
    return rows, attitude, spin, np.zeros(len(rows)), acting


def _states(draws: Draws, attitude: Float, spin: Float, loads: list[tuple[Load, ...]], energy: bool) -> States:
    """Return motions of the principal axes as those of the part axes."""
    momentum = quaternion.to_space(attitude, draws.moments[:, None] * spin)
    total = np.full(spin.shape[:2], np.nan)
    if energy:
        total = 0.5 * (draws.moments[:, None] * spin**2).sum(axis=2)
        for k, each in enumerate(loads):
            body = SimpleNamespace(moments=draws.moments[k], mass=draws.mass[k], arm=draws.arm[k])
            for load in each:
                if load.conservative:
                    total[k] += load.potential(attitude[k], body)
    back = quaternion.conjugate(quaternion.from_matrix(draws.axes))[:, None]
    whole = quaternion.multiply(attitude, back)
    turns = np.cumsum(np.einsum("mni,mni->mn", whole[:, 1:], whole[:, :-1]) < 0, axis=1)
    whole[:, 1:] *= np.where(turns % 2, -1.0, 1.0)[:, :, None]  # as `quaternion.continuous`
    part = np.einsum("mij,mnj->mni", draws.axes, spin)
    return States(whole, part, momentum, total)


def _terms(
    scene: Scene, paths: tuple[str, ...], values: Float, draws: Draws, starts: list[float]
) -> tuple[Float, list[tuple[Load, ...]]]:
    """Return the packed terms (m, p, …) of each draw's loads, not numbers where a load is none, and the loads.

    Both are along the axes of the draw, the terms from each of `starts` (p,) s on.
    """
    varied = [k for k, path in enumerate(paths) if field_of(path) == "load"]
    held = scene.constraint.holds
    acting = [k for k, load in enumerate(scene.applied_loads) if held or not isinstance(load, Gravity)]
    gradient = any(isinstance(scene.applied_loads[k], GravityGradient) for k in acting)  # whose terms have the moments
    alike = not varied and not draws.turned and not (gradient and (draws.moments != draws.moments[:1]).any())
    packed: list[Float] = []
    every: list[tuple[Load, ...]] = []
    for k, figures in enumerate(values[:, varied]):
        if k and alike:
            packed, every = packed * len(values), every * len(values)
            break
        try:
            loads = changed(scene, {paths[i]: float(x) for i, x in zip(varied, figures, strict=True)}).applied_loads
        except InertiaError:
            packed.append(np.full((1, HEAD), np.nan))
            every.append(())
            continue
        body = SimpleNamespace(moments=draws.moments[k], mass=draws.mass[k], arm=draws.arm[k])
        along = tuple(loads[i].along(draws.axes[k], scene.body.axes) for i in acting)
        packed.append(np.array([_packed(scene, [load.terms(body, start) for load in along]) for start in starts]))
        every.append(along)
    shape = max((each.shape for each in packed), default=(1, HEAD))
    return np.array([each if each.shape == shape else np.full(shape, np.nan) for each in packed]), every


def _turn(packed: Float) -> Bool:
    """Say which draws (m,) have terms that may turn a body which is at rest."""
    vectors = packed[:, :, HEAD:].reshape(*packed.shape[:2], (packed.shape[2] - HEAD) // VECTOR, VECTOR)
    pulls = (vectors[..., :3] != 0).any(axis=-1) & (vectors[..., 3:15] != 0).any(axis=-1)
    return np.asarray((packed[:, :, :6] != 0).any(axis=(1, 2)) | pulls.any(axis=(1, 2)))


def _packed(scene: Scene, terms: list[Terms | None]) -> Float:
    """Return all terms as one, packed, of a body on an axle what turns it about that; else not a number."""
    if None in terms:
        return np.full(HEAD, np.nan)
    whole = sum((each for each in terms if each is not None), Terms())
    if not hinged(scene):
        return whole.packed(1.0, 1.0)
    if whole.squares.any() or whole.dissipation:
        return np.full(HEAD, np.nan)
    axis = np.asarray(scene.constraint.axis)
    along = np.outer(axis, axis)
    about = replace(whole, torque=along @ whole.torque, torque_rate=along @ whole.torque_rate)
    return replace(about, matrices=along @ whole.matrices).packed(1.0, 1.0)
