"""Abaqus: *MASS and *ROTARY INERTIA at a node at the centre of mass."""

from __future__ import annotations

from collections.abc import Sequence

from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.writing import Body, fitted, heading, identifiers, printable, rounding

_CONVENTION = CONVENTIONS["abaqus"]
_WIDTH = 20


def write(bodies: Sequence[Body], comments: Sequence[str]) -> str:
    """Return a node and two elements a body, numbered from 1."""
    blocks: list[str] = []
    written: list[tuple[float, float]] = []

    def reals(values: Sequence[float]) -> str:
        fits = [fitted(value, _WIDTH) for value in values]
        written.extend((float(value), there) for value, (_, there) in zip(values, fits, strict=True))
        return ", ".join(text for text, _ in fits)

    for k, (body, name) in enumerate(zip(bodies, identifiers([body.name for body in bodies]), strict=True), 1):
        properties = body.properties
        blocks += [
            f"** {printable(body.name)}",
            "*NODE",
            f"{k}, {reals(properties.center_of_mass.tolist())}",
            f"*ELEMENT, TYPE=MASS, ELSET={name}_MASS",
            f"{2 * k - 1}, {k}",
            f"*MASS, ELSET={name}_MASS",
            reals([properties.mass]),
            f"*ELEMENT, TYPE=ROTARYI, ELSET={name}_INERTIA",
            f"{2 * k}, {k}",
            f"*ROTARY INERTIA, ELSET={name}_INERTIA",
            reals(_CONVENTION.elements(properties.inertia)),
        ]
    digits = rounding(_WIDTH, written)
    return "\n".join([*(f"** {line}" for line in (*heading(bodies, _CONVENTION, comments), digits)), *blocks, ""])
