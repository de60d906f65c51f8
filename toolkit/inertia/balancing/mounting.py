"""How far the bodies of a rotor may sit off the shaft, and lean, once they are assembled, as terms of the Monte Carlo.

A body of mass m that sits off by ε (complex, across the shaft) brings U = m ε at its centre of mass. One that leans by
γ about its centre of mass brings the couple D = (I_t − I_p) γ, with its transverse and polar moments, and as much as
half the difference of the two transverse ones on top; about a place at a distance h below it, U = m h γ as well.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.monte_carlo import Distribution, Term
from inertia.balancing.monte_carlo_terms import Spread
from inertia.balancing.rotor import Rotor
from inertia.balancing.rotor_bodies import RotorBody
from inertia.balancing.unbalance import Complex, plane_weights
from inertia.mass.properties import MassProperties

_STEPS = {"eccentricity": (1e-5, "0.01 mm"), "tilt": (math.radians(0.1), "0.1°")}
_UNEVEN = 1e-6  # of the polar moment: below, the transverse moments are equal


class Joint(NamedTuple):
    """Where something is mounted.

    Attributes
    ----------
    name : of what is mounted
    properties : of all that it carries, in part axes
    spreads : how far it may be off: its "eccentricity", m, and "tilt", rad; both are radii
    z : m along the shaft, about which it leans; its centre of mass without it
    """

    name: str
    properties: MassProperties
    spreads: dict[str, Spread]
    z: float | None = None


def mounting_terms(rotor: Rotor, bodies: Sequence[RotorBody], shaft: Shaft, zs: Sequence[float]) -> tuple[Term, ...]:
    """Return the terms of how the bodies of a rotor file are mounted: see `joint_terms`."""
    mounted = zip(rotor.fields.body, bodies, strict=True)
    return joint_terms(
        [Joint(body.name, body.analysis.properties, rotor.mounting(fields)) for fields, body in mounted], shaft, zs
    )


def joint_terms(joints: Sequence[Joint], shaft: Shaft, zs: Sequence[float]) -> tuple[Term, ...]:
    """Return the terms of how parts are mounted: each by itself, and what all of them have in common.

    Parameters
    ----------
    joints : with their tolerances
    shaft : in part axes
    zs : (k,) m, the tolerance planes
    """
    terms: list[Term] = []
    together: dict[tuple[str, Distribution], list[tuple[float, Complex]]] = {}
    for joint in joints:
        if not any(spread.total for spread in joint.spreads.values()):
            continue
        effects, uneven = _effects(joint, shaft, zs)
        for name, vectors in effects.items():
            spread = joint.spreads[name]
            if spread.separate:
                kind = _distribution(spread)
                terms.append(Term(f"{joint.name}: {name}", kind, spread.separate, vectors, *_STEPS[name]))
            if spread.common:
                together.setdefault((name, _distribution(spread)), []).append((spread.common, vectors))
        lean = joint.spreads["tilt"]
        if uneven is not None and lean.total:
            kind = _distribution(lean)
            terms.append(Term(f"{joint.name}: tilt, uneven", kind, lean.total, uneven, *_STEPS["tilt"]))
    for (name, kind), parts in together.items():
        widest = max(width for width, _ in parts)
        vectors = np.sum([width / widest * each for width, each in parts], axis=0)
        terms.append(Term(f"mounting: {name}", kind, widest, vectors, *_STEPS[name]))
    return tuple(terms)


def _distribution(spread: Spread) -> Distribution:
    return "rayleigh" if spread.rayleigh else "disc"


def _effects(joint: Joint, shaft: Shaft, zs: Sequence[float]) -> tuple[dict[str, Complex], Complex | None]:
    """Return what a metre of eccentricity and a radian of tilt do in the planes, and what uneven moments add."""
    own = shaft.resolve(joint.properties)
    height = float(own.center_of_mass[2])
    inertia = own.inertia
    stiff = 0.5 * float(inertia[0, 0] + inertia[1, 1]) - float(inertia[2, 2])
    uneven = math.hypot(0.5 * float(inertia[0, 0] - inertia[1, 1]), float(inertia[0, 1]))
    along, couple = plane_weights(shaft.z_a + height, zs)
    lever = 0.0 if joint.z is None else shaft.z_a + height - joint.z
    effects = {
        "eccentricity": (own.mass * along).astype(complex),
        "tilt": (own.mass * lever * along + stiff * couple).astype(complex),
    }
    if uneven <= _UNEVEN * abs(float(inertia[2, 2])):
        return effects, None
    return effects, (uneven * couple).astype(complex)
