"""OpenUSD: `PhysicsMassAPI` on the prims of a stage."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from inertia.errors import UsageError
from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.rotations import quaternion_of
from inertia.exchange.writing import Body, heading, identifiers, triangular

_CONVENTION = CONVENTIONS["usd"]
_ROUNDING = "USD keeps these numbers in float32: each is rounded by up to 6e-8 of itself."


def write(bodies: Sequence[Body], comments: Sequence[str]) -> str:
    """Return a stage of one rigid body each, in text (usda).

    Raises `UsageError` where a mass or moment leaves float32, or becomes zero in it, which counts as not given.
    """
    prims = identifiers([body.name for body in bodies])
    lines = [
        "#usda 1.0",
        *(f"# {line}" for line in (*heading(bodies, _CONVENTION, comments), _ROUNDING)),
        "(",
        f'    defaultPrim = "{prims[0]}"',
        "    kilogramsPerUnit = 1",
        "    metersPerUnit = 1",
        ")",
    ]
    for body, prim in zip(bodies, prims, strict=True):
        properties = body.properties
        moments = triangular(
            np.array([_single(value, body, "moment of inertia") for value in properties.principal_moments])
        )
        com = [_single(value, body, "centre of mass", zero=True) for value in properties.center_of_mass]
        axes = [np.float32(value) for value in quaternion_of(properties.principal_axes)]
        lines += [
            "",
            f'def Xform "{prim}" (',
            '    prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]',
            ")",
            "{",
            f"    point3f physics:centerOfMass = {_tuple(com)}",
            f"    float3 physics:diagonalInertia = {_tuple(moments)}",
            f"    float physics:mass = {_single(properties.mass, body, 'mass')!s}",
            f"    quatf physics:principalAxes = {_tuple(axes)}",
            "}",
        ]
    return "\n".join([*lines, ""])


def _single(value: float, body: Body, what: str, *, zero: bool = False) -> np.float32:
    with np.errstate(over="ignore"):
        single = np.float32(value)
    if not np.isfinite(single) or (single < np.finfo(np.float32).tiny and not zero):
        raise UsageError(
            f"the {what} of {body.name}, {value:.3g}, is beyond float32, which is what USD keeps: choose another target"
        )
    return single + np.float32(0)


def _tuple(values: Iterable[np.float32]) -> str:
    return f"({', '.join(str(value) for value in values)})"
