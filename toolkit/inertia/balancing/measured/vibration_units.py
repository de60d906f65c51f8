"""Units of vibration: displacement, velocity and acceleration, as root mean square, peak or peak to peak."""

from __future__ import annotations

import math

from inertia.balancing.measured.trial_weights import STANDARD_GRAVITY
from inertia.errors import UsageError
from inertia.records import dataclass


@dataclass(frozen=True)
class VibrationUnit:
    """A unit of vibration.

    Attributes
    ----------
    name : as files and reports have it
    quantity : "displacement", "velocity" or "acceleration"
    peak : the peak of a motion whose reading is 1, in m, m/s or m/s²
    """

    name: str
    quantity: str
    peak: float


_SCALES = {
    "µm": ("displacement", 1e-6, "pp"),
    "mil": ("displacement", 25.4e-6, "pp"),
    "mm/s": ("velocity", 1e-3, "rms"),
    "in/s": ("velocity", 25.4e-3, "peak"),
    "m/s²": ("acceleration", 1.0, "rms"),
    "g": ("acceleration", STANDARD_GRAVITY, "rms"),
}
_DETECTORS = {"rms": math.sqrt(2.0), "peak": 1.0, "pp": 0.5}
_ALIASES = {
    "um": "µm", "micron": "µm", "microns": "µm", "mils": "mil", "ips": "in/s", "m/s2": "m/s²", "m/s^2": "m/s²",
    **dict.fromkeys(("pk", "0-p", "0-pk", "o-p", "zero-peak"), "peak"),
    **dict.fromkeys(("p-p", "pk-pk", "pkpk", "peak-peak", "peak-to-peak", "peak to peak"), "pp"),
}  # fmt: skip


def vibration_unit(name: str) -> VibrationUnit:
    """Return a unit by its name, in any case; of one that does not say how it is rectified, the one that is customary.

    >>> vibration_unit("MIL p-p").name, vibration_unit("mm/s").name, vibration_unit("in/s 0-pk").name
    ('mil pp', 'mm/s rms', 'in/s peak')

    Raises `UsageError` for an unknown one.
    """
    scale, _, detector = " ".join(name.lower().replace("μ", "µ").split()).partition(" ")
    scale, detector = _ALIASES.get(scale, scale), _ALIASES.get(detector, detector)
    if scale not in _SCALES or (detector and detector not in _DETECTORS):
        raise UsageError(
            f"is {name!r}: use one of {', '.join(_SCALES)}, each with rms, peak or pp (peak to peak), as 'mm/s rms'"
        )
    quantity, size, usual = _SCALES[scale]
    detector = detector or usual
    return VibrationUnit(f"{scale} {detector}", quantity, size * _DETECTORS[detector])
