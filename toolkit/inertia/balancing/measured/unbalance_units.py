"""Units of unbalance as a job's files name them, with the signs that a keyboard has."""

from __future__ import annotations

from itertools import product
from typing import Any, Literal, get_args

from inertia.documents import FieldError, Reader, short_repr

UnbalanceUnit = Literal["g·mm", "oz·in"]

_DOTS = "·⋅.*-"
_UNITS: tuple[UnbalanceUnit, ...] = get_args(UnbalanceUnit)
_SPELLINGS = {unit.replace("·", dot): unit for unit, dot in product(_UNITS, _DOTS)}


def unbalance_unit(*others: str) -> Reader:
    """Read "g·mm" or "oz·in", with a dot, a star or a hyphen too, or one of some other words.

    >>> unbalance_unit().read("oz-in", "machine.unit"), unbalance_unit("g").read("g", "weights")
    ('oz·in', 'g')
    """
    words = {**_SPELLINGS, **dict(zip(others, others, strict=True))}

    def read(value: Any, path: str) -> str:
        if isinstance(value, str) and value in words:
            return words[value]
        # None is named as meant: what is spelled like it, as "g·cm", is another unit.
        listed = ", ".join(map(repr, (*_UNITS, *others)))
        raise FieldError(path, f"is {short_repr(value)}: use one of {listed}, and give the figures in it")

    return Reader(read, {"enum": list(words)})
