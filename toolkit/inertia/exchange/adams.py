"""Adams Solver: PART and the marker at its centre of mass, as statements of a dataset."""

from __future__ import annotations

from collections.abc import Sequence

from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.writing import Body, fitted, heading, printable

_CONVENTION = CONVENTIONS["adams"]
_WIDTH = 24  # enough for every float64; the first line of a statement stays within 80 columns


def write(bodies: Sequence[Body], comments: Sequence[str]) -> str:
    """Return a part a body, numbered from 2, since 1 is most often the ground; its marker has a number of its own."""
    lines = [f"! {line}" for line in heading(bodies, _CONVENTION, comments)]
    lines.append("UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND")
    for k, body in enumerate(bodies, 2):
        marker, properties = 100 * k + 1, body.properties
        xx, *others = map(_real, _CONVENTION.elements(properties.inertia))
        x, *yz = map(_real, properties.center_of_mass.tolist())
        lines += [
            f"! {printable(body.name)}",
            f"PART/{k}, MASS={_real(properties.mass)}, CM={marker}",
            f", IP={xx}",
            *(f", {value}" for value in others),
            f"MARKER/{marker}, PART={k}, QP={x}",
            *(f", {value}" for value in yz),
        ]
    return "\n".join([*lines, ""])


def _real(value: float) -> str:
    return fitted(value, _WIDTH)[0]
