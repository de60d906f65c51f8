"""Permissible residual unbalance of a rotor in its bearing planes, by ISO 21940-11, API, MIL-STD-167-1 or forces."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

import numpy as np

from inertia.arrays import Float
from inertia.balancing.bounds import Source
from inertia.balancing.forces import carried_masses
from inertia.balancing.unbalance import Unbalance, plane_weights
from inertia.errors import UsageError
from inertia.records import dataclass

GRADES: dict[float, tuple[str, ...]] = {
    4000.0: ("crank drives of large slow marine diesel engines, inherently unbalanced",),
    1600.0: ("crank drives of large slow marine diesel engines, inherently balanced",),
    630.0: ("crank drives, inherently unbalanced, on elastic mounts",),
    250.0: ("crank drives, inherently unbalanced, on rigid mounts",),
    100.0: ("complete reciprocating engines of cars, trucks and locomotives",),
    40.0: ("car wheels and rims", "drive shafts of cars", "crank drives, inherently balanced, on elastic mounts"),
    16.0: (
        "agricultural machinery",
        "crushing machines",
        "cardan and propeller shafts",
        "crank drives, inherently balanced, on rigid mounts",
    ),
    6.3: (
        "fans",
        "pumps",
        "gears",
        "general machinery",
        "machine tools",
        "paper and process plant machines",
        "centrifuges",
        "water turbines",
        "turbochargers",
        "aircraft gas turbines",
        "electric motors and generators up to 950 r/min, or with shaft heights below 80 mm",
    ),
    2.5: (
        "compressors",
        "gas turbines and steam turbines",
        "electric motors and generators above 950 r/min, with shaft heights from 80 mm",
        "machine-tool drives",
        "textile machines",
        "computer drives",
    ),
    1.0: ("grinding machine drives", "audio and video drives"),
    0.4: ("gyroscopes", "spindles and drives of high-precision systems"),
}
"""The balance quality grades G, mm/s, of ISO 21940-11, table 1, and the machines that they are meant for."""

MIL_REVISIONS = ("MIL-STD-167-1", "MIL-STD-167-1A")
"""Of 1974, with limits of its own, and of 2005, which takes a balance quality grade from the contract."""

_INBOARD, _OVERHUNG = (0.3, 0.7), (0.3, 1.3)
_FOUR_W_OVER_N = 6.35e-3  # m r/min: 4 oz·in per lb, which are 6350 g·mm per kg, over N
_API_617_FAST, _API_617_LEAST = 25_000.0, 1e-6 / 3.937  # r/min, from which on it allows this, m
_MIL_SLOW = 0.177 * 1.5875e-3  # m: 0.177 oz·in per lb
_LEFT = 1e-3  # of a limit: as small as it is taken to get by the mass that is uncertain


@dataclass(frozen=True)
class Share:
    """The part of the total that a tolerance plane is allowed.

    Attributes
    ----------
    allocated : by the lever rule, of the total
    used : the same, kept within the limits
    limits : (least, most)
    """

    allocated: float
    used: float
    limits: tuple[float, float]

    @property
    def clamped(self) -> bool:
        """Whether the limits changed it."""
        return self.allocated != self.used


Planes = tuple[float, float]


@dataclass(frozen=True)
class MassLaw:
    """How limits follow the mass: U_k = e m c_k, with c_k the share of m that plane k carries, kept within limits.

    Attributes
    ----------
    specific : e, m
    mass, z : kg and m, of the rotor that the limits are for and of its centre of mass
    planes : (A, B) m
    kept : (least, most) of c_k: both 1 where each plane is allowed the same by the whole mass, 0 and inf where the
        journal's load counts as it is
    """

    specific: float
    mass: float
    z: float
    planes: Planes
    kept: tuple[float, float]

    def permissible(self, mass: Float, moment: Float, z: float) -> Float:
        """Return the limits (2, n) kg m where the mass is another.

        Parameters
        ----------
        mass, moment : (n,) kg and kg m, the change of the mass and of its first moment about the plane z
        z : m
        """
        at_a, at_b = self.planes
        total = self.mass + mass
        on_b = (self.mass * (self.z - at_a) + moment + mass * (z - at_a)) / (at_b - at_a)
        limits: Float = self.specific * np.clip(
            np.abs(np.stack([total - on_b, on_b])), self.kept[0] * total, self.kept[1] * total
        )
        return limits

    def rates(self, rotor: Unbalance) -> tuple[list[tuple[float, float]], ...]:
        """Return for each plane what its limit changes by with the mass, m, and with its first moment, a number.

        Two pairs where the share is kept by its limits, or is not, within what is uncertain: a change then lies between
        what the two say.

        Parameters
        ----------
        rotor : whose uncertainties count; first moments are about its centre of mass
        """
        at_a, at_b = self.planes
        lever = (rotor.z - at_a) / (at_b - at_a)
        per_moment = 1.0 / (at_b - at_a)
        each = []
        for carried, rate in zip(
            carried_masses(self.mass, self.z, at_a, at_b),
            ((1.0 - lever, -per_moment), (lever, per_moment)),
            strict=True,
        ):
            sign, share = math.copysign(1.0, carried), abs(carried) / self.mass
            loose = sign * rate[0], sign * rate[1]
            moved = _changes(rotor, (loose[0] - share, loose[1])) / max(
                self.mass - _changes(rotor, (1.0, 0.0)), _LEFT * self.mass
            )
            low, high = share - moved, share + moved
            slopes = [(self.kept[0], 0.0)] if low <= self.kept[0] else []
            slopes += [(self.kept[1], 0.0)] if high >= self.kept[1] else []
            if low < self.kept[1] and high > self.kept[0]:
                slopes.append(loose)
            each.append([(self.specific * m, self.specific * s) for m, s in slopes])
        return tuple(each)


def _changes(rotor: Unbalance, rates: tuple[float, float]) -> float:
    """Return how far what follows the mass and its first moment at these rates may change."""
    return math.fsum(k.bound(0.0, 0.0, 1.0, rates) for k in rotor.uncertainties)


@dataclass(frozen=True)
class Tolerance:
    """Permissible residual unbalance in tolerance planes A and B.

    Attributes
    ----------
    standard : with its edition or grade
    rule : how the figures come about, in words
    permissible : (A, B) kg m; the magnitude counts, whatever the angle
    total : kg m, where the standard has one
    shares : (A, B) of the total, where there is one
    meant_for : machines that the grade or category is meant for
    undecided : why these limits decide nothing, where they do not
    law : how the limits follow the mass; None where they do not
    """

    standard: str
    rule: str
    permissible: tuple[float, float]
    total: float | None = None
    shares: tuple[Share, Share] | None = None
    meant_for: tuple[str, ...] = ()
    undecided: str | None = None
    law: MassLaw | None = None

    def apart(self, rotor: Unbalance, planes: Planes) -> list[tuple[float, float]]:
        """Return how far each source of uncertainty may move the vectors in both planes beside their limits, kg m.

        With a change a of the vector V, and l of its limit L, |V + a|/(L + l) is off |V|/L by |a − V l/L|/(L + l) at
        most: what vector and limit are both in proportion to does nothing. The sum over all sources, with the least
        that all of them together leave of L in the denominator, times L, is the bound.

        Parameters
        ----------
        rotor : an unbalance of the rotor that the limits are for, with its uncertainties
        planes : (A, B) m
        """
        weights = [(float(p), float(q)) for p, q in zip(*plane_weights(rotor.z, planes), strict=True)]
        if self.law is None or min(self.permissible) <= 0:
            a, b = ([k.bound(*weight) for k in rotor.uncertainties] for weight in weights)
            return list(zip(a, b, strict=True))
        columns = []
        for (p, q), vector, limit, slopes in zip(
            weights, rotor.in_planes(*planes), self.permissible, self.law.rates(rotor), strict=True
        ):
            share = vector / limit
            least = max(limit - max(_changes(rotor, rates) for rates in slopes), _LEFT * limit)
            ways = [[k.bound(p, q, share, rates) for k in rotor.uncertainties] for rates in slopes]
            columns.append([limit / least * size for size in max(ways, key=math.fsum)])
        return list(zip(*columns, strict=True))

    def bounds(self, rotor: Unbalance, planes: Planes) -> tuple[dict[Source, float], dict[Source, float]]:
        """Return for planes A and B how far the vector may be off beside its limit, kg m, by source: see `apart`."""
        a: dict[Source, float] = {}
        b: dict[Source, float] = {}
        for uncertainty, sizes in zip(rotor.uncertainties, self.apart(rotor, planes), strict=True):
            for totals, size in zip((a, b), sizes, strict=True):
                totals[uncertainty.source] = totals.get(uncertainty.source, 0.0) + size
        return a, b


def iso_21940_11(
    grade: float, rotor: Unbalance, planes: Planes, speed: float, overhung: bool | None = None
) -> Tolerance:
    """Return the tolerance of a balance quality grade: U_per = G m/ω.

    Parameters
    ----------
    grade : G, mm/s, one of `GRADES`, or of a contract
    rotor : its mass and its centre of mass count
    planes : (A, B) m, the bearings
    speed : rad/s, highest in service
    overhung : see `allocate`

    Raises `UsageError` for a grade or a speed that is not positive.

    >>> rotor = Unbalance(3600.0, 1.5, 0.0, 0.0)
    >>> [round(1e6 * u) for u in iso_21940_11(2.5, rotor, (0.0, 2.4), 100 * math.pi).permissible]
    [10743, 17905]
    """
    total = 1e-3 * _positive(grade, "the grade", "mm/s") * rotor.mass / _positive(speed, "the speed", "rad/s")
    name = f"ISO 21940-11:2016, G{grade:g}" + ("" if grade in GRADES else " by contract, not in its table")
    limits = _allocated(name, "U_per = G m/ω", total, rotor, planes, overhung)
    return replace(limits, meant_for=GRADES.get(grade, ()))


def specific_unbalance(
    eccentricity: float, rotor: Unbalance, planes: Planes, overhung: bool | None = None
) -> Tolerance:
    """Return the tolerance of a permissible specific unbalance e_per (m): U_per = e_per m.

    Parameters as for `iso_21940_11`; 1 µm is 1 g·mm/kg.
    """
    total = _positive(eccentricity, "the specific unbalance", "m") * rotor.mass
    criterion = f"specific unbalance {1e6 * eccentricity:g} µm"
    return _allocated(criterion, "U_per = e_per m", total, rotor, planes, overhung)


def api(standard: str, rotor: Unbalance, planes: Planes, rpm: float) -> Tolerance:
    """Return the tolerance 6350 W/N g·mm per plane (4 W/N oz·in), W the mass in kg that the journal carries.

    API 617 stops there at 25,000 r/min: from then on it is W/3.937 g·mm, a specific unbalance of 0.254 µm whatever the
    speed (its 9th edition, 6.8.2.7, as `Rotor.api617_unbalance` of ROSS by Petrobras has it, whose report of 2019 has
    max(6350/N, 0.25) W). Of API 610 no such floor is known.

    Parameters
    ----------
    standard : "API 610" or "API 617"
    rotor, planes : as for `iso_21940_11`
    rpm : N, highest continuous r/min
    """
    if standard not in ("API 610", "API 617"):
        raise UsageError(f"the standard is {standard!r}: use 'API 610' or 'API 617'")
    limit, rule = _FOUR_W_OVER_N / _positive(rpm, "the speed", "r/min"), "6350 W/N g·mm"
    if standard == "API 617" and rpm >= _API_617_FAST:
        limit, rule = _API_617_LEAST, "W/3.937 g·mm, from 25000 r/min on,"
    a, b = carried_masses(rotor.mass, rotor.z, *planes)
    return Tolerance(
        standard,
        f"{rule} per plane, W the journal's load in kg",
        (limit * abs(a), limit * abs(b)),
        law=MassLaw(limit, rotor.mass, rotor.z, planes, (0.0, math.inf)),
    )


def mil_std_167_1(revision: str, rotor: Unbalance, planes: Planes, rpm: float, grade: float | None = None) -> Tolerance:
    """Return the tolerance of MIL-STD-167-1, whose revisions differ.

    That of 1974 allows each plane 0.177 W oz·in below 150 r/min, 4000 W/N² up to 1000 r/min and 4 W/N above, with W the
    weight in lb of the whole rotor. Revision A of 2005 leaves the balance quality grade to the contract (§ 6.2 g).

    Parameters
    ----------
    revision : one of `MIL_REVISIONS`
    rotor, planes : as for `iso_21940_11`
    rpm : N, r/min
    grade : for revision A only
    """
    if revision not in MIL_REVISIONS:
        raise UsageError(
            f"the revision {revision!r} of MIL-STD-167-1 is not known, and their limits differ: use one of "
            f"{', '.join(MIL_REVISIONS)}"
        )
    n = _positive(rpm, "the speed", "r/min")
    if revision == "MIL-STD-167-1A":
        if grade is None:
            raise UsageError("MIL-STD-167-1A takes its grade from the contract: give the grade")
        iso = iso_21940_11(grade, rotor, planes, n * math.pi / 30.0)
        return replace(iso, standard=f"MIL-STD-167-1A, G{grade:g}", meant_for=())
    if grade is not None:
        raise UsageError(f"{revision} has limits of its own: leave the grade out, or ask for MIL-STD-167-1A")
    if n > 1000.0:
        rule, specific = "4 W/N oz·in", _FOUR_W_OVER_N / n
    elif n >= 150.0:
        rule, specific = "4000 W/N² oz·in", 1000.0 * _FOUR_W_OVER_N / n**2
    else:
        rule, specific = "0.177 W oz·in", _MIL_SLOW
    each = specific * rotor.mass
    return Tolerance(
        f"{revision} (1974)",
        f"{rule} per plane, W the weight in lb of the whole rotor, N in r/min",
        (each, each),
        law=MassLaw(specific, rotor.mass, rotor.z, planes, (1.0, 1.0)),
    )


def bearing_force_limits(limits: tuple[float, float], speed: float) -> Tolerance:
    """Return the tolerance of permissible forces on bearings A and B, N: U = F/ω².

    Parameters
    ----------
    limits : (A, B) N
    speed : rad/s, highest in service
    """
    omega = _positive(speed, "the speed", "rad/s")
    a, b = (_positive(limit, "the bearing force limit", "N") / omega**2 for limit in limits)
    return Tolerance(f"bearing forces {limits[0]:g} N and {limits[1]:g} N", "U = F/ω²", (a, b))


def allocate(rotor: Unbalance, planes: Planes, overhung: bool | None = None) -> tuple[Share, Share]:
    """Share a total among tolerance planes A and B by the lever rule: L_B/L to A, L_A/L to B.

    Each is kept between 0.3 and 0.7, and for overhung rotors between 0.3 and 1.3.

    Parameters
    ----------
    rotor : its centre of mass counts
    planes : (A, B) m
    overhung : whether the rotor counts as overhung; by itself, where its centre of mass lies outside the planes
    """
    a, b = carried_masses(1.0, rotor.z, *planes)
    if overhung is None:
        overhung = min(a, b) < 0
    limits = _OVERHUNG if overhung else _INBOARD
    first, second = (Share(abs(k), min(max(abs(k), limits[0]), limits[1]), limits) for k in (a, b))
    return first, second


def achieved_grade(vectors: tuple[complex, complex], shares: tuple[Share, Share], mass: float, speed: float) -> float:
    """Return the grade G, mm/s, whose tolerance an unbalance just keeps in both planes: ω max(|U_k|/s_k)/m.

    Of a static unbalance in the plane of the centre of mass it is e ω; a couple counts as well.

    Parameters
    ----------
    vectors : (A, B) kg m, in the tolerance planes
    shares : s_k, what part of the total each plane is allowed
    mass : kg
    speed : rad/s

    >>> half = Share(0.5, 0.5, (0.3, 0.7))
    >>> round(achieved_grade((1e-3, -1e-3), (half, half), 2.0, 100.0), 9)
    100.0
    """
    worst = max(abs(vector) / share.used for vector, share in zip(vectors, shares, strict=True))
    return 1e3 * speed * worst / mass


def accepted(size: float, permissible: float, uncertainty: float) -> Literal["pass", "fail", "undecided"]:
    """Return whether a *measured* unbalance is accepted: |U| ≤ U_per − ΔU, and failed where |U| > U_per + ΔU.

    In between, this measurement decides nothing. Source: ISO 21940-14, acceptance of measured residual unbalance.

    Parameters
    ----------
    size, permissible : |U| and U_per, in one unit
    uncertainty : ΔU, expanded, in the same unit

    >>> accepted(8.0, 10.0, 1.0), accepted(9.5, 10.0, 1.0), accepted(11.5, 10.0, 1.0)
    ('pass', 'undecided', 'fail')
    """
    if size <= permissible - uncertainty:
        return "pass"
    return "fail" if size > permissible + uncertainty else "undecided"


def _allocated(
    standard: str, rule: str, total: float, rotor: Unbalance, planes: Planes, overhung: bool | None
) -> Tolerance:
    shares = allocate(rotor, planes, overhung)
    law = MassLaw(total / rotor.mass, rotor.mass, rotor.z, planes, shares[0].limits)
    return Tolerance(standard, rule, (total * shares[0].used, total * shares[1].used), total, shares, law=law)


def _positive(value: float, name: str, unit: str) -> float:
    if not 0 < value < math.inf:
        raise UsageError(f"{name} is {value!r} {unit}: it must be positive and finite")
    return value
