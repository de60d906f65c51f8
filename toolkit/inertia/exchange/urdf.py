"""URDF: the `<inertial>` of links."""

from __future__ import annotations

import math
from collections.abc import Sequence

from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.writing import Body, attribute, distinct, heading, number, numbers, printable, xml_comment

_CONVENTION = CONVENTIONS["urdf"]
_FLAT = 1e-14  # I1 + I2 - I3 over I3, more than MuJoCo rounds


def write(bodies: Sequence[Body], comments: Sequence[str]) -> str:
    """Return a robot of one link a body; several hang from an empty root by fixed joints.

    rpy is written as zero and all six elements as they are, since some readers drop the rotation. MuJoCo has the
    moments from these to a few parts in 10¹⁵, and refuses some of flat bodies.
    """
    flat = [
        f"MuJoCo may refuse {body.name}: I1 + I2 and I3 of it are the same to {_FLAT:g}. Write it as MJCF for that."
        for body in bodies
        if _margin(body) < _FLAT
    ]
    lines = [
        '<?xml version="1.0" encoding="utf-8"?>',
        xml_comment([*heading(bodies, _CONVENTION, comments), *map(printable, flat)]),
    ]
    words = distinct([body.name for body in bodies])
    if len(bodies) == 1:
        return "\n".join(
            [*lines, f"<robot name={attribute(bodies[0].name)}>", *_link(bodies[0], words[0]), "</robot>", ""]
        )
    root = "root"
    while root in words:
        root += "_"
    lines += ['<robot name="assembly">', f'  <link name="{root}"/>']
    for body, word in zip(bodies, words, strict=True):
        lines += [
            *_link(body, word),
            f'  <joint name={attribute(f"{root} to {word}")} type="fixed">',
            f'    <parent link="{root}"/>',
            f"    <child link={attribute(word)}/>",
            "  </joint>",
        ]
    return "\n".join([*lines, "</robot>", ""])


def _margin(body: Body) -> float:
    """Return I1 + I2 − I3 of the principal moments, over I3; infinity of a point."""
    first, second, third = body.properties.principal_moments.tolist()
    return float((first + second - third) / third) if third else math.inf


def _link(body: Body, word: str) -> list[str]:
    properties = body.properties
    elements = zip(_CONVENTION.order, _CONVENTION.elements(properties.inertia), strict=True)
    inertia = " ".join(f'i{pair}="{number(value)}"' for pair, value in elements)
    return [
        f"  <link name={attribute(word)}>",
        "    <inertial>",
        f'      <origin xyz="{numbers(properties.center_of_mass.tolist())}" rpy="0 0 0"/>',
        f'      <mass value="{number(properties.mass)}"/>',
        f"      <inertia {inertia}/>",
        "    </inertial>",
        "  </link>",
    ]
