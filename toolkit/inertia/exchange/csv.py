"""CSV: one row a body, the columns as in every table of this package."""

from __future__ import annotations

from collections.abc import Sequence

from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.writing import Body, number
from inertia.tables import csv_text

_CONVENTION = CONVENTIONS["csv"]
_SAYS = "SI; tensor elements, ixy = -integral of x y dm, about the centre of mass"


def write(bodies: Sequence[Body], comments: Sequence[str]) -> str:
    """Return a table with a line of names; there are no comments in CSV, so the last column says what is meant."""
    del comments
    rows: list[list[str]] = [
        [
            *("name", "mass", "com_x", "com_y", "com_z"),
            *(f"i{pair}" for pair in _CONVENTION.order),
            *("error_mass", "error_com", "error_inertia", "method", "convention"),
        ]
    ]
    for body in bodies:
        properties, error = body.properties, body.properties.error
        values = [properties.mass, *properties.center_of_mass.tolist(), *_CONVENTION.elements(properties.inertia)]
        bounds = [error.mass, error.center_of_mass, error.inertia]
        rows.append([body.name, *map(number, (*values, *bounds)), error.method, _SAYS])
    return csv_text(rows)
