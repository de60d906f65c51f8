"""Tilt of the principal axis nearest the shaft, and the couple of a disc that is tilted on purpose.

Frames and signs are those of `inertia.balancing.unbalance`. The principal axis is never taken for the shaft: it is
where the shaft would have to run for the couple to vanish.
"""

from __future__ import annotations

import math

import numpy as np

from inertia.balancing.axis.shaft import Shaft
from inertia.mass.properties import MassProperties
from inertia.records import dataclass


@dataclass(frozen=True)
class Tilt:
    """The principal axis through the centre of mass that is nearest the shaft.

    Attributes
    ----------
    angle : rad, from the shaft
    direction : rad from 0°, the side of the shaft that it leans to as z grows
    bound : rad, how far the axis may be from where it is found, by the arithmetic; π/2 where it is any axis
    sensitivity : 1/|I_t − I_p|, rad of tilt per kg m² of couple; infinite where the moments are equal
    """

    angle: float
    direction: float
    bound: float
    sensitivity: float

    @property
    def certain(self) -> bool:
        """Whether there is such an axis: no other moment equals its own."""
        return self.bound < 0.5 * math.pi


def principal_tilt(properties: MassProperties, shaft: Shaft) -> Tilt:
    """Return the tilt of the principal axis nearest the shaft.

    In the x–z plane it is ½ atan2(2 I_xz, I_zz − I_xx). It is ill-conditioned where the polar and transverse moments
    are nearly equal: a small couple then tilts it far.

    Parameters
    ----------
    properties : in part axes
    shaft : in part axes

    >>> disc = MassProperties(1.0, 0.0, [0, 0, 0], [[1.0, 0, -0.01], [0, 1.0, 0], [-0.01, 0, 1.9]])
    >>> tilt = principal_tilt(disc, Shaft([0, 0, -1], [0, 0, 1], [1, 0, 0]))
    >>> round(tilt.angle, 12) == round(0.5 * math.atan2(0.02, 0.9), 12), abs(round(tilt.direction, 6))
    (True, 3.141593)
    """
    principal = properties.principal
    axes = shaft.axes.T @ principal.axes
    nearest = int(np.argmax(np.abs(axes[2])))
    x, y, z = (axes[:, nearest] * np.sign(axes[2, nearest])).tolist()
    others = np.delete(principal.moments, nearest)
    gap = abs(float(principal.moments[nearest]) - float(others.mean()))
    return Tilt(
        math.atan2(math.hypot(x, y), z),
        math.atan2(y, x),
        float(principal.axis_bounds[nearest]),
        1.0 / gap if gap else math.inf,
    )


def swash_couple(polar: float, transverse: float, tilt: float, direction: float = 0.0) -> complex:
    """Return the couple D, kg m², of a body of revolution on a shaft that its axis is tilted from.

    |D| = (I_p − I_t) sin τ cos τ. A flat disc whose axis leans to `direction` has its couple on the other side.

    Parameters
    ----------
    polar, transverse : I_p and I_t about the centre of mass, kg m²
    tilt : τ, rad
    direction : rad from 0°, the side that the axis leans to as z grows

    >>> round(abs(swash_couple(2.0, 1.0, math.pi / 4)), 12)
    0.5
    """
    size = (transverse - polar) * math.sin(tilt) * math.cos(tilt)
    return complex(size * math.cos(direction), size * math.sin(direction))
