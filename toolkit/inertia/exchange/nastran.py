"""Nastran: CONM2 at a grid point, in large fields of 16 columns."""

from __future__ import annotations

from collections.abc import Sequence

from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.writing import Body, fitted, heading, printable, rounding

_CONVENTION = CONVENTIONS["nastran"]
_WIDTH = 16


def write(bodies: Sequence[Body], comments: Sequence[str]) -> str:
    """Return a grid point at the origin of the part's axes and a CONM2 a body, numbered from 1."""
    entries: list[str] = []
    written: list[tuple[float, float]] = []
    for k, body in enumerate(bodies, 1):
        properties = body.properties

        def real(value: float) -> str:
            text, there = fitted(value, _WIDTH, "")
            written.append((float(value), there))
            return text

        com = [real(value) for value in properties.center_of_mass.tolist()]
        elements = [real(value) for value in _CONVENTION.elements(properties.inertia)]
        entries += [
            f"$ {printable(body.name)}: GRID and CONM2 {k}",
            _line("GRID*", str(k), "", "0.", "0."),
            _line("*", "0."),
            _line("CONM2*", str(k), str(k), "0", real(properties.mass)),
            _line("*", *com),
            _line("*", *elements[:4]),
            _line("*", *elements[4:]),
        ]
    digits = rounding(_WIDTH, written)
    return "\n".join([*(f"$ {line}" for line in (*heading(bodies, _CONVENTION, comments), digits)), *entries, ""])


def _line(name: str, *fields: str) -> str:
    return (f"{name:<8}" + "".join(f"{field:<{_WIDTH}}" for field in fields)).rstrip()
