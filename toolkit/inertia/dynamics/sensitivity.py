"""`sensitivity`: the derivative of the final attitude with respect to start, tensor, centre of mass and mass."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from functools import cached_property
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.computing_time import limited
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.deforming.jointed_body import JointedBody
from inertia.dynamics.models.deforming.joints import JointedPart
from inertia.dynamics.models.rolling.any_tensor import roll_any
from inertia.dynamics.models.sliding.model import slid
from inertia.dynamics.plan import plan
from inertia.dynamics.run import Run
from inertia.dynamics.scene.body import SceneBody
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.scene.sections import Settings, Start
from inertia.errors import GeometryError, UsageError, require_kind
from inertia.mass.tensor import faults
from inertia.records import dataclass

ELEMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""The six elements of the tensor, in the order of their columns: xx, yy, zz, xy, xz, yz."""

_ACCURACIES = (1e-12, 1e-10, 1e-8)  # rad, of the motions that are compared; the first that is reached
_FAR = 30.0  # times the angle that neighbours are meant to be apart
_TRIES = 6
_PATIENCE = 10.0  # s, for what is said beside a run
_NOTHING = np.zeros(3)
_THINNEST = 1e-12  # of the largest moment: next to one that is less, a change is lost in rounding


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """How the attitude at the end of a run turns with what the run starts from: ∂θ/∂p.

    θ is the small rotation vector, rad in space, by which the final attitude turns: exp(θ×) R(T). Matrices have ∂θᵢ/∂pⱼ
    in row i and column j.

    Attributes
    ----------
    time : s, the end of the run
    attitude : (3, 3), by the rotation vector of the start in space; ω along the part axes stays
    angular_velocity : (3, 3) s, by ω at t = 0, part axes; of a body on an axle, by its spin about that
    inertia : (3, 6) rad/(kg m²), by the elements xx, yy, zz, xy, xz, yz of the tensor about the centre of mass
    center_of_mass : (3, 3) rad/m, part axes
    mass : (3,) rad/kg, the tensor staying as it is
    parts : of a body that changes its shape, by the name of a part: the same with that part's tensor, centre of mass
        and mass; those above are then of the root
    """

    time: float
    attitude: Float
    angular_velocity: Float
    inertia: Float
    center_of_mass: Float
    mass: Float
    parts: Mapping[str, Sensitivity] = field(default_factory=dict)

    def _repr_html_(self) -> str:
        """Return a small table of how much each input turns the body, as a notebook shows it."""
        from inertia.notebook import html_of

        inputs = (
            ("Start turned", self.attitude, "rad per rad"),
            ("Angular velocity", self.angular_velocity, "rad per rad/s"),
            ("Inertia", self.inertia, "rad per kg m²"),
            ("Centre of mass", self.center_of_mass, "rad per m"),
            ("Mass", self.mass, "rad per kg"),
        )
        rows = [("Sensitivity", f"of the attitude after {self.time:g} s, at most")]
        rows += [(name, f"{np.linalg.norm(np.atleast_2d(each), 2):.6g} {unit}") for name, each, unit in inputs]
        return html_of([*rows, *(("With", f"part {name}") for name in self.parts)])

    def standard_uncertainty(self, covariance: Float) -> Float:
        """Return the standard uncertainty (3,) rad of the rotation vector θ, to first order.

        Parameters
        ----------
        covariance : (11, 11), of volume, mass, centre of mass and tensor, as `inertia.analyse` gives it under
            `uncertainty`
        """
        columns = np.column_stack([np.zeros(3), self.mass, self.center_of_mass, self.inertia])
        variance = np.einsum("ik,kl,il->i", columns, covariance, columns)
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


def sensitivity(run: Run | Scene) -> Sensitivity:
    """Return the derivative of the attitude at the end of a run with respect to what the run starts from.

    Central differences, θ(p + h) − θ(p − h) over 2 h, of the model's own solutions from inputs next to the scene's:
    those that are no longer symmetric, or no longer spin along a principal axis, by the next more general model. With h
    such that neighbours are some 1e-4 rad apart, seven digits are left of a closed form and of a stepped motion.

    A body that rolls is followed with any tensor and any centre of mass, its rim staying where it is in the part.

    Raises `GeometryError` where no model follows the motion to 1e-8 rad or neighbours part too far for a derivative.

    >>> scene = Scene.from_dict({"body": {"principal_moments": [2, 2, 2]},
    ...                          "start": {"angular_velocity": [0, 0, 3]}, "run": {"duration": 10}})
    >>> sensitivity(scene).angular_velocity[:, 2].round(6).tolist()      # a sphere turns by ω T
    [0.0, 0.0, 10.0]
    """
    scene = run.scene if isinstance(run, Run) else run
    require_kind(scene, Scene, "run", "inertia.simulate(scene), or a scene")
    with limited(scene.run.time_limit):
        if not scene.body.deforms:
            return _Neighbours(scene).derivatives()
        assert scene.body.assembly is not None
        each = {part.name: _Neighbours(scene, k) for k, part in enumerate(scene.body.assembly.parts)}
        parts: dict[str, Sensitivity] = {}
        for name, neighbours in each.items():
            parts[name] = neighbours.derivatives(next(iter(parts.values()), None))
        root = next(part.name for part in scene.body.assembly.parts if part.parent is None)
        return replace(parts[root], parts=parts)


def attitude_uncertainty(run: Run) -> float | None:
    """Return how far what is stated as uncertain of a part moves the attitude at the end, one standard deviation, rad.

    The root of the sum of squares of `Sensitivity.standard_uncertainty`, of parts on joints over all of them; None
    where nothing is stated, or no derivative can be had within ten seconds.
    """
    scene, assembly = run.scene, run.scene.body.assembly
    covariances: dict[int | None, Float | None] = {None: scene.body.covariance}
    if assembly is not None:
        covariances = {k: part.covariance for k, part in enumerate(assembly.parts)}
    slopes: Sensitivity | None = None
    moved: list[Float] = []
    try:
        with limited(min(scene.run.time_limit, _PATIENCE)):
            for part, covariance in covariances.items():
                if covariance is not None:
                    slopes = _Neighbours(scene, part).derivatives(slopes)
                    moved.append(slopes.standard_uncertainty(covariance))
    except (GeometryError, UsageError):
        return None
    return float(np.linalg.norm(moved)) if moved else None


class _Neighbours:
    """The motions next to that of a scene, at its end."""

    def __init__(self, scene: Scene, part: int | None = None) -> None:
        self.scene, self.part = scene, part
        body = scene.body
        own: SceneBody | JointedPart = body
        if part is not None:
            assert body.assembly is not None
            own = body.assembly.parts[part]
        self.tensor = 0.5 * (own.inertia + own.inertia.T)
        self.center, self.mass = np.asarray(own.center_of_mass), own.mass
        self.spin, self.attitude = scene.angular_velocity, scene.start.attitude
        least = float(body.principal.moments[0])  # of the whole, for a part may have none
        if not least > _THINNEST * float(body.principal.moments[2]):
            raise GeometryError("a body without thickness has no bodies next to it for a derivative: give it one")
        self.turned = 1.0 + float(np.linalg.norm(self.spin)) * scene.run.duration
        for accuracy in _ACCURACIES:
            self.accuracy = accuracy
            try:
                self.end = self.follow(self.tensor, self.center, self.mass, self.spin, self.attitude)
                break
            except GeometryError:
                if accuracy == _ACCURACIES[-1]:
                    raise
        self.apart = accuracy ** (1.0 / 3.0)
        size = float(np.sqrt(body.principal.moments[2] / self.mass)) if self.mass else 1.0
        self.scales = {"inertia": least, "center": size, "mass": self.mass or 1.0}

    def follow(self, tensor: Float, center: Float, mass: float | None, spin: Float, attitude: Float) -> Float:
        """Return the attitude (4,) at the end."""
        scene, start = self.scene, self.scene.start
        if scene.constraint.kind == "rolling":
            return self.rolled(tensor, center, mass, spin, attitude)
        if self.part is None:
            body = SceneBody(tensor, mass, center, axes=scene.body.axes)
        else:
            assert scene.body.assembly is not None
            parts = list(scene.body.assembly.parts)
            parts[self.part] = parts[self.part].altered(tensor, center, mass)
            body = SceneBody.of_assembly(JointedBody(tuple(parts)))
        there = replace(
            scene,
            body=body,
            start=Start(spin, "part", attitude, start.position, start.velocity),
            run=Settings(scene.run.duration, 2, self.accuracy, time_limit=scene.run.time_limit),
            text=None,
        )
        chosen = plan(there)
        if scene.constraint.kind == "sliding":
            end = slid(chosen.candidate, scene.run.duration)
        else:
            end = chosen.candidate.model.solve(chosen.candidate, np.array([0.0, scene.run.duration]), None).attitude[-1]
        turn = quaternion.conjugate(quaternion.from_matrix(chosen.candidate.axes))
        return quaternion.multiply(end, turn)

    def rolled(self, tensor: Float, center: Float, mass: float | None, spin: Float, attitude: Float) -> Float:
        """Return the attitude (4,) at the end of a body that rolls, whatever its tensor and its centre of mass."""
        scene = self.scene
        rim, body = self.rim, scene.body
        middle = np.asarray(body.center_of_mass) + (scene.constraint.offset or 0.0) * rim
        assert mass is not None and scene.constraint.radius is not None  # noqa: PT018  # the scene saw to it
        gravity = float(np.linalg.norm(scene.gravity))
        return roll_any(
            tensor, mass, middle - center, rim, scene.constraint.radius, gravity, attitude, spin, scene.run.duration
        )

    @cached_property
    def rim(self) -> Float:
        """The direction (3,) of the axis of the rim, part axes; the body itself rolls as it should, or this raises."""
        scene = self.scene
        settings = Settings(scene.run.duration, 2, _ACCURACIES[-1], time_limit=scene.run.time_limit)
        chosen = plan(replace(scene, run=settings, text=None))
        chosen.candidate.model.solve(chosen.candidate, np.array([0.0, scene.run.duration]), None)
        return chosen.candidate.axes[:, 2]

    def derivatives(self, start: Sensitivity | None = None) -> Sensitivity:
        """Return ∂θ/∂p for all of them; those by the start may be known."""
        pace = max(float(np.linalg.norm(self.spin)), 1.0 / self.scene.run.duration)
        felt = (self.scene.constraint.kind != "free" or self.part is not None) and self.mass is not None
        axle = self.scene.constraint.axis if self.scene.constraint.kind == "hinge" else None
        along = [e if axle is None else axle * axle[k] for k, e in enumerate(np.eye(3))]
        elements = []
        for i, j in ELEMENTS:
            element = np.zeros((3, 3))
            element[i, j] = element[j, i] = 1.0
            elements.append(element)
        return Sensitivity(
            time=self.scene.run.duration,
            attitude=self.columns(lambda h, e: {"attitude": h * e}, list(np.eye(3)), 1.0)
            if start is None
            else start.attitude,
            angular_velocity=self.columns(lambda h, e: {"spin": h * e}, along, pace)
            if start is None
            else start.angular_velocity,
            inertia=self.columns(lambda h, e: {"tensor": h * e}, elements, self.scales["inertia"]),
            center_of_mass=self.columns(lambda h, e: {"center": h * e}, list(np.eye(3)), self.scales["center"])
            if felt
            else np.zeros((3, 3)),
            mass=self.columns(lambda h, _: {"mass": h}, [_NOTHING], self.scales["mass"])[:, 0]
            if felt
            else _NOTHING.copy(),
        )

    def columns(self, change: Callable[[float, Float], dict[str, Any]], directions: list[Float], scale: float) -> Float:
        """Return ∂θ/∂p (3, k) for changes in k directions."""
        return np.column_stack([self.slope(change, direction, scale) for direction in directions])

    def slope(self, change: Callable[[float, Float], dict[str, Any]], direction: Float, scale: float) -> Float:
        """Return ∂θ/∂h (3,), with h such that neighbours are neither too near nor too far."""
        step = self.apart * scale / self.turned
        for _ in range(_TRIES):
            changes = [change(sign * step, direction) for sign in (1.0, -1.0)]
            lacking = [self.part is None and bool(faults(self.tensor + each.get("tensor", 0.0))) for each in changes]
            if any(lacking):  # the body is flat, and no body is flatter: both neighbours on the other side
                side = -step if lacking[0] else step
                one, two = (self.moved(**change(k * side, direction)) for k in (1.0, 2.0))
                apart, slope = two, (4.0 * one - two) / (2.0 * side)
            else:
                one, two = (self.moved(**each) for each in changes)
                apart, slope = one - two, (one - two) / (2.0 * step)
            angle = float(np.linalg.norm(apart))
            if angle <= _FAR * self.apart:
                return np.asarray(slope)
            step *= max(self.apart / angle, 1e-4)
        raise GeometryError(
            f"neighbouring motions part too far within {self.scene.run.duration:g} s for a derivative: "
            "follow it for a shorter time"
        )

    def moved(
        self,
        attitude: Float = _NOTHING,
        spin: Float = _NOTHING,
        tensor: Float = _NOTHING,
        center: Float = _NOTHING,
        mass: float = 0.0,
    ) -> Float:
        """Return the rotation vector (3,) by which the final attitude turns for these changes."""
        start = quaternion.normalise(quaternion.multiply(quaternion.from_rotation_vector(attitude), self.attitude))
        weight = None if self.mass is None else self.mass + mass
        there = self.follow(self.tensor + tensor, self.center + center, weight, self.spin + spin, start)
        turn = quaternion.multiply(there, quaternion.conjugate(self.end))
        turn = turn if turn[3] >= 0 else -turn
        half = float(np.linalg.norm(turn[:3]))
        return turn[:3] * (2.0 * np.arctan2(half, turn[3]) / half) if half else np.zeros(3)
