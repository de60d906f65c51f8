"""SDFormat: the `<inertial>` of links."""

from __future__ import annotations

from collections.abc import Sequence

from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.writing import Body, attribute, distinct, free, heading, number, numbers, xml_comment

_CONVENTION = CONVENTIONS["sdf"]


def write(bodies: Sequence[Body], comments: Sequence[str]) -> str:
    """Return a model of one link a body, not joined; the pose of the inertial frame is not turned."""
    name = bodies[0].name if len(bodies) == 1 else "assembly"
    lines = [
        '<?xml version="1.0" encoding="utf-8"?>',
        xml_comment(heading(bodies, _CONVENTION, comments)),
        '<sdf version="1.9">',
        f"  <model name={attribute(_unreserved(name))}>",
    ]
    for body, word in zip(bodies, distinct([body.name for body in bodies], _unreserved), strict=True):
        properties = body.properties
        elements = zip(_CONVENTION.order, _CONVENTION.elements(properties.inertia), strict=True)
        lines += [
            f"    <link name={attribute(word)}>",
            "      <inertial>",
            f"        <pose>{numbers(properties.center_of_mass.tolist())} 0 0 0</pose>",
            f"        <mass>{number(properties.mass)}</mass>",
            "        <inertia>",
            *(f"          <i{pair}>{number(value)}</i{pair}>" for pair, value in elements),
            "        </inertia>",
            "      </inertial>",
            "    </link>",
        ]
    return "\n".join([*lines, "  </model>", "</sdf>", ""])


def _unreserved(name: str) -> str:
    """Return a name that is not reserved: world, __name__ and what has the delimiter :: in it are."""
    name = name.replace("::", "_")
    return f"part{name}" if name.startswith("__") and name.endswith("__") else free(name)
