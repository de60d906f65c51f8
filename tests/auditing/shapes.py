"""Shapes of links that are skewed, off the origin and without symmetry, for the tests of audits."""

import numpy as np

from inertia.arrays import Float
from inertia.auditing.bodies import Body, Shape, solid_of
from inertia.auditing.claim import Context, Statement

STEEL = 7850.0


def tetrahedron(corners: Float) -> Float:
    """Return the four triangles (4, 3, 3) of a tetrahedron, wound outwards."""
    a, b, c, d = corners
    if np.dot(np.cross(b - a, c - a), d - a) < 0:
        b, c = c, b
    return np.array([[a, c, b], [a, b, d], [b, c, d], [a, d, c]])


def skewed(name: str = "upper.stl", seed: int = 5, at: tuple[float, float, float] = (0.11, -0.07, 0.05)) -> Shape:
    """Return a tetrahedron of some 0.2 m whose principal axes are no axes of the link's."""
    corners = tetrahedron(np.random.default_rng(seed).normal(size=(4, 3)) * [0.12, 0.05, 0.08] + at)
    angle = 0.7
    rotation = np.array([[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])
    return Shape(name, corners, solid_of(corners), rotation, np.array(at) / 2)


def pair() -> list[Shape]:
    """Return two shapes of one link."""
    return [skewed(), skewed("lower.stl", 8, (-0.06, 0.09, 0.13))]


def context(shapes: list[Shape], body: Body | None = None, rotation: Float | None = None) -> Context:
    """Return shapes with what is stated of them: what they have in steel, unless something else is given."""
    mass = STEEL * sum(shape.solid.mass for shape in shapes)
    nothing = Statement(Body(mass, np.zeros(3), np.eye(3)), np.eye(3))
    truth = Context(nothing, shapes).truth.body
    return Context(Statement(body or truth, np.eye(3) if rotation is None else rotation), shapes)
