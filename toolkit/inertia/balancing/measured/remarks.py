"""What a balancing job has to be told: trial weights that did too little, planes that act alike, runs that disagree."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations

import numpy as np

from inertia.arrays import Float
from inertia.balancing.measured.estimate import Estimate, positions_of, reading_moves
from inertia.balancing.measured.influence import CONDITION_WARNING, InfluenceCorrection
from inertia.balancing.measured.job import AMPLITUDE, PHASE, Job
from inertia.balancing.measured.trial_weights import trial_response
from inertia.balancing.measured.vibration_units import vibration_unit
from inertia.balancing.shop_units import GRAM_MILLIMETRE, in_degrees
from inertia.balancing.unbalance import Complex

_DROWNED = 3.0  # standard uncertainties that a trial weight's effect should exceed
_ALIKE = math.radians(15.0)  # angle between the effects of two planes below which they are hardly told apart
_STRAY = 3.0  # standard uncertainties by which a run may be off the others
_ROUNDING = 1e-9  # of a reading
_ALIKE_FAR = 1e-3  # relative: where the runs have one number to spare, all of them are as far off


def remarks(
    job: Job,
    result: Estimate,
    correction: InfluenceCorrection | None,
    reused: bool,
) -> list[str]:
    """Return what a job has to be told, in sentences.

    Parameters
    ----------
    job, result : the readings, and what they say
    correction : by influence coefficients; None without phase
    reused : whether the coefficients are those of an earlier job
    """
    notes = _on_readings(job)
    if reused:
        notes.append(f"the coefficients are those of {job.fields.coefficients}: its marks have to be where they were")
    elif not job.by_machine:
        notes += _on_trials(job, result)
    if correction is not None and not job.by_machine:
        notes += _on_coefficients(job, result, correction)
    notes += _on_contradictions(job, result)
    if not result.bounded:
        notes.append(
            "the readings do not bound the unbalance: what a weight does to them is known to no better than a half of "
            "it; nothing passes or fails by that, and no weights are proposed: repeat with larger trial weights"
        )
    if job.fields.tolerance.grade is not None and len(job.planes) > 1:
        notes.append(
            "the permissible unbalance is shared equally among the planes: name a rotor file to have it shared by the "
            "centre of mass"
        )
    return notes


def on_places(job: Job, places: Sequence[Estimate], after: Sequence[float]) -> list[str]:
    """Name the places of the heavy spot where there are several, and how a run with the correction tells which it is.

    Parameters
    ----------
    job : without phase
    places : what the readings say if it is at each of them
    after : the amplitude that the correction of the first leaves in each case; empty where none is proposed
    """
    if len(places) < 2:
        return []
    size, unit = (1e3, "g") if job.weighed_alone else (1 / GRAM_MILLIMETRE, "g·mm")
    named = " and ".join(
        f"{size * abs(one):.4g} {unit} at {_degrees(one)}" for one in (complex(k.unbalance[0]) for k in places)
    )
    note = f"{'two' if len(places) == 2 else len(places)} places of the heavy spot explain the amplitudes, {named}"
    if after:
        (channel,), second = job.channels, complex(places[1].unbalance[0])
        note += (
            f": mount the correction of the first, and add the run; it tells which, as {channel.sensor} shows "
            f"{after[1]:.3g} {job.unit_of(channel)} with it if the second is true, which takes "
            f"{1e3 * abs(second) / job.per_mass(0):.4g} g at {_degrees(-second)}"
        )
    return [note]


def _degrees(vector: complex) -> str:
    return f"{round(in_degrees(vector), 1) % 360.0:.1f}°"


def _on_readings(job: Job) -> list[str]:
    notes = []
    stated = job.fields.uncertainty
    if stated.amplitude is None and any(sensor.amplitude is None for sensor in job.fields.sensor or (stated,)):
        good = f"{100 * AMPLITUDE:g} %" + (f" and {PHASE:g}°" if job.by_phase else "")
        notes.append(f"readings are assumed to be good to {good}, as the job states no uncertainty")
    if runouts := [sensor.id for sensor in job.fields.sensor if sensor.runout is not None]:
        notes.append(f"the runout of {', '.join(runouts)} is taken off its readings; those that are shown have it")
    quantities = {vibration_unit(sensor.unit).name for sensor in job.fields.sensor}
    if len(quantities) > 1 and len({sensor.importance for sensor in job.fields.sensor}) == 1:
        notes.append(f"readings in {' and '.join(sorted(quantities))} count alike, number by number: give importance")
    return notes


def _on_trials(job: Job, result: Estimate) -> list[str]:
    """Say where a trial weight did too little to be seen."""
    notes: list[str] = []
    readings = job.vibrations if job.by_phase else job.amplitudes.astype(complex)
    spread = _standard(job, readings)
    positions = positions_of(job)
    for k in range(1, len(job.runs)):
        change = np.abs(result.mounted[:k] - result.mounted[k]).sum(axis=1)
        change[positions[:k] != positions[k]] = math.inf
        if not change.all() or not np.isfinite(change).any():
            continue
        base = int(np.argmin(change))
        effect = np.abs(readings[k] - readings[base]) / np.maximum(np.hypot(spread[k], spread[base]), 1e-300)
        if effect.max() < _DROWNED:
            notes.append(
                f"run {job.runs[k].id}: what the weight changed is {effect.max():.2g} times the uncertainty of the "
                "readings: its effect drowns in the noise, mount a larger one"
            )
        elif job.by_phase and readings[base].all():
            response = trial_response(readings[base], readings[k])
            if not response.enough:
                notes.append(f"run {job.runs[k].id}: {response.note}")
    return notes


def _on_coefficients(job: Job, result: Estimate, correction: InfluenceCorrection) -> list[str]:
    notes = []
    assert result.coefficients is not None
    weighted = np.sqrt(job.importance)[:, None] * result.coefficients
    for i, j in combinations(range(len(job.planes)), 2):
        first, second = weighted[:, i], weighted[:, j]
        cosine = abs(complex(np.vdot(first, second))) / float(np.linalg.norm(first) * np.linalg.norm(second))
        apart = math.acos(min(1.0, cosine))
        if apart < _ALIKE:
            notes.append(
                f"planes {job.planes[i].id} and {job.planes[j].id} act alike on the readings, within "
                f"{math.degrees(apart):.2g}°: they are hardly told apart; leave one out, or add a sensor or a speed"
            )
    if correction.condition > CONDITION_WARNING:
        notes.append(
            f"the coefficients have condition {correction.condition:.3g}, above {CONDITION_WARNING:g}: errors of the "
            "readings may show in the weights so many times larger"
        )
    return notes


def contradiction(job: Job, result: Estimate) -> float:
    """Return by how many standard uncertainties the reading farthest off is off what the runs have in common."""
    return float(_stray(job, result).max())


def _stray(job: Job, result: Estimate) -> Float:
    """Return by how many standard uncertainties readings (runs, channels) are off what the runs have in common."""
    readings = job.vibrations if job.by_phase else job.amplitudes
    nothing = _ROUNDING * np.abs(readings + job.runouts).max(axis=0) + 1e-300
    stray: Float = np.abs(result.residuals) / np.maximum(result.residual_uncertainty, nothing)
    return stray


def _on_contradictions(job: Job, result: Estimate) -> list[str]:
    """Name the reading that is farthest off; of those that are as far, the first."""
    stray = _stray(job, result)
    if stray.max() <= _STRAY:
        return []
    run, channel = np.unravel_index(int((stray >= (1 - _ALIKE_FAR) * stray.max()).argmax()), stray.shape)
    off = f"{stray.max():.{1 if stray.max() < 10 else 0}f}"
    return [
        f"the runs contradict each other: {job.channels[channel]} of run {job.runs[run].id} is off by {off} standard "
        f"uncertainties; the machine is not linear, something has moved, or a weight is not as stated{_slip(job)}"
    ]


def _slip(job: Job) -> str:
    """Return what the log of weights may have wrong."""
    weights = [weight for run in job.runs for weight in run.weights]
    if any((weight.mass_g or 0.0) < 0 and weight.radius is None for weight in weights):
        return (
            " (what a hole takes counts at the radius of its own centre, not at that of the surface: give the weight's "
            "radius, or gmm)"
        )
    if any((weight.mass_g or weight.gmm or 0.0) < 0 for weight in weights):
        return ""
    return " (what was taken away is negative)"


def _standard(job: Job, readings: Complex) -> Float:
    """Return the standard uncertainty of each reading, as a vector; of what was read, the runout included."""
    moves = reading_moves(job, readings + job.runouts)
    spread: Float = np.sqrt((np.abs(moves) ** 2).sum(axis=0) / 2.0)
    return spread
