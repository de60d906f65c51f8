"""URDF: the `<inertial>` of links."""

from __future__ import annotations

from collections.abc import Sequence

from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.writing import Body, attribute, heading, number, numbers, xml_comment

_CONVENTION = CONVENTIONS["urdf"]


def write(bodies: Sequence[Body], comments: Sequence[str]) -> str:
    """Return a robot of one link a body; several hang from an empty root by fixed joints.

    rpy is written as zero and all six elements as they are, since some readers drop the rotation.
    """
    lines = ['<?xml version="1.0" encoding="utf-8"?>', xml_comment(heading(bodies, _CONVENTION, comments))]
    if len(bodies) == 1:
        return "\n".join([*lines, f"<robot name={attribute(bodies[0].name)}>", *_link(bodies[0]), "</robot>", ""])
    root = "root"
    while root in {body.name for body in bodies}:
        root += "_"
    lines += ['<robot name="assembly">', f'  <link name="{root}"/>']
    for body in bodies:
        lines += [
            *_link(body),
            f'  <joint name={attribute(f"{root} to {body.name}")} type="fixed">',
            f'    <parent link="{root}"/>',
            f"    <child link={attribute(body.name)}/>",
            "  </joint>",
        ]
    return "\n".join([*lines, "</robot>", ""])


def _link(body: Body) -> list[str]:
    properties = body.properties
    elements = zip(_CONVENTION.order, _CONVENTION.elements(properties.inertia), strict=True)
    inertia = " ".join(f'i{pair}="{number(value)}"' for pair, value in elements)
    return [
        f"  <link name={attribute(body.name)}>",
        "    <inertial>",
        f'      <origin xyz="{numbers(properties.center_of_mass.tolist())}" rpy="0 0 0"/>',
        f'      <mass value="{number(properties.mass)}"/>',
        f"      <inertia {inertia}/>",
        "    </inertial>",
        "  </link>",
    ]
