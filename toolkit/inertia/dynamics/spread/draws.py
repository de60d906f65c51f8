"""The numbers of many draws as arrays: bodies about their reference points, along principal axes, and their starts."""

from __future__ import annotations

from collections.abc import Set
from typing import Any

import numpy as np

from inertia.arrays import Bool, Float
from inertia.documents import LARGEST, SMALLEST
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.model import Problem
from inertia.dynamics.models.rational import rounded
from inertia.dynamics.scene.document import Scene
from inertia.records import dataclass

_ASIDE = 4.0 * 2.0**-52
_SYMMETRIC = np.array([[1.0, 1.0, -1.0], [1.0, -1.0, 1.0], [-1.0, 1.0, 1.0]])
"""A disturbance of a tensor, relative to its trace over `_ASIDE`."""

_MARGIN = 1e-6  # of the largest moment, from what is no body
_NEAR = 5.0  # lengths of a body, within which it is held


def field_of(path: str) -> str:
    """Return the field that a path is in, without indices; "load" for all of a load."""
    return "load" if path.startswith("load[") else path.partition("[")[0]


def hinged(scene: Scene) -> bool:
    """Whether the body turns about an axle."""
    return scene.constraint.kind == "hinge"


@dataclass(frozen=True, eq=False)
class Draws:
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
    def of(cls, scene: Scene, paths: tuple[str, ...], values: Float, *, aside: bool = False) -> Draws:
        """Take the numbers of each draw, as `fields.changed` does; `aside`, by what rounding may leave on the way."""
        count, body, held = len(values), scene.body, scene.constraint.holds
        columns: dict[str, list[tuple[tuple[int, ...], Float]]] = {}
        for path, column in zip(paths, values.T, strict=True):
            if field_of(path) != "load":
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
        scale = columns["body.scale"][0][1] if "body.scale" in columns else np.ones(count)
        if "body.scale" in columns and "body.mass" not in columns:
            mass = mass * scale**3
        share = mass / body.mass if body.properties is not None and body.mass else np.ones(count)
        share = share * scale**2
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
        for k in range(3):
            if ((k,),) not in {(at,) for at, _ in columns.get("body.center_of_mass", ())}:
                center[:, k] *= scale
        arm = center - filled(scene.constraint.fixed_point, "constraint.point") if held else np.zeros((count, 3))
        finite = np.asarray(np.isfinite(values).all(axis=1)) & (scale > 0)
        sound = finite & _is_body(np.where(finite[:, None, None], inertia, np.eye(3)), mass, arm, body.mass is not None)
        attitude = filled(scene.start.attitude, "start.attitude")
        length = np.linalg.norm(attitude, axis=1, keepdims=True)
        sound &= (length[:, 0] > _MARGIN) & np.isfinite(length[:, 0])
        attitude = attitude / np.where(sound[:, None], length, 1.0)
        spin = filled(scene.start.angular_velocity, "start.angular_velocity")
        pace = np.abs(spin).max(axis=1)
        sound &= ((pace > SMALLEST) | (pace == 0)) & (pace < LARGEST)
        elsewhere = spin
        if scene.start.frame == "space":
            spin = quaternion.to_body(attitude, spin)
        elif scene.start.frame == "principal":
            spin = spin @ body.axes.T
        if aside:
            spin = spin + _ASIDE * np.linalg.norm(spin, axis=1, keepdims=True) * (1.0, -1.0, 1.0)
        if hinged(scene):
            return cls._on_axle(scene, columns.keys(), mass, inertia, arm, attitude, spin, sound, aside)
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
                not {"body.mass", "body.density", "body.scale"} & columns.keys()
                and not rounded(problem.exact.frame.values)[1].any()
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

    @classmethod
    def _on_axle(
        cls,
        scene: Scene,
        fields: Set[str],
        mass: Float,
        inertia: Float,
        arm: Float,
        attitude: Float,
        spin: Float,
        sound: Bool,
        aside: bool,
    ) -> Draws:
        """Take bodies that turn about an axle for balls with their moments about it, which turn alike."""
        axis = np.asarray(scene.constraint.axis)
        across = np.cross(axis, arm)
        moment = np.einsum("i,mij,j->m", axis, inertia, axis) + mass * (across**2).sum(axis=1)
        moment[~sound] = 1.0
        along = spin @ axis
        sound = sound & (np.linalg.norm(spin - along[:, None] * axis, axis=1) <= 0.5 * _MARGIN * np.abs(along))
        return cls(
            moments=np.repeat(moment[:, None] * (1.0 + _ASIDE if aside else 1.0), 3, axis=1),
            axes=np.tile(np.eye(3), (len(mass), 1, 1)),
            turned=any(not name.startswith("start.") for name in fields),
            exact=False,
            spin=along[:, None] * axis,
            arm=arm,
            attitude=attitude,
            mass=mass,
            sound=sound,
        )

    def some(self, rows: Any) -> Draws:
        """Return some of the draws."""
        arrays = {name: value[rows] for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        return Draws(**arrays, turned=self.turned, exact=self.exact)


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
