"""Trial weights: how large, where, and whether the machine answered clearly enough.

A trial weight is large enough to be seen in the readings and small enough to be safe: by custom, one whose centrifugal
force is a tenth of the rotor's weight. The run counts if a sensor changed by 30 % in amplitude or by 30° in phase.
Angles are those of the rotor (`inertia.balancing.unbalance`), readings those of `inertia.balancing.measured.readings`.
"""

from __future__ import annotations

import cmath
import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.balancing.measured.readings import complex_of
from inertia.balancing.unbalance import Complex
from inertia.errors import UsageError
from inertia.records import dataclass

WEIGHT_SHARE = 0.1
"""Centrifugal force of a trial weight over the weight of the rotor."""

AMPLITUDE_CHANGE = 0.3
"""Relative change of amplitude from which a trial run counts."""

PHASE_CHANGE = math.radians(30.0)
"""Change of phase, rad, from which a trial run counts."""

STANDARD_GRAVITY = 9.80665
"""m/s²."""

# No change of reading that is larger than this, relative, can be less than both: |1.3 e^{iπ/6} − 1|.
_CERTAIN = abs(cmath.rect(1.0 + AMPLITUDE_CHANGE, PHASE_CHANGE) - 1.0)


@dataclass(frozen=True)
class TrialWeight:
    """A weight to mount for a trial run.

    Attributes
    ----------
    mass : kg
    radius : m
    angle : rad from the zero mark, 0 to 2π; None where any place is as good as another
    force : N, its centrifugal force
    """

    mass: float
    radius: float
    angle: float | None
    force: float


@dataclass(frozen=True, eq=False)
class TrialResponse:
    """How the readings answered a trial weight.

    Attributes
    ----------
    amplitude_change : (...) relative, signed
    phase_change : (...) rad, −π to π
    enough : a sensor reached the limit in amplitude or phase
    factor : by how much to enlarge the trial weight so that it is certain to be enough; 1 where it is
    note : the finding in a sentence
    """

    amplitude_change: Float
    phase_change: Float
    enough: bool
    factor: float
    note: str


def unbalance_for_force(force: float, speed: float) -> float:
    """Return the unbalance (kg·m) whose centrifugal force is `force` (N) at `speed` (rad/s): F/ω².

    >>> unbalance_for_force(100.0, 100.0)
    0.01
    """
    _require_positive(force=force, speed=speed)
    return force / speed**2


def unbalance_for_weight(mass: float, speed: float, share: float = WEIGHT_SHARE) -> float:
    """Return the unbalance (kg·m) whose centrifugal force is a share of the weight that its plane's bearing carries.

    Parameters
    ----------
    mass : kg, of the rotor for one plane; for two planes, what each bearing carries
    speed : rad/s
    share : of the weight m g
    """
    _require_positive(mass=mass, share=share)
    return unbalance_for_force(share * mass * STANDARD_GRAVITY, speed)


def unbalance_for_change(change: float, coefficient: complex) -> float:
    """Return the unbalance (kg·m) that changes a reading by `change`, by an influence coefficient known from before.

    Parameters
    ----------
    change : magnitude, in the unit of the readings
    coefficient : change of the reading per kg·m
    """
    _require_positive(change=change, coefficient=abs(coefficient))
    return change / abs(coefficient)


def trial_weight(
    unbalance: float,
    radius: float,
    speed: float,
    *,
    reading: complex | None = None,
    lag: float | None = None,
    rotation: Literal["ccw", "cw"] = "ccw",
) -> TrialWeight:
    """Return a trial weight, placed opposite the heavy spot where the lag of the readings tells where that is.

    The heavy spot is at arg V + lag on a rotor that turns in the sense of its angles, at arg V − lag on one that turns
    against it; so placed, a weight that is not too large lowers the vibration.

    Parameters
    ----------
    unbalance : kg·m, its magnitude
    radius : m, where it is mounted
    speed : rad/s
    reading : the initial reading, see `inertia.balancing.measured.readings`
    lag : rad, by which that reading is behind the heavy spot: near 0 far below resonance, π/2 at it, π above; plus the
        angle from the reference pickup to the sensor, in the sense of rotation
    rotation : "ccw" where the rotor turns in the sense of its angles

    >>> trial_weight(1e-3, 0.1, 100.0, reading=5.0, lag=0.0)
    TrialWeight(mass=0.01, radius=0.1, angle=3.141592653589793, force=10.0)
    """
    _require_positive(unbalance=unbalance, radius=radius, speed=speed)
    if rotation not in ("ccw", "cw"):
        raise UsageError(f"rotation is {rotation!r}: use 'ccw' or 'cw'")
    angle = None
    if reading is not None and lag is not None:
        heavy = cmath.phase(reading) + (lag if rotation == "ccw" else -lag)
        angle = (heavy + math.pi) % (2.0 * math.pi)
    return TrialWeight(unbalance / radius, radius, angle, unbalance * speed**2)


def trial_response(initial: ArrayLike, trial: ArrayLike) -> TrialResponse:
    """Say whether a trial run changed the readings enough to be used: by 30 % in amplitude or 30° in phase.

    Parameters
    ----------
    initial, trial : (...) readings without and with the trial weight, one for each speed and sensor

    >>> trial_response([100.0, 50.0], [104.0, 52.0]).note
    'the largest change is 4 % and 0°, less than 30 % and 30°: repeat with 16.6 times the trial weight'
    """
    before, after = complex_of(initial, "initial"), complex_of(trial, "trial")
    if before.shape != after.shape or before.size == 0:
        raise UsageError(
            f"initial has shape {before.shape} and trial {after.shape}: give the same readings of both runs"
        )
    if not before.all():
        raise UsageError("an initial reading is zero: leave that sensor out, its relative change says nothing")
    ratio: Complex = after / before
    amplitude, phase = np.abs(ratio) - 1.0, np.angle(ratio)
    enough = bool(((np.abs(amplitude) >= AMPLITUDE_CHANGE) | (np.abs(phase) >= PHASE_CHANGE)).any())
    largest = float(np.abs(ratio - 1.0).max())
    factor = 1.0 if enough else (_CERTAIN / largest if largest else math.inf)
    change = f"the largest change is {100 * np.abs(amplitude).max():.3g} % and {np.degrees(np.abs(phase).max()):.3g}°"
    rule = f"{100 * AMPLITUDE_CHANGE:g} % and {math.degrees(PHASE_CHANGE):g}°"
    if enough:
        note = f"{change}: enough"
    elif math.isinf(factor):
        note = f"{change}: no reading changed, check the sensors and that the weight was mounted"
    else:
        note = f"{change}, less than {rule}: repeat with {factor:.3g} times the trial weight"
    return TrialResponse(amplitude, phase, enough, factor, note)


def _require_positive(**values: float) -> None:
    for name, value in values.items():
        if not 0 < value < math.inf:
            raise UsageError(f"{name} is {value!r}: it must be positive and finite")
