"""The unbalance that the runs of a job show, with its standard uncertainty.

The readings of every run are V = A (u + w), with u the rotor's unbalance at the start and w what is mounted. Runs with
different weights give A by least squares; u is from what was read last with nothing on the rotor but what stays, the
mean of the runs that repeat it one after the other. Stored coefficients, or a balancing machine, whose A is one, give u
from the last run alone, as an error that runs have in common does not cancel there. Without phase see
`inertia.balancing.measured.amplitudes`; where the rotor was turned by θ on its tooling, V = A (T + e^{iθ} (u + w)), and
`inertia.balancing.measured.index_balancing` tells the two apart.

Half-widths a of readings, their runout and weights count as standard uncertainties a/√3 and are carried through the
whole calculation numerically, one after the other (JCGM 100:2008, 4.3.7 and note 2 to 5.1.3): a weight by a small part
of its own, as the coefficients are a quotient by what the weights of a run come to, which may be less than they are
uncertain by. What is stated of readings is of those that were read, with their runout.

That is of first order, and the unbalance is a quotient: with errors δA of the coefficients, an estimate is off by
d = (1 + N)⁻¹ e, with e the error of first order and N = A⁺ δA. The confidence region of a quotient is wider by that,
and has no bound at all once N may be 1 (Fieller, E. C. (1954), J. R. Stat. Soc. B 16(2), 175-185): a trial weight whose
effect drowns in the noise says nothing of the unbalance, however small the quotient came out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np

from inertia.arrays import Float
from inertia.balancing.bounds import COVERAGE, worst_direction
from inertia.balancing.measured.amplitudes import AmplitudeFit, amplitude_balance
from inertia.balancing.measured.index_balancing import index_balancing
from inertia.balancing.measured.influence import influence_correction
from inertia.balancing.measured.job import Job
from inertia.balancing.measured.readings import complex_of
from inertia.balancing.measured.trial_weights import unbalance_for_weight
from inertia.balancing.shop_units import angular_speed
from inertia.balancing.unbalance import Complex
from inertia.errors import GeometryError, UsageError
from inertia.records import dataclass

_RECTANGLE = math.sqrt(3.0)
_SAME = 1e-9  # of the largest weight: what is mounted in two runs is the same; of all that cancel, what is left is none
_PART = 1e-4  # of the uncertainty of a weight: what it is moved by
_SINGULAR = 1e10
_SAME_FIT = 0.02  # misfit, relative, up to which a second place without phase counts as one too
_SEEN = 2.6  # standard uncertainties by which an effect has to be more than its noise comes to, √(2 d) of d complex
# readings: √(2 d) + 2.6 is passed by noise alone 3 times in 10 000 (a quantile of χ, within 2 % from d = 1 to 40)


@dataclass(frozen=True, eq=False)
class Estimate:
    """What the runs say.

    Attributes
    ----------
    mounted : (runs, n) kg m or kg, what is on the rotor in each run beside itself
    remaining : (n,) what of it stays on after the last run
    coefficients : (channels, n) vibration per unit of weight; None without phase
    coefficient_uncertainty : (channels, n) standard
    unbalance : (n,) the heavy spots as the rotor is now, with what stays on it
    moves : (m, n) what each of m inputs, moved by its standard uncertainty, does to it, of first order
    coefficient_noise : (m, n, n) the same of A⁺ δA, what errors of the coefficients make of an unbalance in one plane
        (column) in another (row), relative; infinite where the readings may as well have no answer
    present : (channels,) what the machine would show now
    present_uncertainty : (channels,) standard, in the direction in which it is largest
    residuals : (runs, channels) what neither weights nor the rest that all runs have in common explain of the readings
    residual_uncertainty : (runs, channels) standard, in the direction in which it is largest
    tooling : (n,) of indexed runs, what belongs to the tooling; None without them
    fits : without phase, the unbalances at the start that explain the amplitudes, the best first, of as good ones the
        smaller
    """

    mounted: Complex
    remaining: Complex
    coefficients: Complex | None
    coefficient_uncertainty: Float
    unbalance: Complex
    moves: Complex
    coefficient_noise: Complex
    present: Complex
    present_uncertainty: Float
    residuals: Complex
    residual_uncertainty: Float
    tooling: Complex | None
    fits: tuple[AmplitudeFit, ...]

    @property
    def elsewhere(self) -> tuple[AmplitudeFit, ...]:
        """Fits beside the first that explain the amplitudes as well, farther from it than it is uncertain."""
        if len(self.fits) < 2:
            return ()
        as_well, apart = max(_SAME_FIT, 3.0 * self.fits[0].misfit), COVERAGE * float(self.uncertainty[0])
        return tuple(
            fit
            for fit in self.fits[1:]
            if fit.misfit <= as_well and abs(fit.unbalance - self.fits[0].unbalance) > apart
        )

    @property
    def bounded(self) -> bool:
        """Whether the coefficients are known well enough to bound the unbalance; noise alone is not."""
        if not np.isfinite(self.coefficient_noise).all():
            return False
        squares = worst_direction(self.coefficient_noise) ** 2
        largest = float(np.abs(np.linalg.eigvals(squares)).max(initial=0.0))
        return math.sqrt(largest) * (math.sqrt(2.0 * (1 + self._spare)) + _SEEN) <= 1.0

    @property
    def _spare(self) -> int:
        """Readings of a run beyond those that the planes take."""
        return len(self.present) - len(self.unbalance)

    @property
    def uncertainty(self) -> Float:
        """Standard uncertainty (n,) of each plane's vector in the direction in which it is largest; or infinite.

        With k the coverage, s of first order and S the noise of the coefficients, an unbalance u is off by no more than
        d = k s + C |u| with |u| ≤ |û| + d, so that d = (1 − C)⁻¹ (k s + C |û|). C is k² S², and 2 S² for each reading
        beyond those that the planes take: noise there makes the squares of coefficients larger, and û smaller.
        """
        first = worst_direction(self.moves)
        if not self.bounded:
            return np.full(len(first), math.inf)
        second = (COVERAGE**2 + 2.0 * self._spare) * worst_direction(self.coefficient_noise) ** 2
        off = np.linalg.solve(np.eye(len(first)) - second, COVERAGE * first + second @ np.abs(self.unbalance))
        return np.asarray(off / COVERAGE, dtype=np.float64)

    @property
    def spreads(self) -> tuple[Complex, ...]:
        """What the unbalance of all planes together is uncertain by, where it is bounded.

        Sets (m, n) of what the standard deviation of each of m numbers does to the planes at once. Of what p = Σ wₖ uₖ
        is uncertain by, those of a set are added in squares and sets as they are: the inputs, of first order, and for
        each plane what noise of the coefficients makes elsewhere of the error d of its unbalance. With errors δV, δA
        of readings and coefficients and Â as found, d = Â⁺ (δV − δA u) holds exactly: p is off by no more than
        k s(w Â⁺ (δV − δA û)) + Σⱼ k s(w Â⁺ δAⱼ) |dⱼ|. In a single plane d is all of it.
        """
        off, found = self.uncertainty, np.abs(self.unbalance)
        first = worst_direction(self.moves)
        if len(off) == 1:
            return (self.moves * np.divide(off, first, out=np.ones(1), where=first > 0),)
        own = worst_direction(np.diagonal(self.coefficient_noise, axis1=1, axis2=2))
        # With readings to spare, noise makes the squares of the coefficients larger, see `uncertainty`.
        reach = COVERAGE * off + 2.0 * self._spare / COVERAGE * own * (found + COVERAGE * off)
        return (self.moves, *np.moveaxis(self.coefficient_noise * reach, 2, 0))


@dataclass(frozen=True, eq=False)
class _Inputs:
    """What the calculation starts from: readings (runs, channels), weights (entries,), coefficients of their own."""

    readings: Complex
    weights: Complex
    stored: Complex | None


def explanations(job: Job, result: Estimate) -> tuple[Estimate, ...]:
    """Return an estimate, and the same for each further place of the heavy spot that explains the readings as well."""
    return (result, *(estimate(job, near=replace(result, fits=(fit,))) for fit in result.elsewhere))


def estimate(job: Job, stored: tuple[Complex, Float] | None = None, near: Estimate | None = None) -> Estimate:
    """Return the unbalance that a job's runs show.

    Parameters
    ----------
    job : as it is
    stored : coefficients (channels, n) of an earlier job, and their standard uncertainties
    near : of several places that explain amplitudes, that nearest to its own; the first without it

    Raises `UsageError` where the runs do not tell the planes apart, `GeometryError` where the readings do not.
    """
    matrix, errors = (None, None) if stored is None else stored
    if job.by_machine:
        matrix = np.eye(len(job.planes), dtype=complex)
    readings = job.vibrations if job.by_phase else job.amplitudes.astype(complex)
    inputs = _Inputs(readings, complex_of([weight for _, _, weight, _ in job.weights], "weights"), matrix)
    nominal = _calculated(job, inputs, near)
    try:
        parts = [
            (_parts(_calculated(job, up, nominal)) - _parts(_calculated(job, down, nominal))) / (2.0 * part)
            for up, down, part in _moved(job, inputs, errors)
        ]
    except GeometryError:
        if job.by_phase:
            raise
        # Within their uncertainties, the amplitudes may have no answer at all.
        return replace(
            nominal,
            coefficient_noise=np.full((1, 1, 1), math.inf + 0j),
            present_uncertainty=np.full_like(nominal.present_uncertainty, math.inf),
            residual_uncertainty=np.full_like(nominal.residual_uncertainty, math.inf),
        )
    planes, (runs, channels) = len(job.planes), readings.shape
    moves = np.array(parts).reshape(len(parts), len(_parts(nominal)))
    unbalance, present, residuals, effect = np.split(
        moves, np.cumsum([planes, channels, runs * channels]).tolist(), axis=1
    )
    answer = replace(
        nominal,
        moves=unbalance,
        present_uncertainty=worst_direction(present),
        residual_uncertainty=worst_direction(residuals).reshape(runs, channels),
    )
    if nominal.coefficients is None:
        # u is the quotient of a² u and a², which the squares of the amplitudes give: of a, the sensitivity, twice.
        noise = 2.0 * effect[:, :, None] / nominal.fits[0].sensitivity
    else:
        changes = effect.reshape(len(parts), channels, planes)
        answer = replace(answer, coefficient_uncertainty=np.sqrt((np.abs(changes) ** 2).sum(axis=0) / 2.0))
        root = np.sqrt(job.importance)[:, None]
        noise = np.linalg.pinv(root * nominal.coefficients) @ (root * changes)
    return replace(answer, coefficient_noise=noise)


def _parts(answer: Estimate) -> Complex:
    """Return what uncertainty is carried to: unbalance, present readings, residuals, coefficients or sensitivity."""
    last = np.array([answer.fits[0].sensitivity + 0j]) if answer.coefficients is None else answer.coefficients.ravel()
    return np.concatenate([answer.unbalance, answer.present, answer.residuals.ravel(), last])


def reading_moves(job: Job, as_read: Complex) -> Complex:
    """Return the standard uncertainties (2, ..., channels) of readings (..., channels), along them and across."""
    amplitudes, phases = job.half_widths
    sizes: Float = np.abs(as_read)
    toward: Complex = np.divide(as_read, sizes, out=np.ones_like(as_read), where=sizes > 0)
    across = np.hypot(phases * sizes, job.noise) if job.by_phase else 0.0 * sizes
    moves: Complex = np.stack([np.hypot(amplitudes * sizes, job.noise) * toward, 1j * across * toward]) / _RECTANGLE
    return moves


def _moved(job: Job, inputs: _Inputs, errors: Float | None) -> Iterator[tuple[_Inputs, _Inputs, float]]:
    """Yield the inputs with each of them moved up and down, and by what part of its standard uncertainty."""

    def pair(
        name: str, index: tuple[int | slice | list[int], ...], move: complex, part: float = 1.0
    ) -> tuple[_Inputs, _Inputs, float]:
        both = []
        for sign in (part, -part):
            array = getattr(inputs, name).copy()
            array[index] += sign * move
            both.append(replace(inputs, **{name: array}))
        return both[0], both[1], part

    moves = reading_moves(job, inputs.readings + job.runouts)
    for side, run, k in np.argwhere(moves).tolist():
        yield pair("readings", (run, k), moves[side, run, k])
    sensors = [channel.sensor for channel in job.channels]
    for runout in (sensor.id for sensor in job.fields.sensor if sensor.runout is not None and sensor.id in sensors):
        # It is read once, and taken off all readings of its sensor.
        here = [k for k, sensor in enumerate(sensors) if sensor == runout]
        for move in reading_moves(job, job.runouts)[:, here[0]].tolist():
            yield pair("readings", (slice(None), here), move)
    stated = job.fields.uncertainty
    for k, weight in enumerate(inputs.weights.tolist()):
        for move in (weight * stated.mass, 1j * weight * math.radians(stated.angle)):
            if move:
                yield pair("weights", (k,), move / _RECTANGLE, _PART)
    if errors is not None:
        for channel, plane in np.argwhere(errors > 0).tolist():
            for move in (errors[channel, plane], 1j * errors[channel, plane]):
                yield pair("stored", (channel, plane), move)


def _calculated(job: Job, inputs: _Inputs, near: Estimate | None = None) -> Estimate:
    """Return the answer from inputs, without its uncertainty; of several, that near another."""
    mounted, remaining = mounted_weights(job, inputs.weights)
    planes = len(job.planes)
    answer = Estimate(
        mounted=mounted,
        remaining=remaining,
        coefficients=None,
        coefficient_uncertainty=np.zeros((0, planes)),
        unbalance=np.zeros(planes, complex),
        moves=np.zeros((0, planes), complex),
        coefficient_noise=np.zeros((0, planes, planes), complex),
        present=inputs.readings[-1],
        present_uncertainty=np.zeros(len(inputs.readings[0])),
        residuals=np.zeros_like(inputs.readings),
        residual_uncertainty=np.zeros(inputs.readings.shape),
        tooling=None,
        fits=(),
    )
    if not job.by_phase:
        fits = amplitude_balance(inputs.readings[:, 0].real, mounted[:, 0])
        if near is not None:
            fits = (min(fits, key=lambda fit: abs(fit.unbalance - near.fits[0].unbalance)),)
        now = fits[0].unbalance + remaining[0]
        return replace(
            answer,
            unbalance=np.array([now]),
            present=np.array([fits[0].sensitivity * abs(now) + 0j]),
            residuals=inputs.readings - fits[0].sensitivity * np.abs(fits[0].unbalance + mounted),
            fits=fits,
        )
    positions = positions_of(job)
    turned = _turned(mounted, positions)
    matrix = _fitted(job, inputs.readings, mounted) if inputs.stored is None else inputs.stored
    present = _present(inputs.readings, mounted, remaining, matrix, inputs.stored is None)
    residuals = _unlike(inputs.readings - turned @ matrix.T, positions)
    answer = replace(answer, coefficients=matrix, present=present, residuals=residuals)
    if positions.any():
        return _indexed(job, inputs, answer, matrix)
    return replace(answer, unbalance=_solved(job, matrix, present))


def _indexed(job: Job, inputs: _Inputs, answer: Estimate, matrix: Complex) -> Estimate:
    """Tell the rotor's unbalance from that of its tooling; weights turn with the rotor."""
    positions = positions_of(job)
    shown = np.array([_solved(job, matrix, row) for row in inputs.readings]) - _turned(answer.mounted, positions)
    split = index_balancing(shown, positions)
    unbalance = split.rotor + answer.remaining
    return replace(answer, unbalance=unbalance, present=matrix @ unbalance, tooling=split.tooling)


def positions_of(job: Job) -> Float:
    """Return by how much the rotor was turned on its tooling in each run, (runs,) rad."""
    return np.radians([run.indexed for run in job.runs])


def _turned(mounted: Complex, positions: Float) -> Complex:
    """Return weights (runs, n), which turn with the rotor, in the tooling's angles."""
    turned: Complex = mounted * np.exp(1j * positions)[:, None]
    return turned


def _unlike(values: Complex, positions: Float) -> Complex:
    """Return values (runs, k) less what all runs have in common, of the tooling and of the rotor that turns on it."""
    common, inverse = _common(tuple(positions.tolist()))
    rest: Complex = values - common @ (inverse @ values)
    return rest


@lru_cache(maxsize=8)
def _common(positions: tuple[float, ...]) -> tuple[Complex, Complex]:
    """Return what all runs have in common (runs, 2), and its pseudo-inverse."""
    common: Complex = np.stack([np.ones(len(positions)), np.exp(1j * np.array(positions))], axis=1)
    inverse = np.asarray(np.linalg.pinv(common, rcond=_SAME), complex)
    return common, inverse


def mounted_weights(job: Job, weights: Complex) -> tuple[Complex, Complex]:
    """Return what is on the rotor in each run (runs, n), and what stays on it after the last (n,).

    Weights that cancel are none, whatever rounding leaves of them.
    """
    remaining = np.zeros(len(job.planes), complex)
    mounted = np.zeros((len(job.runs), len(job.planes)), complex)
    entries = list(zip(job.weights, weights.tolist(), strict=True))
    stayed = np.zeros(len(job.planes))
    for run in range(len(job.runs)):
        mounted[run], sizes = remaining, stayed.copy()
        for (number, plane, _, stays), weight in entries:
            if number == run:
                mounted[run, plane] += weight
                sizes[plane] += abs(weight)
                if stays:
                    remaining[plane] += weight
                    stayed[plane] += abs(weight)
        mounted[run, np.abs(mounted[run]) <= _SAME * sizes] = 0.0
    remaining[np.abs(remaining) <= _SAME * stayed] = 0.0
    return mounted, remaining


def fitted_coefficients(readings: Complex, mounted: Complex, positions: Float) -> Complex | None:
    """Return the coefficients (channels, n) of runs by least squares, None where the runs do not tell them.

    V = b + e^{iθ} (r + A w): what the tooling and the rotor show, b and r, is as unknown as A, and the first readings
    are not known any better than the others.

    Parameters
    ----------
    readings : (runs, channels)
    mounted : (runs, n)
    positions : (runs,) rad, by which the rotor was turned on its tooling
    """
    turned = _turned(mounted, positions)
    rows = _unlike(turned, positions)
    sizes = np.linalg.norm(rows, axis=0)
    if (sizes <= _SAME * np.linalg.norm(turned, axis=0)).any() or _condition(rows / sizes) > _SINGULAR:
        return None
    return complex_of(np.linalg.lstsq(rows, _unlike(readings, positions), rcond=None)[0].T, "coefficients")


def _fitted(job: Job, readings: Complex, mounted: Complex) -> Complex:
    positions = positions_of(job)
    matrix = fitted_coefficients(readings, mounted, positions)
    if matrix is None:
        planes = _counted(mounted.shape[1], "plane")
        also = ", which have to tell rotor and tooling apart too," if positions.any() else ""
        raise UsageError(
            f"{_counted(len(mounted), 'run')}{also} cannot tell what a weight does in {planes}: mount a trial weight "
            f"in every plane, in runs that are not multiples of each other, or name a file of coefficients{_trial(job)}"
        )
    effects = np.abs(matrix).max(axis=0) * np.abs(mounted).max(axis=0)
    without = np.flatnonzero(effects <= _SAME * float(np.abs(readings).max(initial=0.0)))
    if len(without):
        names = ", ".join(repr(job.planes[k].id) for k in without.tolist())
        raise GeometryError(
            f"the weights in plane {names} change no reading but by rounding, so that nothing follows from them: mount "
            f"larger ones, or check that the readings are those of different runs{_trial(job)}"
        )
    return matrix


def _trial(job: Job) -> str:
    """Return how large a trial weight should be, where the rotor's mass and speed are known."""
    mass, rpm = job.fields.tolerance.mass, job.channels[0].rpm
    if mass is None or rpm is None or job.weighed_alone:
        return ""
    unbalance = unbalance_for_weight(mass / len(job.planes), angular_speed(rpm))
    masses = ", ".join(f"{1e3 * unbalance / job.per_mass(k):.3g} g in {plane.id}" for k, plane in enumerate(job.planes))
    return f"; a tenth of the weight as force is {masses}"


def _counted(number: int, noun: str) -> str:
    return f"one {noun}" if number == 1 else f"{number} {noun}s"


def _present(readings: Complex, mounted: Complex, remaining: Complex, matrix: Complex, repeats: bool) -> Complex:
    """Return the readings of the last run with only on the rotor what stays there, or what they come to then.

    Where repeats count, it is the mean of all such runs that nothing else was between.
    """
    largest = float(np.abs(mounted).max(initial=0.0))
    same = np.flatnonzero(np.abs(mounted - remaining).max(axis=1) <= _SAME * largest)
    if not len(same):
        return complex_of(readings[-1] + matrix @ (remaining - mounted[-1]), "readings")
    last = np.split(same, np.flatnonzero(np.diff(same) > 1) + 1)[-1] if repeats else same[-1:]
    return complex_of(readings[last].mean(axis=0), "readings")


def _solved(job: Job, matrix: Complex, readings: Complex) -> Complex:
    """Return the unbalance that readings come from, by least squares."""
    if len(readings) < matrix.shape[1]:
        raise GeometryError(
            f"{len(readings)} readings a run do not tell {matrix.shape[1]} planes apart: measure at as many sensors "
            "and speeds as there are planes"
        )
    return -influence_correction(readings, matrix, importance=job.importance).unbalance


def _condition(matrix: Complex) -> float:
    if matrix.shape[0] < matrix.shape[1]:
        return math.inf
    singular = np.linalg.svd(matrix, compute_uv=False)
    return float(singular[0] / singular[-1]) if singular[-1] else math.inf
