"""What to mount in each plane of a job: the least of its criterion, by masses that there are places and weights for."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from inertia.arrays import Float
from inertia.balancing.bounds import COVERAGE
from inertia.balancing.corrections.correction_plane import KitWeight
from inertia.balancing.measured.estimate import Estimate
from inertia.balancing.measured.influence import InfluenceCorrection
from inertia.balancing.measured.job import Job
from inertia.balancing.measured.positions import Piece, least_together, split_among
from inertia.balancing.unbalance import Complex

_AIM = (
    0.75  # of what is permissible beyond the uncertainty: what weights of a kit may leave of it, as plans of holes may
)
_UNSEEN = 0.5  # of the uncertainty: what weights may leave without adding more than an eighth to it
_TURNS = 10
_NEARER = 1e-6  # relative


def pieces_of(
    job: Job, result: Estimate, correction: InfluenceCorrection | None, permissible: Sequence[float | None]
) -> list[tuple[Piece, ...]]:
    """Return the masses to mount in each plane.

    Where a plane cannot have what its correction takes, the masses of all planes are found together. Those that are
    rounded to steps, or of a kit, are then chosen in turn, each the nearest to what is best beside the others, until
    none is nearer. By min-max, masses come nearest to the correction within the limits.

    Parameters
    ----------
    job, result : the readings, and what they say
    correction : by influence coefficients, within the limits; None without phase
    permissible : (n,) kg m, of each plane; None where nothing says
    """

    def of(plane: int, vector: complex) -> tuple[Piece, ...]:
        return _split(job, plane, vector, _enough(COVERAGE * float(result.uncertainty[plane]), permissible[plane]))

    planes = range(len(job.planes))
    if correction is None or result.coefficients is None:
        return [of(k, complex(-result.unbalance[k])) for k in planes]
    wanted = correction.unbalance
    reached = all(_reaches(job, k, complex(wanted[k])) for k in planes)
    coupled = job.fields.criterion == "min-max" and not job.by_machine
    if coupled or (reached and not correction.limited):
        return [of(k, complex(wanted[k])) for k in planes]
    if not reached:
        wanted = _together(job, result.present, result.coefficients)
    return _in_turn(job, result.present, result.coefficients, [of(k, complex(wanted[k])) for k in planes], of)


def limits_of(job: Job) -> Float:
    """Return the largest weight in each plane, (n,) kg m or kg."""
    masses = (math.inf if plane.max_mass_g is None else 1e-3 * plane.max_mass_g for plane in job.fields.plane)
    return np.array([mass * job.per_mass(k) for k, mass in enumerate(masses)])


def within_limits(job: Job, weights: Complex) -> Complex:
    """Return weights (n,) cut to the largest of each plane, in their direction."""
    sizes = np.abs(weights)
    cut: Complex = weights * np.minimum(1.0, np.divide(limits_of(job), sizes, out=np.ones_like(sizes), where=sizes > 0))
    return cut


def added_by(job: Job, plane: int, pieces: Sequence[Piece]) -> complex:
    """Return what masses in a plane add to its unbalance, kg m or kg."""
    return sum((piece.vector for piece in pieces), 0j) * job.per_mass(plane)


def _together(job: Job, present: Complex, matrix: Complex) -> Complex:
    """Return the weights of all planes that masses at their positions and within their limits leave least by."""
    planes, root = job.fields.plane, np.sqrt(job.importance)
    per_mass = np.array([job.per_mass(k) for k in range(len(planes))])
    places = [None if k.positions is None else np.radians(k.positions).tolist() for k in planes]
    most = np.array([math.inf if k.position_max_g is None else 1e-3 * k.position_max_g for k in planes])
    effects, in_all = root[:, None] * matrix * per_mass, limits_of(job) / per_mass
    weights: Complex = per_mass * least_together(root * present, effects, places, most, in_all)
    return weights


def _in_turn(
    job: Job,
    present: Complex,
    matrix: Complex,
    pieces: list[tuple[Piece, ...]],
    of: Callable[[int, complex], tuple[Piece, ...]],
) -> list[tuple[Piece, ...]]:
    """Choose the masses of each plane anew, the others given, as long as that leaves less; those of kits once."""
    planes = range(len(pieces))
    rows = job.importance[:, None] * matrix.conj()
    added = np.array([added_by(job, k, pieces[k]) for k in planes])
    for turn in range(_TURNS):
        settled = True
        for k in planes:
            if turn and job.fields.plane[k].kit:
                continue
            others = present + matrix @ np.where(np.arange(len(added)) == k, 0.0, added)
            wanted = complex(-(rows[:, k] @ others) / (rows[:, k] @ matrix[:, k]))
            tried = of(k, wanted)
            if abs(added_by(job, k, tried) - wanted) < (1.0 - _NEARER) * abs(added[k] - wanted):
                pieces[k], added[k], settled = tried, added_by(job, k, tried), False
        if settled:
            break
    return pieces


def _reaches(job: Job, plane: int, vector: complex) -> bool:
    """Return whether masses of any size at the positions of a plane, within its limits, make a vector."""
    off = added_by(job, plane, _split(job, plane, vector, None)) - vector
    return abs(off) <= _NEARER * abs(vector)


def _split(job: Job, plane: int, vector: complex, enough: float | None) -> tuple[Piece, ...]:
    """Return masses that come near to a vector, kg m or kg, in a plane; None is enough without steps and kits."""
    fields, per_mass = job.fields.plane[plane], job.per_mass(plane)
    if job.by_machine and job.planes[plane].radius is None:
        return ()
    kit = [KitWeight(k.name or f"{k.mass_g:g} g", 1e-3 * k.mass_g, k.stock) for k in fields.kit or ()]
    return split_among(
        vector / per_mass,
        None if fields.positions is None else [math.radians(angle) for angle in fields.positions],
        most=math.inf if fields.position_max_g is None else 1e-3 * fields.position_max_g,
        most_in_all=math.inf if fields.max_mass_g is None else 1e-3 * fields.max_mass_g,
        step=0.0 if enough is None else 1e-3 * fields.mass_step_g,
        kit=() if enough is None else kit,
        most_pieces=fields.most_per_position,
        enough=(enough or 0.0) / per_mass,
    )


def _enough(expanded: float, permissible: float | None) -> float:
    """Return what weights of a kit may leave of a correction: to leave less takes more of them, and shows nowhere."""
    if not math.isfinite(expanded):
        return 0.0
    if permissible is None:
        return _UNSEEN * expanded
    return min(_AIM * permissible, max(_UNSEEN * expanded, _AIM * (permissible - expanded)))
