"""How far the bodies of a rotor may sit off the shaft, and lean, once they are assembled, as terms of the Monte Carlo.

A body of mass m that sits off by ε (complex, across the shaft) brings U = m ε at its centre of mass. One that leans by
γ about its centre of mass brings the couple D = (I_t − I_p) γ, with its transverse and polar moments, and as much as
half the difference of the two transverse ones on top.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.monte_carlo import Term
from inertia.balancing.rotor import Rotor
from inertia.balancing.rotor_bodies import RotorBody
from inertia.balancing.unbalance import Complex, plane_weights

_STEPS = {"eccentricity": (1e-5, "0.01 mm"), "tilt": (math.radians(0.1), "0.1°")}
_UNEVEN = 1e-6  # of the polar moment: below, the transverse moments are equal


def mounting_terms(rotor: Rotor, bodies: Sequence[RotorBody], shaft: Shaft, zs: Sequence[float]) -> tuple[Term, ...]:
    """Return the terms of how the bodies are mounted: each part by itself, and what all of them have in common.

    Parameters
    ----------
    rotor : with the tolerances of its bodies
    bodies : as read
    shaft : in part axes
    zs : (k,) m, the tolerance planes
    """
    terms: list[Term] = []
    together: dict[str, list[tuple[float, Complex]]] = {}
    for number, body in enumerate(bodies):
        spreads = rotor.mounting(number)
        if not any(spread.total for spread in spreads.values()):
            continue
        effects, uneven = _effects(body, shaft, zs)
        for name, vectors in effects.items():
            spread = spreads[name]
            if spread.separate:
                terms.append(Term(f"{body.name}: {name}", "disc", spread.separate, vectors, *_STEPS[name]))
            if spread.common:
                together.setdefault(name, []).append((spread.common, vectors))
        if uneven is not None and spreads["tilt"].total:
            total = spreads["tilt"].total
            terms.append(Term(f"{body.name}: tilt, uneven", "disc", total, uneven, *_STEPS["tilt"]))
    for name, parts in together.items():
        widest = max(width for width, _ in parts)
        vectors = np.sum([width / widest * each for width, each in parts], axis=0)
        terms.append(Term(f"mounting: {name}", "disc", widest, vectors, *_STEPS[name]))
    return tuple(terms)


def _effects(body: RotorBody, shaft: Shaft, zs: Sequence[float]) -> tuple[dict[str, Complex], Complex | None]:
    """Return what a metre of eccentricity and a radian of tilt do in the planes, and what uneven moments add."""
    own = shaft.resolve(body.analysis.properties)
    height = float(own.center_of_mass[2])
    inertia = own.inertia
    stiff = 0.5 * float(inertia[0, 0] + inertia[1, 1]) - float(inertia[2, 2])
    uneven = math.hypot(0.5 * float(inertia[0, 0] - inertia[1, 1]), float(inertia[0, 1]))
    along, couple = plane_weights(shaft.z_a + height, zs)
    effects = {"eccentricity": (own.mass * along).astype(complex), "tilt": (stiff * couple).astype(complex)}
    if uneven <= _UNEVEN * abs(float(inertia[2, 2])):
        return effects, None
    return effects, (uneven * couple).astype(complex)
