"""Draws of a rigid body followed all at once: free ones in closed form, loaded ones by Taylor series.

What a draw needs is made for all of them as arrays. A draw that is near anything that a scene refuses is left to be
made as a scene, and one whose estimate does not reach the accuracy to be followed by itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float
from inertia.documents import LARGEST, SMALLEST
from inertia.dynamics.integrators.lanes import Bodies, fits, follow_bodies, solve_bodies, tolerances
from inertia.dynamics.integrators.terms import Terms
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.gravity import Gravity
from inertia.dynamics.loads.load import Load
from inertia.dynamics.models.free.flips import first_flip, flip_period
from inertia.dynamics.models.free.motion import MOST_EVENTS, free_ensemble, rounding
from inertia.dynamics.models.model import Problem
from inertia.dynamics.models.rational import rounded
from inertia.dynamics.run import Run
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.spread.fields import changed
from inertia.dynamics.spread.quantities import States
from inertia.errors import InertiaError

_FREE = ("spherical top", "steady axis", "symmetric top", "asymmetric top")
_KNOWN = ("deviation", "tilt", "spin", "energy", "attitude", "angular_velocity", "angular_momentum")
_ASIDE = 4.0 * 2.0**-52
_SYMMETRIC = np.array([[1.0, 1.0, -1.0], [1.0, -1.0, 1.0], [-1.0, 1.0, 1.0]])
"""A disturbance of a tensor, relative to its trace over `_ASIDE`."""

_MARGIN = 1e-6  # of the largest moment, from what is no body
_NEAR = 5.0  # lengths of a body, within which it is held
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
    body, kind = scene.body, scene.constraint.kind
    if any(name.partition("[")[0] not in _KNOWN for name in names) or scene.run.model is not None:
        return None
    if any(_field(path) not in _VARIED for path in paths) or body.assembly is not None:
        return None
    frames = [scene.start.frame, *(getattr(load, "frame", "") for load in scene.applied_loads)]
    if any(path.startswith("body.inertia") for path in paths) and "principal" in frames:
        return None  # the principal axes are those nearest to the scene's, for each draw by itself
    loaded = any(path.startswith("load") for path in paths)
    if nominal.model in _FREE and kind == "free" and not loaded and scene.run.method is None:
        return "free"
    long = float(np.linalg.norm(nominal.angular_velocity, axis=1).max()) * scene.run.duration > _LONGEST
    if nominal.model != "Euler equations" or nominal.error.method != "Taylor" or long:
        return None
    return "Taylor" if all(not load.breaks.size for load in scene.applied_loads) else None


_VARIED = frozenset(
    {f"body.{name}" for name in ("mass", "density", "center_of_mass", "inertia", "principal_moments")}
    | {"start.angular_velocity", "start.attitude", "constraint.point", "load"}
)


def _field(path: str) -> str:
    return "load" if path.startswith("load[") else path.partition("[")[0]


def follow_many(scene: Scene, paths: tuple[str, ...], values: Float, method: str, energy: bool) -> Motions:
    """Follow draws (m, k) of numbers at the instants of a scene; those that are not in the result are left to others.

    Parameters
    ----------
    scene : in which numbers are changed; paths : of the numbers
    method : of `method_for`
    energy : whether the energy is asked for; it is not a number without
    """
    draws = _Draws.of(scene, paths, values)
    time = np.linspace(0.0, scene.run.duration, scene.run.samples)
    follow = _free if method == "free" else _loaded
    rows, attitude, spin, reached, loads = follow(scene, paths, values, draws, time, True)
    some = draws.some(rows)
    states = _states(some, attitude, spin, loads, energy)
    if rows.size and not draws.exact:
        aside = _Draws.of(scene, paths, values, aside=True).some(rows)
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
    model = "asymmetric top" if method == "free" else "Euler equations"
    return Motions(rows[good], states.some(good), reached[good], model, {name: t[good] for name, t in events.items()})


_Followed = tuple[NDArray[np.intp], Float, Float, Float, list[tuple[Load, ...]]]
"""Draws (m,), attitudes (m, n, 4) and spins (m, n, 3) of the principal axes, errors (m,) in rad, and loads."""


def _free(
    scene: Scene, paths: tuple[str, ...], values: Float, draws: _Draws, time: Float, estimated: bool
) -> _Followed:
    """Follow bodies that nothing turns, by their closed forms."""
    rows = np.flatnonzero(draws.sound)
    some = draws.some(rows)
    relative, spin = free_ensemble(some.moments, some.spin, time)
    reached = rounding(some.moments, some.spin, time).max(axis=1)
    return rows, quaternion.multiply(some.attitude[:, None], relative), spin, reached, [()] * len(rows)


def _loaded(
    scene: Scene, paths: tuple[str, ...], values: Float, draws: _Draws, time: Float, estimated: bool
) -> _Followed:
    """Follow bodies under loads, by Taylor series; where the error need not be `estimated`, once only."""
    terms, every = _terms(scene, paths, values, draws)
    rows = np.flatnonzero(draws.sound & np.isfinite(terms).all(axis=1))
    if not fits(terms[rows]):
        rows = rows[:0]
    some = draws.some(rows)
    bodies = Bodies(some.moments, some.attitude, some.spin, terms[rows])
    acting = [every[k] for k in rows]
    if estimated:
        return rows, *solve_bodies(bodies, time, scene.run.accuracy), acting
    attitude, spin = np.full((len(rows), len(time), 4), np.nan), np.full((len(rows), len(time), 3), np.nan)
    for at, tolerance in tolerances(bodies, time, scene.run.accuracy):
        attitude[at], spin[at] = follow_bodies(bodies.some(at), time, tolerance)
    return rows, attitude, spin, np.zeros(len(rows)), acting


def _states(draws: _Draws, attitude: Float, spin: Float, loads: list[tuple[Load, ...]], energy: bool) -> States:
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


@dataclass(frozen=True, eq=False)
class _Draws:
    """Rigid bodies about their reference points, along their principal axes there.

    Attributes
    ----------
    moments : (m, 3); axes : (m, 3, 3) columns in part axes; turned : whether these were sought for each draw
    exact : whether moments and spins are what the scene says, with no rounding on the way to the principal axes
    spin : (m, 3) rad/s and arm : (m, 3) m, along them; attitude : (m, 4) of them; mass : (m,) kg
    sound : (m,) whether a body and its start are far from what a scene refuses
    """

    moments: Float
    axes: Float
    turned: bool
    exact: bool
    spin: Float
    arm: Float
    attitude: Float
    mass: Float
    sound: Bool

    @classmethod
    def of(cls, scene: Scene, paths: tuple[str, ...], values: Float, *, aside: bool = False) -> _Draws:
        """Take the numbers of each draw, as `fields.changed` does; `aside`, by what rounding may leave on the way."""
        count, body, held = len(values), scene.body, scene.constraint.holds
        columns: dict[str, list[tuple[tuple[int, ...], Float]]] = {}
        for path, column in zip(paths, values.T, strict=True):
            if _field(path) != "load":
                at = tuple(int(k) for k in path.replace("]", "").split("[")[1:])
                columns.setdefault(path.partition("[")[0], []).append((at, column))

        def filled(stated: Float | float, path: str) -> Float:
            array: Float = np.broadcast_to(np.asarray(stated, dtype=np.float64), (count, *np.shape(stated))).copy()
            for at, column in columns.get(path, ()):
                array.T[at[::-1]] = column
            return array

        mass = filled(body.mass or 0.0, "body.mass")
        if "body.density" in columns and body.properties is not None:
            mass = columns["body.density"][0][1] * body.properties.volume
        share = mass / body.mass if body.properties is not None and body.mass else np.ones(count)
        inertia = share[:, None, None] * body.inertia
        if "body.principal_moments" in columns:
            moments = filled(np.diagonal(body.axes.T @ body.inertia @ body.axes), "body.principal_moments")
            stated = {at for at, _ in columns["body.principal_moments"]}
            for k in range(3):
                if (k,) not in stated:
                    moments[:, k] *= share
            inertia = np.einsum("ik,mk,jk->mij", body.axes, moments, body.axes)
        for (i, j), column in columns.get("body.inertia", ()):
            inertia[:, i, j] = inertia[:, j, i] = column
        center = filled(body.center_of_mass, "body.center_of_mass")
        arm = center - filled(scene.constraint.fixed_point, "constraint.point") if held else np.zeros((count, 3))
        finite = np.asarray(np.isfinite(values).all(axis=1))
        sound = finite & _is_body(np.where(finite[:, None, None], inertia, np.eye(3)), mass, arm, body.mass is not None)
        attitude = filled(scene.start.attitude, "start.attitude")
        length = np.linalg.norm(attitude, axis=1, keepdims=True)
        sound &= (length[:, 0] > _MARGIN) & np.isfinite(length[:, 0])
        attitude = attitude / np.where(sound[:, None], length, 1.0)
        spin = filled(scene.start.angular_velocity, "start.angular_velocity")
        sound &= (np.abs(spin).max(axis=1) > SMALLEST) & (np.abs(spin).max(axis=1) < LARGEST)
        elsewhere = spin
        if scene.start.frame == "space":
            spin = quaternion.to_body(attitude, spin)
        elif scene.start.frame == "principal":
            spin = spin @ body.axes.T
        if aside:
            spin = spin + _ASIDE * np.linalg.norm(spin, axis=1, keepdims=True) * (1.0, -1.0, 1.0)
        shapes = {name for name in columns if not name.startswith("start.")} - (set() if arm.any() else {"body.mass"})
        turned = bool(shapes) and (bool(arm.any()) or "body.inertia" in columns)
        whole = not turned
        if turned:
            moments, axes = _principal(inertia, mass, arm, sound, _ASIDE if aside else 0.0)
        elif "body.principal_moments" in columns:
            axes = np.tile(body.axes, (count, 1, 1))
        else:
            problem = Problem.of(scene)
            moments, axes = share[:, None] * problem.moments, np.tile(problem.axes, (count, 1, 1))
            whole = (
                not {"body.mass", "body.density"} & columns.keys() and not rounded(problem.exact.frame.values)[1].any()
            )
            if aside:
                moments = moments * (1.0 + _ASIDE / 4.0 * np.array((1.0, -1.0, 1.0)))
        along = np.einsum("mij,mi->mj", axes, spin)
        straight = scene.start.frame == "principal" and not turned and bool((axes[0] == body.axes).all())
        if straight:
            along = elsewhere
        unturned = scene.start.frame != "space" and bool((axes[0] == np.eye(3)).all())
        exact = whole and (straight or unturned)
        return cls(
            moments=moments,
            axes=axes,
            turned=turned,
            exact=exact,
            spin=along,
            arm=np.einsum("mij,mi->mj", axes, arm),
            attitude=quaternion.multiply(attitude, quaternion.from_matrix(axes)),
            mass=mass,
            sound=sound,
        )

    def some(self, rows: Any) -> _Draws:
        """Return some of the draws."""
        arrays = {name: value[rows] for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        return _Draws(**arrays, turned=self.turned, exact=self.exact)


def _principal(inertia: Float, mass: Float, arm: Float, sound: Bool, aside: float) -> tuple[Float, Float]:
    """Return moments (m, 3) and axes (m, 3, 3) about points from which the centres of mass are `arm` (m, 3) away."""
    square = np.einsum("mi,mi->m", arm, arm)[:, None, None] * np.eye(3) - arm[:, :, None] * arm[:, None, :]
    about = inertia + mass[:, None, None] * square
    about = about + aside * np.trace(about, axis1=1, axis2=2)[:, None, None] * _SYMMETRIC
    about[~sound] = np.eye(3)
    moments, axes = np.linalg.eigh(about)
    axes[:, :, 2] *= np.sign(np.linalg.det(axes))[:, None]
    return moments, axes


def _is_body(inertia: Float, mass: Float, arm: Float, weighed: bool) -> Bool:
    """Say of which draws (m,) it is certain that they are bodies, and held near themselves."""
    moments = np.linalg.eigvalsh(inertia)
    largest = moments[:, 2]
    fine = np.asarray((largest > SMALLEST) & (largest < LARGEST) & (moments[:, 0] > _MARGIN * largest))
    fine &= moments[:, 0] + moments[:, 1] - largest > -_MARGIN * 1e-6 * largest
    if weighed:
        fine &= (mass > SMALLEST) & (mass < LARGEST)
        second = 0.5 * moments.sum(axis=1) - moments[:, 0]
        size = 2.0 * np.sqrt(5.0 * np.where(fine, second / np.where(fine, mass, 1.0), 1.0))
        fine &= np.linalg.norm(arm, axis=1) < _NEAR * size
    return fine


def _terms(scene: Scene, paths: tuple[str, ...], values: Float, draws: _Draws) -> tuple[Float, list[tuple[Load, ...]]]:
    """Return the packed terms (m, …) of each draw's loads, not numbers where a load is none, and the loads themselves.

    Both are along the axes of the draw.
    """
    varied = [k for k, path in enumerate(paths) if _field(path) == "load"]
    held = scene.constraint.holds
    acting = [k for k, load in enumerate(scene.applied_loads) if held or not isinstance(load, Gravity)]
    packed: list[Float] = []
    every: list[tuple[Load, ...]] = []
    for k, figures in enumerate(values[:, varied]):
        if k and not varied and not draws.turned:
            packed, every = packed * len(values), every * len(values)
            break
        try:
            loads = changed(scene, {paths[i]: float(x) for i, x in zip(varied, figures, strict=True)}).applied_loads
        except InertiaError:
            packed.append(np.full(1, np.nan))
            every.append(())
            continue
        body = SimpleNamespace(moments=draws.moments[k], mass=draws.mass[k], arm=draws.arm[k])
        along = tuple(loads[i].along(draws.axes[k], scene.body.axes) for i in acting)
        terms = [load.terms(body, 0.0) for load in along]
        whole = sum((each for each in terms if each is not None), Terms())
        packed.append(whole.packed(1.0, 1.0) if None not in terms else np.full(1, np.nan))
        every.append(along)
    size = max(map(len, packed))
    return np.array([row if len(row) == size else np.full(size, np.nan) for row in packed]), every
