"""Bearing forces and axle torque of an unbalance while the rotor turns, as long as the rotor is rigid.

Frames and signs are those of `inertia.balancing.unbalance`; every vector here turns with the rotor.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from inertia.balancing.unbalance import Complex, Unbalance
from inertia.errors import UsageError
from inertia.records import dataclass

_NOTE, _WARN, _REFUSE = 0.3, 0.5, 0.7


def bearing_forces(
    unbalance: Unbalance, z_a: float, z_b: float, speed: ArrayLike, acceleration: ArrayLike = 0.0
) -> Complex:
    """Return the forces of the rotor on bearings A and B, N: F_k = (ω² − iα) U_k, U_k resolved at bearing k.

    The bearings answer with −F_k. A rotor may overhang: its centre of mass need not lie between the bearings.

    Parameters
    ----------
    unbalance : of the rotor
    z_a, z_b : m, the bearings
    speed : (...) rad/s
    acceleration : (...) rad/s² about +z′; of a rotor that turns "cw" and runs up it is negative

    Returns (..., 2). Raises `UsageError` where a speed is not finite or the bearings coincide.

    >>> rotor = Unbalance(mass=10.0, z=0.2, static=1e-3, couple=0.0)
    >>> abs(bearing_forces(rotor, 0.0, 0.4, [100.0, 200.0])).round(12).tolist()
    [[5.0, 5.0], [20.0, 20.0]]
    """
    factor = _factor(speed, acceleration)
    forces: Complex = factor[..., np.newaxis] * unbalance.in_many_planes([z_a, z_b])
    return forces


def axle_torque(couple: complex, speed: ArrayLike, acceleration: ArrayLike = 0.0) -> Complex:
    """Return the torque across the shaft, N m, about the centre of mass, that the axle must give the rotor.

    N_x + i N_y = −i (ω² − iα) D: the part of N = I dω/dt + ω × I ω across the shaft. It turns with the rotor. For a
    wheel with moments I_p and I_t whose axis of symmetry is tilted by φ on its axle, it has the magnitude
    ω² |I_p − I_t| sin φ cos φ at constant speed (textbook § 13.25).

    Parameters
    ----------
    couple : D, kg m², about the plane of the centre of mass
    speed : (...) rad/s
    acceleration : (...) rad/s² about +z′

    >>> complex(axle_torque(2.0, 3.0))
    -18j
    """
    torque: Complex = -1j * _factor(speed, acceleration) * couple
    return torque


def carried_masses(mass: float, z: float, z_a: float, z_b: float) -> tuple[float, float]:
    """Return what bearings A and B carry of the rotor's mass, kg; negative where an overhung rotor lifts one.

    Parameters
    ----------
    mass, z : kg and m, of the rotor and its centre of mass
    z_a, z_b : m, the bearings
    """
    if z_a == z_b:
        raise UsageError(f"both bearings lie at z = {z_a:.6g} m: a shaft needs two separate bearings")
    at_b = mass * (z - z_a) / (z_b - z_a)
    return mass - at_b, at_b


def amplification(ratio: float) -> float:
    """Return the bearing force over that of a rigid rotor: 1/|1 − r²|, r = n/n_cr.

    The force m e ω²/|1 − r²| is that of an undamped rotor, its whole mass between rigid bearings on a massless shaft. A
    mass of the shaft and damping lower it: by 2 % at r = 0.7, by 6 % at 0.9 for a finite-element rotor (1.93 and 4.94).

    >>> [round(amplification(r), 2) for r in (0.1, 0.2, 0.3, 0.5, 0.7, 0.9)]
    [1.01, 1.04, 1.1, 1.33, 1.96, 5.26]
    """
    if not 0 <= ratio < math.inf:
        raise UsageError(f"the speed is {ratio!r} of the critical one: give a finite speed that is not negative")
    return 1.0 / abs(1.0 - ratio * ratio) if ratio != 1 else math.inf


@dataclass(frozen=True)
class RigidLimit:
    """How far a rotor may be taken as rigid.

    Attributes
    ----------
    ratio : speed over critical speed
    amplification : bearing force over that of the rigid rotor, of a disc in the middle of a massless shaft; of any
        other rotor it takes the modes, which a mesh does not have
    level : "rigid", "note" from a ratio of 0.3, "warn" from 0.5, "flexible" from 0.7: no rigid verdict any more
    text : the same in a sentence
    """

    ratio: float
    amplification: float
    level: Literal["rigid", "note", "warn", "flexible"]
    text: str


def rigid_limit(speed: float, critical: float) -> RigidLimit:
    """Judge whether the rotor is rigid enough for all that this room says.

    The critical speed comes from the user: a mesh cannot give it, as the supports take part in it.

    Parameters
    ----------
    speed, critical : in one unit

    >>> rigid_limit(3000.0, 9000.0).level
    'note'
    """
    if not 0 < critical < math.inf:
        raise UsageError(f"the critical speed is {critical!r}: it must be positive and finite")
    ratio = abs(speed) / critical
    grows = amplification(ratio)
    level: Literal["rigid", "note", "warn", "flexible"] = "rigid"
    says = "the rotor counts as rigid"
    if ratio >= _REFUSE:
        level = "flexible"
        says = (
            f"from {_REFUSE:g} on it bends too much to pass as a rigid rotor: balance it as a flexible one, mode by "
            "mode (ISO 21940-12)"
        )
    elif ratio >= _WARN:
        level, says = "warn", "bearing forces are far from those of a rigid rotor: balance at service speed"
    elif ratio >= _NOTE:
        level, says = "note", "bearing forces begin to exceed those of a rigid rotor"
    text = f"the speed is {ratio:.3g} of the critical one: {says}"
    if level != "rigid":
        text += (
            f". By how much bearing forces grow is not known without the modes: times {grows:.3g} for a disc in the "
            "middle of a massless shaft; of this rotor, mode shapes and modal masses would tell, or a run at that speed"
        )
    return RigidLimit(ratio, grows, level, text)


def _factor(speed: ArrayLike, acceleration: ArrayLike) -> Complex:
    omega, alpha = (np.asarray(k, dtype=np.float64) for k in (speed, acceleration))
    if not (np.isfinite(omega).all() and np.isfinite(alpha).all()):
        raise UsageError("a speed or an acceleration is not finite: give finite ones")
    factor: Complex = np.asarray(omega**2 - 1j * alpha)
    return factor
