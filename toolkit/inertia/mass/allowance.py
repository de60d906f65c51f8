"""Answers for parts with faults: what their faults leave open, in the bounds, up to what is allowed."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import numpy as np

from inertia.arrays import Parts
from inertia.errors import (
    ALLOW_FAULTS,
    REPAIR,
    UNION,
    GeometryError,
    Remedy,
    reworded,
)
from inertia.mass.analysis import Analysis
from inertia.mesh.part import Part

_MENDABLE = (REPAIR, UNION)
_LOOKED_THROUGH = 20_000  # triangles up to which a refusal says how wide the bound of an answer would be: a second
_ALLOW = " gives an answer whose bound covers the faults"
_BOUNDLESS = "; what its faults leave open cannot be bounded"


def allowing(part: Part, parts: Parts, answer: Callable[..., Analysis], allowed: float, *, alike: bool) -> Analysis:
    """Answer for a part whose faults may leave no more open than is allowed; `alike` as of `inertia.repair`."""
    from inertia.mass.faults import left_open, too_wide, widths

    try:
        analysis = answer(part, parts, left_open(part))
    except GeometryError as fault:
        analysis = _mended(part, parts, answer, fault, allowed, alike)
        analysis = replace(analysis, refusal=fault)
    size = float(np.ptp(analysis.extents, axis=0).max())
    error = analysis.properties.error
    if analysis.doubts and max(widths(error, size).values()) > allowed:
        raise too_wide(part, error, size, allowed)
    return replace(analysis, allowed_faults=allowed)


def _mended(
    part: Part, parts: Parts, answer: Callable[..., Analysis], fault: GeometryError, allowed: float, alike: bool
) -> Analysis:
    """Answer for a part that is refused as it is, its faults mended and what they leave open in the bounds."""
    from inertia.mass.faults import mended, nested, room, united

    part = part if part.shape is None else replace(part, shape=None)
    try:
        mend = mended(part, alike=alike)
        if mend.part is not part:
            with suppress(GeometryError):
                return answer(mend.part, parts, mend.doubts)
        doubts = (*mend.doubts, *nested(mend.part))
        with suppress(GeometryError):
            return answer(mend.part, "separate", doubts, allowed * room(mend.part))
        union = united(mend.part)
        return answer(union.part, parts, (*mend.doubts, *union.doubts))
    except GeometryError:
        raise reworded(fault, (*fault.words, _BOUNDLESS), fault.places) from None


def with_allowance(
    part: Part, parts: Parts, answer: Callable[..., Analysis], fault: GeometryError, *, alike: bool
) -> GeometryError:
    """Return a refusal with what would have to be allowed for an answer, if there is one; `alike` as above."""
    part = part if part.shape is None else replace(part, shape=None)
    if fault.code != "inverted_body" and not any(remedy in _MENDABLE for remedy in fault.remedies):
        return fault
    remedy: Remedy | None = ALLOW_FAULTS
    if part.triangles.count <= _LOOKED_THROUGH:
        from inertia.mass.faults import allowance, widths

        try:
            analysis = _mended(part, parts, answer, fault, 1.0, alike)
        except GeometryError:
            return fault
        size = float(np.ptp(analysis.extents, axis=0).max())
        remedy = allowance(max(widths(analysis.properties.error, size).values()))
    return (
        fault
        if remedy is None
        else GeometryError(*fault.words, "; ", remedy, _ALLOW, places=fault.places, code=fault.code)
    )
