"""Units of unbalance as a job's files name them, with the signs that a keyboard has."""

from __future__ import annotations

from itertools import product
from typing import Any, Literal, get_args

from inertia.documents import Reader, choice

UnbalanceUnit = Literal["g·mm", "oz·in"]

_DOTS = "·⋅.*-"
_UNITS: tuple[UnbalanceUnit, ...] = get_args(UnbalanceUnit)
_SPELLINGS = {unit.replace("·", dot): unit for unit, dot in product(_UNITS, _DOTS)}


def unbalance_unit(*others: str) -> Reader:
    """Read "g·mm" or "oz·in", with a dot, a star or a hyphen too, or one of some other words.

    >>> unbalance_unit().read("oz-in", "machine.unit"), unbalance_unit("g").read("g", "weights")
    ('oz·in', 'g')
    """
    words = choice(*_UNITS, *others)

    def read(value: Any, path: str) -> str:
        known = _SPELLINGS.get(value) if isinstance(value, str) else None
        return known or words.read(value, path)

    return Reader(read, {"enum": [*_SPELLINGS, *others]})
