"""What a motion is known by: precession rates and cones, periods and flips, the kind of nutation."""

from __future__ import annotations

import math

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics.geometry import cones
from inertia.dynamics.kinematics.stability import separatrix_distance
from inertia.dynamics.models.free.flips import flip_period, polhode_period, tumbles
from inertia.dynamics.models.heavy.top import HeavyTop
from inertia.dynamics.motion import Motion
from inertia.errors import GeometryError

Characteristics = tuple[dict[str, Float], tuple[str, ...]]
"""Figures by name, each an array, SI units; and sentences."""

_NO_MOMENTUM = 1e-13
"""Relative to what the motion of the parts, or the whole, has at its largest."""

_NUTATION = {
    "sleeping": "the top sleeps: its axis stays vertical",
    "steady precession": "its axis keeps its tilt: a steady precession",
    "pendulum": "it has no angular momentum along the vertical or its axis: it swings as a pendulum",
    "cusp": "its axis stops at the top of every nod: the path has cusps",
    "loops": "its axis moves backwards at the top of every nod: the path has loops",
    "no reversal": "its axis moves on all the time: the path is a wave without cusps or loops",
}


def of_free_body(model: str, moments: Float, angular_velocity: Float) -> Characteristics:
    """Return what a model of free rotation is known by; moments (3,) kg m², the symmetry axis last where there is one.

    >>> figures, _ = of_free_body("symmetric top", np.array([1.0, 1, 2]), np.array([0.01, 0, 1]))
    >>> figures["precession of the body"].round(3).item(), figures["precession in the body"].round(3).item()
    (2.0, 1.0)
    """
    if model == "symmetric top":
        found = cones(moments, angular_velocity)
        figures = {
            "precession of the body": found.precession,
            "precession in the body": found.body_precession,
            "body cone": found.body_half_angle,
            "space cone": found.space_half_angle,
        }
        return figures, ()
    if model == "asymmetric top":
        distance = separatrix_distance(moments, angular_velocity)
        figures = {"separatrix distance": distance, "polhode period": polhode_period(moments, angular_velocity)}
        side = "smallest" if distance > 0 else "largest"
        if not tumbles(moments, angular_velocity):
            return figures, (f"The spin goes round the axis of the {side} moment.",)
        figures["flip period"] = flip_period(moments, angular_velocity)
        return figures, (
            f"The body tumbles: between flips it spins about the axis of the intermediate moment, and its spin goes "
            f"round the axis of the {side} one.",
        )
    return {}, ()


def of_heavy_top(top: HeavyTop) -> Characteristics:
    """Return the kind of nutation, the steady precessions at the least tilt, and whether the top could sleep.

    >>> top = HeavyTop.of_state((1.0, 0.5), 2.0, [0.3, 0, 0, 0.9], [0, 0, 8.0])
    >>> of_heavy_top(top)[1][0]
    'Seen from the fixed point, its axis stops at the top of every nod: the path has cusps.'
    """
    remarks = [f"Seen from the fixed point, {_NUTATION[top.kind]}."]
    figures = {}
    tilt = top.turning_angles[0]
    if 0 < tilt < math.pi:
        try:
            figures["steady precession, slow and fast"] = np.array(top.steady_precession(tilt))
        except GeometryError:
            remarks.append("It spins too slowly for a steady precession at its least tilt.")
    if top.mgh > 0:
        limit = top.least_p_psi(0.0) / top.I3
        sleeps = "would sleep stably" if top.sleeps_stably else "would not stay"
        remarks.append(f"Upright it {sleeps}: that takes a spin of {limit:.6g} rad/s about its axis.")
    return figures, tuple(remarks)


def of_deforming_body(motion: Motion) -> Characteristics:
    """Return the principal moments (n, 3) of a body that changes its shape, and what its joints do."""
    moments: Float = np.asarray(np.linalg.eigvalsh(motion.quantities["inertia"]), dtype=np.float64)
    momentum = float(np.linalg.norm(motion.invariants["angular momentum"][0]))
    remarks = []
    if momentum <= _NO_MOMENTUM * motion.scales["angular momentum"]:
        remarks.append("The angular momentum is zero: what turns the body is the motion of its parts alone.")
    work = motion.quantities["work of the joints"]
    rounding = _NO_MOMENTUM * float(motion.quantities["kinetic energy"].max())
    if np.abs(work).max() > rounding:
        least, most, last = (0.0 if abs(x) <= rounding else x for x in (work.min(), work.max(), work[-1]))
        remarks.append(f"The joints do work, between {least:.6g} and {most:.6g} J, and {last:.6g} J by the end.")
    return {"principal moments": moments}, tuple(remarks)
