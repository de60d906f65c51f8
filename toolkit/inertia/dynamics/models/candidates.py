"""The models that could follow a scene, the smallest first, each with what it costs to take the scene for so simple.

A cost is an estimate in rad of the attitude error after the duration T. Moments that differ by a relative δ (of the
smallest) turn the body apart at about δ |ω|, whence δ |ω| T; a spin that is off a principal axis by a small angle
wobbles about it, or leaves it as exp(λ T) where the axis is the intermediate one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from inertia.arrays import Float
from inertia.documents import FieldError
from inertia.dynamics.kinematics.stability import growth_rate
from inertia.dynamics.setting import Setting

_NEAR = 1e-3
"""Relative difference up to which it is worth saying that moments are nearly equal."""

_PAIRS = ((1, 2), (2, 0), (0, 1))  # the moments across each axis
_ORDINAL = ("smallest", "intermediate", "largest")


@dataclass(frozen=True, eq=False)
class Candidate:
    """A model and what it would be.

    Attributes
    ----------
    model : its name
    axes : (3, 3), columns in part axes, as the model wants them; moments (3,) kg m² about them
    cost : rad
    unseen : rad, the part of the cost that the model's own estimate of its error leaves out
    why : the reason for it, a sentence
    near_miss : what nearly holds where the cost is too high, the beginning of a sentence; empty where nothing does
    """

    model: str
    axes: Float
    moments: Float
    cost: float
    why: str
    near_miss: str = ""
    unseen: float = 0.0


def free_candidates(setting: Setting) -> list[Candidate]:
    """Return spherical top, steady axis, symmetric and asymmetric top, for a body that nothing turns."""
    leave_out = _ignored_weight(setting)
    found = [
        _spherical(setting),
        _steady(setting),
        _symmetric(setting),
        Candidate(
            "asymmetric top",
            setting.axes,
            setting.moments,
            0.0,
            "The three principal moments differ: the closed form in Jacobi's elliptic functions gives every sample "
            "directly, attitude included, without steps.",
        ),
    ]
    if leave_out > math.pi:
        return []
    return [replace(each, cost=each.cost + leave_out, unseen=leave_out) for each in found]


def _ignored_weight(setting: Setting) -> float:
    """Return the angle that gravity could turn the body by: ½ M g h T²/I1."""
    pull = setting.weight * float(np.linalg.norm(setting.arm)) / float(setting.moments[0])
    return 0.5 * pull * setting.duration**2


def _turned(setting: Setting) -> float:
    """Return |ω| T in rad."""
    return float(np.linalg.norm(setting.angular_velocity)) * setting.duration


def _spherical(setting: Setting) -> Candidate:
    least, _, most = setting.moments.tolist()
    delta = (most - least) / least
    return Candidate(
        "spherical top",
        setting.axes,
        setting.moments,
        delta * _turned(setting),
        "The three principal moments are equal: the angular velocity is constant, about any axis.",
        f"The three moments differ by {delta:.2g} only" if 0 < delta < _NEAR else "",
    )


def _steady(setting: Setting) -> Candidate:
    """Return rotation about one principal axis, or about any axis across a symmetry axis."""
    moments, omega = setting.moments, setting.angular_velocity
    size = float(np.linalg.norm(omega))
    share = np.abs(omega) / size if size else np.array([0.0, 0.0, 1.0])
    ratio = float(moments[2] / moments[0])
    axis = int(np.argmax(share))
    off = float(np.linalg.norm(np.delete(share, axis)))
    if axis == 1:
        grown = min(float(growth_rate(moments, size)) * setting.duration, 700.0)
        wobble = off * ratio * math.exp(grown)
    else:
        wobble = off * ratio * (1.0 + off * _turned(setting))
    across = [
        (moments[j] - moments[i]) / moments[0] * _turned(setting) + share[3 - i - j] * ratio * (1.0 + _turned(setting))
        for i, j in ((0, 1), (1, 2))
    ]
    if wobble <= min(across):
        what = f"along principal axis {axis + 1}, that of the {_ORDINAL[axis]} moment"
        near = f"The spin is within {off:.2g} rad of principal axis {axis + 1}" if 0 < off < _NEAR else ""
        return Candidate("steady axis", setting.axes, moments, wobble, _steadily(what), near)
    what = "across the axis of symmetry, where every axis is a principal one"
    return Candidate("steady axis", setting.axes, moments, float(min(across)), _steadily(what))


def _steadily(what: str) -> str:
    return f"The spin is {what}: it stays there, and no equation is solved."


def _symmetric(setting: Setting) -> Candidate:
    i, j = min(((0, 1), (1, 2)), key=lambda pair: setting.moments[pair[1]] - setting.moments[pair[0]])
    order = [*_PAIRS[3 - i - j], 3 - i - j]
    delta = float((setting.moments[j] - setting.moments[i]) / setting.moments[0])
    return Candidate(
        "symmetric top",
        setting.axes[:, order],
        setting.moments[order],
        delta * _turned(setting),
        f"Principal moments {i + 1} and {j + 1} are equal: the motion is a steady precession, a closed form in sines.",
        f"Principal moments {i + 1} and {j + 1} differ by {delta:.2g} only" if 0 < delta < _NEAR else "",
    )


def heavy_candidates(setting: Setting) -> list[Candidate]:
    """Return the heavy symmetric top about the line from the fixed point to the centre of mass, if that is an arm."""
    height = float(np.linalg.norm(setting.arm))
    if setting.weight * height == 0:
        return []
    swing = math.sqrt(setting.weight * height / setting.moments[0])
    rate = max(float(np.linalg.norm(setting.angular_velocity)), swing)
    axes, moments, defect = _along(setting, setting.arm / height)
    cost = defect * rate * setting.duration
    return [
        Candidate(
            "heavy symmetric top",
            axes,
            moments,
            cost,
            "The body is symmetric about the line from the fixed point to its centre of mass: energy and two momenta "
            "are kept, and the closed form in elliptic functions gives every sample directly.",
            f"The moments about the line to the centre of mass are symmetric to within {defect:.2g}"
            if defect < _NEAR
            else "",
            cost,
        )
    ]


def rolling_candidates(setting: Setting) -> list[Candidate]:
    """Return the rolling body about the axis that the scene names, else about that of the two nearest moments."""
    axis = setting.symmetry
    if axis is None:
        unequal = [abs(float(setting.moments[i] - setting.moments[j])) for i, j in _PAIRS]
        if max(unequal) < _NEAR * setting.moments[0]:
            raise FieldError(
                "constraint.axis", "is missing: the moments are all equal, so say which axis the rim is on"
            )
        axis = np.eye(3)[int(np.argmin(unequal))]
    axes, moments, defect = _along(setting, axis)
    why = "A body of revolution on its rim: the nonholonomic equations are integrated, contact forces included."
    cost = defect * _turned(setting)
    return [Candidate("rolling body", axes, moments, cost, why, unseen=cost)]


def deforming_candidates(setting: Setting) -> list[Candidate]:
    """Return the one model of a free body whose joints move."""
    why = (
        "The shape changes in a prescribed way: the angular momentum stays fixed in space, the tensor and the momentum "
        "of the parts within follow from the joints, and the attitude alone is integrated."
    )
    return [Candidate("deforming body", setting.axes, setting.moments, 0.0, why)]


def _along(setting: Setting, direction: Float) -> tuple[Float, Float, float]:
    """Return right-handed axes with `direction` (3,) as the third, the moments about them, and how far from symmetric.

    The last is what the tensor there lacks of diag(I, I, I3), relative to the smallest moment.
    """
    columns = np.column_stack([*_across(direction), direction])
    tensor = columns.T @ (setting.moments[:, None] * columns)
    transverse = 0.5 * (tensor[0, 0] + tensor[1, 1])
    symmetric = np.array([transverse, transverse, tensor[2, 2]])
    defect = float(np.linalg.norm(tensor - np.diag(symmetric)) / setting.moments[0])
    return setting.axes @ columns, symmetric, defect


def _across(direction: Float) -> tuple[Float, Float]:
    """Return two unit vectors that make a right-handed set with `direction` (3,)."""
    helper = np.eye(3)[int(np.argmin(np.abs(direction)))]
    first = np.cross(helper, direction)
    first /= np.linalg.norm(first)
    return first, np.cross(direction, first)
