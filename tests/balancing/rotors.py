"""Rotors with known answers, and the shaft along z that most of them run on."""

import cmath
import math

import numpy as np

import inertia
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.unbalance import PointMass, Unbalance
from inertia_meshes import catalogue, path

STEEL = 7850.0
MM = 1e-3


def on_z(z_a=0.0, z_b=1.0, rotation="ccw"):
    """Return the shaft along the part's z axis with 0° at x; places in metres."""
    return Shaft([0, 0, z_a], [0, 0, z_b], [1, 0, 0], rotation)


def at(magnitude, degrees):
    """Return a vector of that magnitude at that angle."""
    return cmath.rect(magnitude, math.radians(degrees))


def lumped(masses):
    """Return the unbalance of nothing but point masses, summed about z = 0 in plain arithmetic."""
    mass = sum(k.mass for k in masses)
    z = sum(k.mass * k.z for k in masses) / mass
    vectors = [(k.mass * at(k.radius, math.degrees(k.angle)), k.z) for k in masses]
    return Unbalance(mass, z, sum(u for u, _ in vectors), sum(u * (place - z) for u, place in vectors))


def weight(kg, mm, degrees, z_mm):
    """Return a point mass from the shop's units."""
    return PointMass(kg, mm * MM, math.radians(degrees), z_mm * MM)


def two_disc_part():
    """Return the rotor of case 14 as the stored mesh."""
    return inertia.read(path("two_disc_rotor.stl"), unit="mm")


def two_disc_true():
    """Return the exact properties of the rotor of case 14, from its closed form."""
    known = catalogue()["two_disc_rotor.stl"]["closed_form"]
    return inertia.MassProperties(
        STEEL * known["volume"], known["volume"], known["center_of_mass"], STEEL * np.array(known["inertia"])
    )
