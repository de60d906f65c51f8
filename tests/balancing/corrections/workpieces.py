"""Turned parts to cut, and the steel two-disc rotor of case 14."""

import math

from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.corrections.correction_plane import CorrectionPlane
from inertia.balancing.tolerance import Tolerance
from inertia.balancing.unbalance import Unbalance
from inertia.mass.analyse import mass_properties
from inertia.mesh.part import Part
from inertia_meshes.shapes import revolved

STEEL = 7850.0
GMM = 1e-6
POINT = math.radians(118)


def round_part(*profile, sides=720, unit="mm"):
    """Return a turned part, profile points (r, z) in mm, whose polygons have the circles' areas."""
    step = 2 * math.pi / sides
    wider = math.sqrt(step / math.sin(step))
    scale = {"mm": 1.0, "in": 1 / 25.4}[unit]
    corners = scale * revolved([(wider * r, z) for r, z in profile], sides)
    return Part.from_arrays(corners.reshape(-1, 3), [[3 * k, 3 * k + 1, 3 * k + 2] for k in range(len(corners))], unit)


def plate(radius=100, low=80, high=100, **kwargs):
    """Return a round plate."""
    return round_part((0, low), (radius, low), (radius, high), (0, high), **kwargs)


def on_z(z_a=0.02, z_b=0.28):
    """Return the shaft along z with 0° at x; places in metres."""
    return Shaft([0, 0, z_a], [0, 0, z_b], [1, 0, 0])


def unbalance_of(part, density=STEEL, shaft=None):
    """Return the unbalance of a part on its shaft."""
    return Unbalance.of(mass_properties(part, density), shaft or on_z())


def drilled(name, z, radius, *diameters, **options):
    """Return a plane for radial drills; everything in mm."""
    lengths = {k: 1e-3 * options.pop(k) for k in ("max_depth", "min_wall", "depth_step") if k in options}
    return CorrectionPlane(
        name,
        1e-3 * z,
        "drill_radial",
        1e-3 * radius,
        diameters=tuple(1e-3 * k for k in diameters),
        **lengths,
        **options,
    )


def permits(a, b=None):
    """Return a tolerance of a and b g·mm."""
    return Tolerance("test", "given", (a * GMM, (a if b is None else b) * GMM))
