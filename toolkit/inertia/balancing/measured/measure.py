"""`measure`: from the readings of a balancing job to weights or holes, and to the verdict on what is left.

The unbalance as measured (`inertia.balancing.measured.estimate`) is judged with its uncertainty: it passes where
|U| ≤ U_per − ΔU and fails where |U| > U_per + ΔU (ISO 21940-14), ΔU being twice the standard uncertainty; where the
readings do not bound it, ΔU is infinite, nothing passes or fails by it, and nothing is to be mounted. What is to be
mounted is found by influence coefficients, within limits and at positions; where the job names a rotor file, holes and
weights come from the planner of `inertia.balance`, by the measured unbalance and the real geometry.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from inertia.arrays import Float, Progress
from inertia.balancing.balance import Balance, as_measured, balance
from inertia.balancing.bounds import COVERAGE
from inertia.balancing.measured.estimate import (
    Estimate,
    estimate,
    explanations,
    fitted_coefficients,
    positions_of,
)
from inertia.balancing.measured.influence import InfluenceCorrection, influence_correction
from inertia.balancing.measured.job import Channel, Job, Plane
from inertia.balancing.measured.job_fields import MeasuredPlaneFields
from inertia.balancing.measured.pieces import added_by, limits_of, pieces_of, within_limits
from inertia.balancing.measured.positions import Piece
from inertia.balancing.measured.remarks import contradiction, on_places, remarks
from inertia.balancing.measured.stored_coefficients import StoredCoefficients
from inertia.balancing.shop_digits import ShopDigits, mounting_digits, shop_digits, together
from inertia.balancing.shop_units import GRAM_MILLIMETRE, angular_speed, in_degrees
from inertia.balancing.tolerance import accepted
from inertia.balancing.unbalance import Complex
from inertia.balancing.verdict import Outcome, Verdict, judge
from inertia.documents import FieldError
from inertia.errors import GeometryError, UsageError, placed, require_kind
from inertia.records import dataclass

_GRAVEST = ("fail", "undecided", "conditional", "pass")
_FULL = 1e-6  # relative
_CONTRADICTED = 5.0  # standard uncertainties: by chance, a reading is farther off 4 times in a million


@dataclass(frozen=True, eq=False)
class MeasuredRun:
    """A run as the log has it.

    Attributes
    ----------
    id, time, remark : as the job has them
    mounted : (n,) kg m or kg, what was on the rotor beside itself
    readings : (channels,) complex where there are phases
    predicted : (channels,) what the runs before it said it would show; None where they could not
    unbalance : (n,) what the readings show, what was mounted included; None without phase
    """

    id: str
    time: str | None
    remark: str | None
    mounted: Complex
    readings: Complex
    predicted: Complex | None
    unbalance: Complex | None


@dataclass(frozen=True)
class MeasuredPlane:
    """A plane as it is now, and what to do there.

    Attributes
    ----------
    plane : its name and place
    unbalance : kg m or kg, the heavy spot
    uncertainty : standard, of the vector, in the direction in which it is largest; infinite where the readings do not
        bound it
    correction : what to add, of the least of the criterion within the limits
    pieces : the masses to mount, at their angles
    left : what they leave of the correction
    permissible : kg m; None where nothing says
    outcome : of this plane; None where nothing is permissible
    """

    plane: Plane
    unbalance: complex
    uncertainty: float
    correction: complex
    pieces: tuple[Piece, ...]
    left: complex
    permissible: float | None
    outcome: Outcome | None

    @property
    def expanded(self) -> float:
        """ΔU: twice the standard uncertainty, for about 95 %."""
        return COVERAGE * self.uncertainty


@dataclass(frozen=True, eq=False)
class Measurement:
    """What a job has come to.

    Attributes
    ----------
    job : as described
    runs : the log
    channels : what each run read
    planes : unbalance and correction of each
    estimate : what the runs say, with coefficients and uncertainties
    condition : of the coefficients; None without phase
    present, predicted : (channels,) what the machine shows now, and what it should show with the pieces mounted
    gap : of min-max, see `InfluenceCorrection`
    balance : of the rotor file, by the measured unbalance; None where the job names none, or where the readings do not
        bound it
    outcome : the verdict on the rotor as it is now; None where nothing says what is permissible
    why : the verdict in sentences
    notes : what else has to be known, in sentences
    """

    job: Job
    runs: tuple[MeasuredRun, ...]
    channels: tuple[Channel, ...]
    planes: tuple[MeasuredPlane, ...]
    estimate: Estimate
    condition: float | None
    present: Complex
    predicted: Complex
    gap: float
    balance: Balance | None
    outcome: Outcome | None
    why: tuple[str, ...]
    notes: tuple[str, ...]

    def _repr_html_(self) -> str:
        """Return a small table with the weights to mount, as a notebook shows it."""
        from inertia.notebook import html_of

        verdict = "nothing says what is permissible" if self.outcome is None else str(self.outcome)
        rows = [("Job", f"{self.job.name}: {verdict}"), ("Runs", str(len(self.runs)))]
        size, unit = (1e3, "g") if self.job.weighed_alone else (1 / GRAM_MILLIMETRE, "g·mm")
        digits = work_digits(self)
        for each in self.planes:
            angle = round(in_degrees(each.unbalance), 1) % 360.0
            unbalance = f"{size * abs(each.unbalance):.4g} {unit} at {angle:.1f}°"
            pieces = [
                f"{1e3 * piece.mass:.{max(3, digits.mass)}f} g at {math.degrees(piece.angle):.{max(1, digits.angle)}f}°"
                for piece in each.pieces
            ]
            rows.append((f"Plane {each.plane.id}", f"{unbalance}; mount {', '.join(pieces) or 'nothing'}"))
        return html_of([*rows, *(("Why", says) for says in self.why), *(("Note", note) for note in self.notes)])

    def coefficients(self) -> StoredCoefficients:
        """Return the influence coefficients as a file, for a later job; raise `UsageError` where there are none."""
        if self.estimate.coefficients is None or self.job.by_machine:
            raise UsageError(f"{self.job.name}: the method {self.job.fields.method!r} has no influence coefficients")
        return StoredCoefficients.of(self.job, self.estimate.coefficients, self.estimate.coefficient_uncertainty)


def work_digits(result: Measurement) -> ShopDigits:
    """Return the decimals that the work takes: that on the rotor file's bodies, or masses to mount."""
    if result.balance is not None:
        return shop_digits(result.balance, result.job.machine_angles)
    return together(
        mounting_digits(
            [(piece.mass, piece.angle) for piece in plane.pieces],
            None if plane.permissible is None else plane.permissible / result.job.per_mass(k),
        )
        for k, plane in enumerate(result.planes)
    )


def measure(job: Job, *, seconds: float | None = None, progress: Progress | None = None) -> Measurement:
    """Evaluate a balancing job.

    Parameters
    ----------
    job : what `Job.load` returned
    seconds : how long a plan of corrections of the rotor file is looked for; as that file says without it
    progress : called with the fraction done

    Raises
    ------
    ReadError : a file cannot be read
    UsageError : a field is not usable, or the runs do not tell the planes apart
    GeometryError : the readings do not tell the planes apart, or the rotor file's bodies give no honest answer

    >>> from importlib.resources import files
    >>> result = measure(Job.load(files("inertia_meshes") / "jobs" / "fan.toml"))
    >>> result.outcome, [round(1e6 * abs(plane.unbalance)) for plane in result.planes]
    ('pass', [68, 43])
    """
    require_kind(job, Job, "job", "inertia.Job.load(path)")
    try:
        return _measured(job, seconds, progress)
    except (UsageError, GeometryError) as error:
        raise placed(error, job.name) if job.name not in error.places else error from None


def _measured(job: Job, seconds: float | None, progress: Progress | None) -> Measurement:
    fields = job.fields
    stored = None
    if fields.coefficients is not None:
        stored = StoredCoefficients.load(job.folder / fields.coefficients).matrix(job)
    result = estimate(job, stored)
    correction = _correction(job, result)
    permissible = _permissible(job)
    places = explanations(job, result)
    vectors = within_limits(job, -result.unbalance) if correction is None else correction.unbalance
    pieces = pieces_of(job, result, correction, permissible) if result.bounded else [()] * len(job.planes)
    planes = tuple(
        _plane(job, k, places, complex(vectors[k]), pieces[k], permissible[k]) for k in range(len(job.planes))
    )
    predicted = _after(job, result, planes)
    notes = remarks(job, result, correction, stored is not None)
    for k, (plane, limit) in enumerate(zip(planes, job.fields.plane, strict=True)):
        if _limited(plane, limit) or (correction is not None and k in correction.limited):
            notes.append(f"plane {plane.plane.id} is at its limit of {limit.max_mass_g:g} g")
    if any(plane.pieces for plane in planes) and not _lower(job, predicted, result.present):
        planes = tuple(replace(plane, pieces=(), left=plane.correction) for plane in planes)
        predicted = result.present
        notes.append("no weights at these positions and steps lower the readings: none are proposed")
    mounted = any(plane.pieces for plane in planes)
    notes += on_places(job, places, [abs(complex(_after(job, k, planes)[0])) for k in places if mounted])
    rotor = None if job.rotor is None or not result.bounded else _balance(job, result, seconds, progress)
    outcome, why = _judged(job, places, planes, rotor)
    return Measurement(
        job=job,
        runs=_log(job, result, stored is not None or job.by_machine),
        channels=job.channels,
        planes=planes,
        estimate=result,
        condition=None if correction is None else correction.condition,
        present=result.present,
        predicted=predicted,
        gap=0.0 if correction is None else correction.gap,
        balance=rotor,
        outcome=outcome,
        why=why,
        notes=tuple(notes),
    )


def _correction(job: Job, result: Estimate) -> InfluenceCorrection | None:
    if result.coefficients is None:
        return None
    return influence_correction(
        result.present,
        result.coefficients,
        importance=job.importance,
        limits=limits_of(job),
        criterion=job.fields.criterion,
    )


def _after(job: Job, result: Estimate, planes: tuple[MeasuredPlane, ...]) -> Complex:
    """Return what the machine should show with the pieces mounted."""
    added = np.array([plane.correction - plane.left for plane in planes])
    if result.coefficients is None:
        return np.array([result.fits[0].sensitivity * abs(result.unbalance[0] + added[0]) + 0j])
    predicted: Complex = result.present + result.coefficients @ added
    return predicted


def _lower(job: Job, after: Complex, before: Complex) -> bool:
    """Return whether readings are lower by the criterion of the job."""
    order = np.inf if job.fields.criterion == "min-max" else 2
    root = np.sqrt(job.importance)
    return bool(np.linalg.norm(root * after, order) < np.linalg.norm(root * before, order))


def _plane(
    job: Job,
    number: int,
    places: Sequence[Estimate],
    correction: complex,
    pieces: tuple[Piece, ...],
    permissible: float | None,
) -> MeasuredPlane:
    outcome = None
    if permissible is not None:
        outcome = _agreed(
            accepted(abs(k.unbalance[number]), permissible, COVERAGE * k.uncertainty[number]) for k in places
        )
    return MeasuredPlane(
        job.planes[number],
        complex(places[0].unbalance[number]),
        float(places[0].uncertainty[number]),
        correction,
        pieces,
        correction - added_by(job, number, pieces),
        permissible,
        outcome,
    )


def _limited(plane: MeasuredPlane, fields: MeasuredPlaneFields) -> bool:
    """Return whether no step or weight more may be mounted in a plane."""
    if fields.max_mass_g is None or not plane.pieces:
        return False
    step = min((weight.mass_g for weight in fields.kit or ()), default=fields.mass_step_g)
    return 1e3 * math.fsum(piece.mass for piece in plane.pieces) + step > (1.0 - _FULL) * fields.max_mass_g


def _permissible(job: Job) -> list[float | None]:
    """Return what is permissible in each plane, kg m, where the job itself says so."""
    tolerance = job.fields.tolerance
    shared = None
    if tolerance.grade is not None and tolerance.mass is not None and tolerance.rpm is not None:
        shared = 1e-3 * tolerance.grade * tolerance.mass / angular_speed(tolerance.rpm) / len(job.planes)
    limits = []
    for k, plane in enumerate(job.fields.plane):
        limit = shared if plane.permissible_gmm is None else GRAM_MILLIMETRE * plane.permissible_gmm
        if limit is not None and job.weighed_alone:
            raise FieldError(f"plane[{k}].radius", "is missing: what is permissible is in g·mm, not in g")
        limits.append(limit)
    return limits


def _balance(job: Job, result: Estimate, seconds: float | None, progress: Progress | None) -> Balance:
    """Correct the rotor of the file by the measured unbalance."""
    assert job.rotor is not None
    rotor = job.rotor if seconds is None else job.rotor.planned_in(seconds)
    return balance(rotor, measured=_vectors(job, result), measured_spreads=_spreads(job, result), progress=progress)


def _vectors(job: Job, result: Estimate) -> list[tuple[float, complex, float]]:
    """Return the unbalance of each plane as `balance` takes what was measured; the estimate has its uncertainty."""
    return [
        (plane.z or 0.0, job.to_rotor(vector), 0.0)
        for plane, vector in zip(job.planes, result.unbalance.tolist(), strict=True)
    ]


def _spreads(job: Job, result: Estimate) -> list[Complex]:
    """Return what it is uncertain by, in the angles of the rotor file."""
    along, across = job.to_rotor(1.0), job.to_rotor(1j)
    return [moves.real * along + moves.imag * across for moves in result.spreads]


def _agreed(outcomes: Iterable[Outcome]) -> Outcome:
    """Return the outcome wherever the heavy spot is; undecided where that depends on it."""
    first, *others = outcomes
    return first if all(one == first for one in others) else "undecided"


def _judged(
    job: Job, places: Sequence[Estimate], planes: tuple[MeasuredPlane, ...], rotor: Balance | None
) -> tuple[Outcome | None, tuple[str, ...]]:
    """Judge the rotor; by several places of the heavy spot where these explain the readings alike."""
    result, outcomes = places[0], list[Outcome]()
    why: list[str] = []
    for k, plane in enumerate(planes):
        if plane.outcome is not None and plane.permissible is not None:
            outcomes.append(plane.outcome)
            sizes = [(abs(one.unbalance[k]), COVERAGE * float(one.uncertainty[k])) for one in places]
            said = _against(sizes, plane.permissible, GRAM_MILLIMETRE, "g·mm")
            why.append(f"plane {plane.plane.id}: {said} g·mm: {plane.outcome.upper()}")
    if rotor is not None:
        verdicts = [rotor.initial_verdict, *(_verdict_of(job, one, rotor) for one in places[1:])]
        outcomes.append(_agreed(verdict.outcome for verdict in verdicts))
        why += rotor.initial_verdict.why
        why += [f"at another place of the heavy spot: {says}" for verdict in verdicts[1:] for says in verdict.why]
    elif job.rotor is not None:
        outcomes.append("undecided")
        why.append("bearings: the readings do not bound the unbalance: UNDECIDED")
    greatest = job.fields.tolerance.vibration
    if greatest is not None and not job.by_machine:
        for k, channel in enumerate(job.channels):
            readings = [(float(abs(one.present[k])), _off(job, one, k)[0]) for one in places]
            outcomes.append(_agreed(accepted(reading, greatest, off) for reading, off in readings))
            said = _against(readings, greatest, 1.0, job.unit_of(channel), fewer=2)
            why.append(f"{channel}{_off(job, result, k)[1]}: {said}: {outcomes[-1].upper()}")
    if outcomes and (off := contradiction(job, result)) > _CONTRADICTED:
        outcomes.append("undecided")
        far = f"{off:.{1 if off < 10 else 0}f} standard uncertainties"
        why.insert(0, f"the runs contradict each other by {far}: nothing passes by them")
    return min(outcomes, key=_GRAVEST.index, default=None), tuple(why)


def _against(sizes: Sequence[tuple[float, float]], limit: float, per: float, unit: str, fewer: int = 0) -> str:
    """Return what may be there, each with its uncertainty, and the limit, without its unit, in words."""
    figures = [told_apart(size / per, off / per, limit / per, fewer) for size, off in sizes]
    known = (
        f"{size} ± {off} {unit}" if math.isfinite(float(off)) else f"{size} {unit}, which the readings do not bound,"
        for size, off, _ in figures
    )
    return f"{' or '.join(known)} against {max((figure[2] for figure in figures), key=len)}"


def _verdict_of(job: Job, result: Estimate, rotor: Balance) -> Verdict:
    """Judge the rotor of the file by another unbalance than the one that it was balanced by."""
    measured = as_measured(rotor.initial, _vectors(job, result), _spreads(job, result))
    return judge(measured, rotor.tolerance, rotor.tolerance_planes, rotor.rigid)


def _off(job: Job, result: Estimate, channel: int) -> tuple[float, str]:
    """Return by how much the present reading of a channel may be off, and in words what it is where it was not read.

    What a run shows is off by the half-width of its amplitude; what is calculated, by twice its standard uncertainty.
    """
    if not job.runouts[channel] and result.tooling is None and result.present[channel] in job.vibrations[:, channel]:
        read = float(abs(result.present[channel]))
        return math.hypot(float(job.half_widths[0][channel]) * read, float(job.noise[channel])), ""
    return COVERAGE * float(result.present_uncertainty[channel]), ", calculated"


def told_apart(size: float, uncertainty: float, permissible: float, fewer: int = 0) -> tuple[str, str, str]:
    """Return the three with so many digits, four or more, that what `accepted` says of them shows.

    The uncertainty has so many digits `fewer`.

    >>> told_apart(100.01, 0.0, 100.0), told_apart(19.5, 2.3094, 20.0)
    (('100.01', '0', '100'), ('19.5', '2.309', '20'))
    """
    outcome = accepted(size, permissible, uncertainty)
    for digits in range(4, 18):
        shown = f"{size:.{digits}g}", f"{uncertainty:.{digits - fewer}g}", f"{permissible:.{digits}g}"
        if accepted(float(shown[0]), float(shown[2]), float(shown[1])) == outcome:
            break
    return shown


def _log(job: Job, result: Estimate, known: bool) -> tuple[MeasuredRun, ...]:
    readings = job.vibrations if job.by_phase else job.amplitudes.astype(complex)
    runs, positions = [], positions_of(job)
    for k, run in enumerate(job.runs):
        unbalance = None
        if result.coefficients is not None:
            unbalance = -influence_correction(readings[k], result.coefficients, importance=job.importance).unbalance
        predicted = _predicted(readings[:k], result, result.mounted[: k + 1], positions[: k + 1], known)
        runs.append(MeasuredRun(run.id, run.time, run.remark, result.mounted[k], readings[k], predicted, unbalance))
    return tuple(runs)


def _predicted(before: Complex, result: Estimate, mounted: Complex, positions: Float, known: bool) -> Complex | None:
    """Return what a run should show by the runs before it: by one in its position, and coefficients that they give."""
    alike = np.flatnonzero(positions[:-1] == positions[-1])
    if result.coefficients is None or not len(alike):
        return None
    matrix = result.coefficients if known else fitted_coefficients(before, mounted[:-1], positions[:-1])
    if matrix is None:
        return None
    nearest = alike[np.argmin(np.abs(mounted[alike] - mounted[-1]).sum(axis=1))]
    turn = np.exp(1j * positions[-1])
    predicted: Complex = before[nearest] + turn * matrix @ (mounted[-1] - mounted[nearest])
    return predicted
