"""MJCF, the models of MuJoCo: the `<inertial>` of bodies."""

from __future__ import annotations

from collections.abc import Sequence

from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.rotations import quaternion_of
from inertia.exchange.writing import (
    Body,
    attribute,
    distinct,
    heading,
    number,
    numbers,
    printable,
    triangular,
    xml_comment,
)

_CONVENTION = CONVENTIONS["mjcf"]
_LEAST = 1e-15  # mjMINVAL


def write(bodies: Sequence[Body], comments: Sequence[str]) -> str:
    """Return a model of one free body each, by principal moments and the quaternion of their axes.

    MuJoCo diagonalises `fullinertia` to a few parts in 10¹⁵ of the largest moment, and refuses flat bodies whose
    moments break I1 + I2 ≥ I3 by rounding; principal moments are kept as they are written. The six elements stand in a
    comment, in the order of `fullinertia`.
    """
    name = bodies[0].name if len(bodies) == 1 else "assembly"
    small = [
        f"MuJoCo refuses {body.name} with a joint: its mass or a moment is below {_LEAST:g}."
        for body in bodies
        if min(body.properties.mass, *body.properties.principal_moments.tolist()) < _LEAST
    ]
    lines = [
        xml_comment([*heading(bodies, _CONVENTION, comments), *map(printable, small)]),
        f"<mujoco model={attribute(name)}>",
        "  <worldbody>",
    ]
    for body, word in zip(bodies, distinct([body.name for body in bodies]), strict=True):
        properties = body.properties
        lines += [
            f"    <body name={attribute(word)}>",
            "      <freejoint/>",
            f'      <!-- fullinertia="{numbers(_CONVENTION.elements(properties.inertia))}" -->',
            f'      <inertial pos="{numbers(properties.center_of_mass.tolist())}" '
            f'quat="{numbers(quaternion_of(properties.principal_axes))}" mass="{number(properties.mass)}"',
            f'                diaginertia="{numbers(triangular(properties.principal_moments).tolist())}"/>',
            "    </body>",
        ]
    return "\n".join([*lines, "  </worldbody>", "</mujoco>", ""])
