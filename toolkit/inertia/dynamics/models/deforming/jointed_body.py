"""`JointedBody`: a tree of parts on joints, where each part is, and how the whole moves within itself.

The pose of a part takes its assembly coordinates (see `inertia.dynamics.models.deforming.joints`) to root coordinates,
x ↦ R x + p; that of the root takes them to themselves.
"""

from __future__ import annotations

from difflib import get_close_matches
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.documents import FieldError
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.deforming.joints import Joint, JointedPart
from inertia.records import dataclass

_ROUNDED = 16 * 2.0**-52
"""Relative: what poses and sums over the parts are rounded by."""


@dataclass(frozen=True, eq=False)
class Shape:
    """An assembly at n instants, resolved along the root axes; rates are those that an observer on the root sees.

    Attributes
    ----------
    mass : kg
    inertia : (n, 3, 3) kg m² of all parts about their common centre of mass
    internal_angular_momentum : (n, 3) kg m²/s about that centre
    internal_energy : (n,) J, of the motion relative to root axes that go with that centre
    center_of_mass : (n, 3) m
    joint_values, joint_rates : (n, j) rad or m, and their rates, in the order of the parts and of their joints
    part_attitude : (n, parts, 4) scalar-last quaternions, assembly to root
    part_position : (n, parts, 3) m, of the assembly origin as the part carries it
    """

    mass: float
    inertia: Float
    internal_angular_momentum: Float
    internal_energy: Float
    center_of_mass: Float
    joint_values: Float
    joint_rates: Float
    part_attitude: Float
    part_position: Float


@dataclass(frozen=True, eq=False)
class _Moving:
    """A pose and the motion of what has it: v(x) = velocity + spin × x, root axes."""

    attitude: Float
    position: Float
    spin: Float
    velocity: Float

    def moved(self, joint: Joint, value: Float, rate: Float) -> _Moving:
        """Hang a joint on this."""
        axis = quaternion.to_space(self.attitude, joint.axis)
        if not joint.revolute:
            position, velocity = self.position + axis * value[:, None], self.velocity + axis * rate[:, None]
            return _Moving(self.attitude, position, self.spin, velocity)
        through = quaternion.to_space(self.attitude, joint.point) + self.position
        turn = axis * rate[:, None]
        attitude = quaternion.multiply(self.attitude, quaternion.from_rotation_vector(value[:, None] * joint.axis))
        position = through - quaternion.to_space(attitude, joint.point)
        return _Moving(attitude, position, self.spin + turn, self.velocity + np.cross(through, turn))


@dataclass(frozen=True, eq=False)
class JointedBody:
    """Parts that hang on one another: a tree with one root.

    Raises `FieldError` where names repeat, a parent is unknown, or the parts make no tree.

    >>> bar = JointedPart("bar", 1.0, np.diag([1.0, 1.0, 0.1]))
    >>> wheel = JointedPart("wheel", 1.0, np.diag([0.1, 0.1, 0.2]), parent="bar",
    ...                     joints=[Joint(axis=[0, 0, 1], times=[0], angles=[0], rates=[5])])
    >>> JointedBody([bar, wheel]).shape([0.0]).internal_angular_momentum.tolist()
    [[0.0, 0.0, 1.0]]
    """

    parts: tuple[JointedPart, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", tuple(self.parts))
        names = [part.name for part in self.parts]
        for k, part in enumerate(self.parts):
            if part.name in names[:k]:
                raise FieldError(f"part[{k}].name", f'is "{part.name}" like part[{names.index(part.name)}]')
            if part.parent is not None and part.parent not in names:
                close = get_close_matches(part.parent, names, n=1, cutoff=0.5)
                hint = f'did you mean "{close[0]}"?' if close else f"use one of {', '.join(names)}"
                raise FieldError(f"part[{k}].parent", f'is "{part.parent}", which is no part: {hint}')
        roots = [part.name for part in self.parts if part.parent is None]
        if len(roots) > 1:
            raise FieldError("part", f"has {len(roots)} roots, {', '.join(roots)}: give all but one a parent")
        if len(self.order) < len(self.parts):
            astray = ", ".join(name for k, name in enumerate(names) if k not in self.order)
            raise FieldError("part", f"has no way from a root to {astray}: one part, and one only, has no parent")
        if not self.parts:
            raise FieldError("part", "is empty: give one part or more")

    @cached_property
    def order(self) -> list[int]:
        """Indices of the parts, each after its parent, as far as they can be reached from a root."""
        order = [k for k, part in enumerate(self.parts) if part.parent is None]
        for at in order:
            order.extend(k for k, part in enumerate(self.parts) if part.parent == self.parts[at].name)
        return order

    @property
    def joints(self) -> tuple[Joint, ...]:
        """All joints, in the order of the parts and outwards in each."""
        return tuple(joint for part in self.parts for joint in part.joints)

    @property
    def keyframes(self) -> Float:
        """The instants (k,) s, ascending, of all keyframes of joints that move."""
        return np.unique(np.concatenate([np.empty(0), *(joint.times for joint in self.joints if joint.moves)]))

    @property
    def bounds(self) -> tuple[float, float, float]:
        """How far mass (kg), centre of mass (m) and the tensor about it (kg m²) at t = 0 may be off, rounding included.

        A part of mass m at r from the common centre, whose mass and place are off by μ and δ, moves that by
        (μ r + m δ)/M at most, and the tensor there by its own bound, μ r² and 2 m r δ + m δ².
        """
        shape = self.shape(np.zeros(1))
        turned = quaternion.to_space(shape.part_attitude[0], np.stack([part.center_of_mass for part in self.parts]))
        places = turned + shape.part_position[0]
        away = np.linalg.norm(places - shape.center_of_mass[0], axis=1)
        masses = np.array([part.mass for part in self.parts])
        sizes = np.array([np.linalg.norm(part.inertia) for part in self.parts]) + masses * away**2
        by_mass, by_place, own = np.array([part.bounds for part in self.parts]).T
        by_place = by_place + _ROUNDED * np.linalg.norm(places, axis=1)
        return (
            float(by_mass.sum() + _ROUNDED * shape.mass),
            float((by_mass @ away + masses @ by_place) / shape.mass),
            float((own + by_mass * away**2 + masses * by_place * (2.0 * away + by_place) + _ROUNDED * sizes).sum()),
        )

    def shape(self, time: ArrayLike, later: ArrayLike = 0.0) -> Shape:
        """Return where everything is at times (n,) s, or `later` (n,) s than them (`Joint.at`).

        With r, u the place and the velocity of a part's centre of mass relative to the common one, ω its spin and I
        its tensor: inertia Σ I + m (r² δ − r rᵀ), angular momentum Σ I ω + m r × u, energy ½ Σ ω·I ω + m u².
        """
        t = np.asarray(time, dtype=np.float64)
        count = len(t)
        at_rest = np.tile(quaternion.IDENTITY, (count, 1)), *(np.zeros((count, 3)) for _ in range(3))
        moved: dict[str | None, _Moving] = {None: _Moving(*at_rest)}
        motion = {joint: joint.at(t, later) for joint in self.joints}
        for k in self.order:
            part = self.parts[k]
            pose = moved[part.parent]
            for joint in part.joints:
                pose = pose.moved(joint, *motion[joint])
            moved[part.name] = pose
        poses = [moved[part.name] for part in self.parts]
        attitude, position, spin, velocity = (
            np.stack([getattr(pose, name) for pose in poses], axis=1)
            for name in ("attitude", "position", "spin", "velocity")
        )
        masses = np.array([part.mass for part in self.parts])
        rotation = quaternion.matrix(attitude)
        place = rotation @ np.stack([part.center_of_mass for part in self.parts])[..., None]
        place = place[..., 0] + position
        velocity = velocity + np.cross(spin, place)
        total = float(masses.sum())
        center = masses @ place / total
        r = place - center[:, None]
        u = velocity - (masses @ velocity / total)[:, None]
        tensor = rotation @ np.stack([part.inertia for part in self.parts]) @ np.swapaxes(rotation, -1, -2)
        orbital = np.einsum("k,nki,nkj->nij", masses, r, r)
        spherical = np.trace(orbital, axis1=-2, axis2=-1)[:, None, None] * np.eye(3)
        own = (tensor @ spin[..., None])[..., 0]
        values, rates = (np.array([motion[joint][i] for joint in self.joints]).T for i in (0, 1))
        return Shape(
            mass=total,
            inertia=tensor.sum(axis=1) + (spherical - orbital),
            internal_angular_momentum=own.sum(axis=1) + masses @ np.cross(r, u),
            internal_energy=0.5 * (np.sum(own * spin, axis=(1, 2)) + masses @ np.sum(u * u, axis=-1).T),
            center_of_mass=center,
            joint_values=values.reshape(count, -1),
            joint_rates=rates.reshape(count, -1),
            part_attitude=attitude,
            part_position=position,
        )
