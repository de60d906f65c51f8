"""Memory that a process takes, and what a part takes where it is analysed at once."""

from __future__ import annotations

import math
import re
import sys
from numbers import Real
from pathlib import Path

from inertia.errors import Remedy, UsageError

WHOLE = 1000
"""Bytes of memory that a triangle takes, at most, where all of them are analysed and checked at once."""

_MEMORY = Remedy("analyse", "memory")

RESERVE = 32_000_000
"""Bytes for what is imported and made on the way."""


def require_memory(memory: float) -> None:
    """Raise `UsageError` for what is no limit of memory."""
    if not (isinstance(memory, Real) and not isinstance(memory, bool) and 0 < memory < math.inf):
        raise UsageError(_MEMORY, f" is {memory!r}: it must be positive and finite, in bytes")


def fits(triangles: int, memory: float) -> bool:
    """Say whether so many triangles, or cells, are analysed at once within so many bytes of this process."""
    return WHOLE * triangles <= memory - resident() - RESERVE


def enough(triangles: int) -> float:
    """Return the bytes of this process in which so many triangles are analysed at once."""
    return 1.02 * (WHOLE * triangles + resident() + RESERVE)


def fits_in_memory(triangles: int, memory: float, held: int) -> bool:
    """Say it of those that were read whole, for which this process holds so many bytes already."""
    return WHOLE * triangles - held <= memory - resident()


def resident() -> int:
    """Return the bytes of memory that this process takes now."""
    try:
        status = Path("/proc/self/status").read_text(encoding="ascii")
        return 1024 * int(re.search(r"VmRSS:\s*(\d+) kB", status)[1])  # type: ignore[index]
    except (OSError, TypeError):
        pass
    try:
        import resource
    except ImportError:  # Windows
        return 100_000_000
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most if sys.platform == "darwin" else 1024 * most


def in_bytes(size: float) -> str:
    """Return a number of bytes in words.

    >>> in_bytes(3.6e9), in_bytes(16777216), in_bytes(500)
    ('3.6 GB', '16.8 MB', '500 bytes')
    """
    for unit, name in ((1e9, "GB"), (1e6, "MB"), (1e3, "kB")):
        if size >= unit:
            return f"{size / unit:.3g} {name}"
    return f"{size:.3g} byte{'s' * (size != 1)}"
