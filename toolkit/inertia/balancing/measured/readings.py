"""Vibration readings as complex numbers whose angles run as the rotor's do.

A rotor with unbalance u that turns with its angles ("ccw") moves a sensor by Re(h u e^{iωt}); one that turns against
them ("cw") by Re(h ū e^{iωt}). What is linear in u is therefore the reading in the first case and its conjugate in the
second, and the conjugate once more where an instrument shows by how much the motion *lags*. Readings whose phase and
weights whose angle are not counted in the same sense give weights that are wrong without any sign of it.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import is_masked, reals
from inertia.balancing.unbalance import Complex
from inertia.errors import UsageError


def readings(
    amplitude: ArrayLike,
    phase_deg: ArrayLike,
    *,
    phase: Literal["lead", "lag"] = "lead",
    rotation: Literal["ccw", "cw"] = "ccw",
) -> Complex:
    """Return readings of an instrument as complex numbers that are linear in the unbalance.

    Parameters
    ----------
    amplitude : (...) in any unit of vibration, the same one throughout; not negative
    phase_deg : (...) degrees
    phase : "lead" where the motion is A cos(ωt + φ), "lag" where it is A cos(ωt − φ)
    rotation : "ccw" where the rotor turns in the sense in which its angles are counted, else "cw"
        (`inertia.balancing.unbalance`)

    >>> readings([2.0, 2.0], [90.0, 270.0]).imag.tolist()
    [2.0, -2.0]
    >>> readings([2.0, 2.0], [90.0, 270.0], phase="lag").imag.tolist()
    [-2.0, 2.0]
    """
    if phase not in ("lead", "lag") or rotation not in ("ccw", "cw"):
        raise UsageError(f"phase is {phase!r} and rotation {rotation!r}: use 'lead' or 'lag', and 'ccw' or 'cw'")
    try:
        size, angle = reals(amplitude), np.radians(reals(phase_deg))
    except (TypeError, ValueError):
        raise UsageError("amplitudes and phases must be arrays of real numbers") from None
    if not (size >= 0).all():
        raise UsageError(f"amplitudes are {size.tolist()}: they must be numbers that are not negative")
    sign = 1.0 if (phase == "lead") == (rotation == "ccw") else -1.0
    return complex_of(size * np.exp(1j * sign * angle), "readings")


def complex_of(value: ArrayLike, name: str) -> Complex:
    """Return `value` as a finite complex array, or raise `UsageError` naming it."""
    if is_masked(value):
        value = np.ma.filled(value.astype(np.complex128), np.nan)  # refused as such
    try:
        array: Complex = np.array(value, dtype=np.complex128)
    except (TypeError, ValueError):
        raise UsageError(f"{name} must be an array of complex numbers without gaps") from None
    if not np.isfinite(array).all():
        raise UsageError(f"{name} holds a value that is not finite: {array.tolist()}")
    return array
