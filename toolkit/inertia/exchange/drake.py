"""Drake: `SpatialInertia` in Python."""

from __future__ import annotations

from collections.abc import Sequence

from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.writing import Body, heading, identifiers, number, numbers

_CONVENTION = CONVENTIONS["drake"]


def write(bodies: Sequence[Body], comments: Sequence[str]) -> str:
    """Return a Python module with one `SpatialInertia` a body, about the origin of the part's axes."""
    lines = [f"# {line}" for line in heading(bodies, _CONVENTION, comments)]
    lines.append("from pydrake.multibody.tree import RotationalInertia, SpatialInertia")
    for body, variable in zip(bodies, identifiers([body.name for body in bodies]), strict=True):
        properties = body.properties
        elements = zip(_CONVENTION.order, map(number, _CONVENTION.elements(properties.inertia)), strict=True)
        lines += [
            "",
            f"{variable} = SpatialInertia.MakeFromCentralInertia(",
            f"    mass={number(properties.mass)},",
            f"    p_PScm_E=[{numbers(properties.center_of_mass.tolist(), ', ')}],",
            "    I_SScm_E=RotationalInertia(",
            *(f"        I{pair}={value}," for pair, value in elements),
            "    ),",
            ")",
        ]
    return "\n".join([*lines, ""])
