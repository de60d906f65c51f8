"""A production lot of rotors: unbalance against the limit, the index Ppk, and which tolerance to tighten.

An unbalance is a vector, and its limit is one of the magnitude, which is not normal: of components that are normal
about a mean, as sums of many causes are, it is Rayleigh's, or Rice's where the mean is not zero. So the components in
each tolerance plane, over the limit, are taken as normal, and the index is that of quantiles, one-sided as there is no
lower limit,

    Ppk = (1 − X50) / (X99.865 − X50),

which is (U − μ)/3σ for a normal magnitude. Source: ISO 22514-2, quantiles of a model distribution. It is the
performance index, of what the rows hold; whether the process is stable, which Cpk asks for, no single lot can tell.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import field
from decimal import Decimal
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.balancing.unbalance import Complex
from inertia.records import dataclass
from inertia.report.numerals import row as line
from inertia.report.numerals import wrapped

_UPPER = 0.99865
_SHOP = ("depth", "diameter", "radius", "z", "angle", "mass", "arc")
_BETWEEN = "between rotors"
_FEW = 100
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
_DEVIATIONS = np.arange(-9.0, 10.0, 3.0)  # within which a normal density is smooth for so many nodes


@dataclass
class Lot:
    """The rotors so far: what each row says of tolerance planes A and B, over their limits."""

    verdicts: Counter[str] = field(default_factory=Counter)
    initial: list[tuple[complex, complex]] = field(default_factory=list)
    residual: list[tuple[complex, complex]] = field(default_factory=list)
    upper: list[tuple[float, float]] = field(default_factory=list)
    within: list[float] = field(default_factory=list)
    shares: list[dict[str, list[float]]] = field(default_factory=list)

    def count(self, row: Mapping[str, Any]) -> None:
        """Count a row of `balance` in."""
        if row["state"] != "answered" or not (row["permissible_a_gmm"] and row["permissible_b_gmm"]):
            return
        limits = row["permissible_a_gmm"], row["permissible_b_gmm"]
        self.verdicts[row["verdict"]] += 1
        self.initial.append(_vectors(row, "initial", limits))
        self.residual.append(_vectors(row, "residual", limits))
        self.upper.append((row["residual_95_a_gmm"] / limits[0], row["residual_95_b_gmm"] / limits[1]))
        if row["within"] is not None:
            self.within.append(row["within"])
        self.shares.append(_by_cause(json.loads(row["shares"] or "{}")))

    def document(self) -> dict[str, Any] | None:
        """Return what the rows say together; None of fewer than two rotors."""
        if len(self.initial) < 2:
            return None
        initial, residual, upper = np.array(self.initial), np.array(self.residual), np.array(self.upper)
        inner = np.column_stack([_spread(np.abs(residual[:, k]), upper[:, k]) for k in (0, 1)]) ** 2
        made = [Magnitude.of(residual[:, k], float(inner[:, k].mean())) for k in (0, 1)]
        worst = min((0, 1), key=lambda k: made[k].ppk)
        causes = self._causes(worst, inner[:, worst], made[worst].variance)
        first = next((name for name in causes if name != _BETWEEN), None)
        tightened = None
        if first is not None:
            less = made[worst].less(0.75 * causes[first] * made[worst].variance)
            tightened = {"cause": first, "ppk": _finite(less.ppk), "share_out": less.above(1.0)}
        return {
            "rotors": len(initial),
            "verdicts": dict(sorted(self.verdicts.items())),
            "initial": [_plane(name, initial[:, k], Magnitude.of(initial[:, k])) for k, name in enumerate("AB")],
            "residual": [_plane(name, residual[:, k], made[k]) for k, name in enumerate("AB")],
            "expected_out": None if not self.within else 1.0 - math.fsum(self.within) / len(self.within),
            "worst_plane": "AB"[worst],
            "variance": causes,
            "halved": tightened,
        }

    def text(self) -> list[str]:
        """Return the same as lines of text."""
        document = self.document()
        if document is None:
            return []
        counts = ", ".join(f"{number} {verdict}" for verdict, number in document["verdicts"].items())
        lines = [line("Lot", f"{document['rotors']} rotors: {counts}; unbalances are shares of their limit")]
        for label, name in (("As modelled", "initial"), ("As made", "residual")):
            for k, plane in enumerate(document[name]):
                lines.append(
                    line(
                        "" if k else label,
                        f"plane {plane['id']}: median {_plain(plane['median'])}, 99.865 % below "
                        f"{_plain(plane['upper'])}, {_percent(plane['share_out'])} out ({plane['out']} counted), "
                        f"Ppk {_figure(plane['ppk'])}",
                    )
                )
        if document["expected_out"] is not None:
            share = f"{_percent(document['expected_out'])} of parts, by the stated tolerances of each rotor"
            lines.append(line("Expected out", share))
        if document["variance"]:
            causes = ", ".join(
                f"{name} {_plain(100 * share, 2)} %" for name, share in [*document["variance"].items()][:6]
            )
            lines.append(line("Variance", f"in plane {document['worst_plane']}: {causes}"))
        if (halved := document["halved"]) is not None:
            lines.append(
                line("To tighten", f"{halved['cause']}: half of it makes Ppk {_figure(halved['ppk'])}, "
                     f"{_percent(halved['share_out'])} out")
            )  # fmt: skip
        few = f"; {_FEW} rotors or more are usual for an index" if document["rotors"] < _FEW else ""
        how = "Ppk = (1 − X50)/(X99.865 − X50), ISO 22514-2, of the magnitude of a vector with normal components"
        return [*lines, *wrapped("Index", how + few)]

    def _causes(self, plane: int, inner: Float, variance: float) -> dict[str, float]:
        """Return the share of the variance in a plane by cause, the largest first.

        Parameters
        ----------
        plane : 0 or 1
        inner : (n,) variance of each component within the tolerances of each rotor
        variance : of both components, all rotors together
        """
        causes = {_BETWEEN: variance - 2 * float(inner.mean())}
        for each, shares in zip(inner.tolist(), self.shares, strict=True):
            for name, by_plane in shares.items():
                causes[name] = causes.get(name, 0.0) + by_plane[plane] * 2 * each / len(inner)
        ranked = sorted(causes.items(), key=lambda entry: -entry[1])
        return {name: share / variance for name, share in ranked if share > 1e-4 * variance}


@dataclass(frozen=True, eq=False)
class Magnitude:
    """The length of a vector in the plane whose components are normal.

    Attributes
    ----------
    mean : (2,), along the principal axes of the covariance
    deviations : (2,), the larger first
    """

    mean: Float
    deviations: Float

    @classmethod
    def of(cls, vectors: Complex, more: float = 0.0) -> Magnitude:
        """Return that of a sample (n,), each component of which scatters by a variance `more` beside."""
        components = np.column_stack([vectors.real, vectors.imag])
        values, axes = np.linalg.eigh(np.cov(components.T) + more * np.eye(2))
        mean = axes.T @ components.mean(axis=0)
        return cls(mean[::-1], np.sqrt(np.maximum(values[::-1], 0.0)))

    @property
    def variance(self) -> float:
        """Of both components together."""
        return float((self.deviations**2).sum())

    def less(self, variance: float) -> Magnitude:
        """Return that of a vector with so much less variance."""
        left = max(0.0, 1.0 - variance / self.variance)
        return Magnitude(self.mean, math.sqrt(left) * self.deviations)

    def above(self, limit: float) -> float:
        """Return the probability of a length above a limit.

        P(r ≤ R) = ∫ φ(x) [Φ((√(R² − x²) − b)/t) − Φ((−√(R² − x²) − b)/t)] dx along the larger deviation s, by rules of
        Gauss in x = R sin θ, for which the ends are smooth. They meet at multiples of s
        and t, so that the integrand of each is smooth however small t is.

        >>> round(Magnitude(np.zeros(2), np.ones(2)).above(2.0), 9), round(math.exp(-2.0), 9)
        (0.135335283, 0.135335283)
        """
        from scipy.special import ndtr

        (a, b), (s, t) = self.mean.tolist(), self.deviations.tolist()
        if s <= 1e-12 * limit:
            return float(math.hypot(a, b) > limit)
        t = max(t, 1e-9 * limit)
        along = np.arcsin(np.clip((a + s * _DEVIATIONS) / limit, -1.0, 1.0))
        across = np.arccos(np.clip((abs(b) + t * _DEVIATIONS) / limit, 0.0, 1.0))
        ends = np.sort(np.clip([*-across, *along, *across], along[0], along[-1]))
        widths = 0.5 * np.diff(ends)[:, None]
        angle = ends[:-1, None] + widths * (1.0 + _NODES)
        x, half = limit * np.sin(angle), limit * np.cos(angle)
        inside = ndtr((half - b) / t) - ndtr((-half - b) / t)
        density = np.exp(-0.5 * ((x - a) / s) ** 2) / (s * math.sqrt(2 * math.pi))
        rule = widths * _WEIGHTS * half
        return min(1.0, max(0.0, 1.0 - float((rule * density * inside).sum())))

    def quantile(self, share: float) -> float:
        """Return the length that a share of them stays below."""
        low, high = 0.0, float(np.linalg.norm(self.mean)) + 9.0 * float(self.deviations.sum())
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if 1.0 - self.above(middle or 1e-300) < share else (low, middle)
        return high

    @property
    def ppk(self) -> float:
        """The index against the limit 1; infinite where nothing scatters and all is within."""
        middle, upper = self.quantile(0.5), self.quantile(_UPPER)
        if upper - middle <= 1e-12 * upper:
            return math.copysign(math.inf, 1.0 - middle)
        return (1.0 - middle) / (upper - middle)


def _vectors(row: Mapping[str, Any], state: str, limits: tuple[float, float]) -> tuple[complex, complex]:
    a, b = (
        row[f"{state}_{plane}_gmm"] / limit * np.exp(1j * math.radians(row[f"{state}_{plane}_deg"]))
        for plane, limit in zip("ab", limits, strict=True)
    )
    return complex(a), complex(b)


def _by_cause(shares: Mapping[str, Sequence[float]]) -> dict[str, list[float]]:
    """Return shares of the variance by tolerance of the shop, or by the first words of what else is uncertain."""
    causes: dict[str, list[float]] = {}
    for name, by_plane in shares.items():
        last = name.rpartition(": ")[2]
        cause = last if last in _SHOP else name.partition(" ")[0] if name.startswith(("axis", "density of")) else name
        causes[cause] = [x + y for x, y in zip(causes.get(cause, [0.0, 0.0]), by_plane, strict=True)]
    return causes


def _spread(nominal: Float, upper: Float) -> Float:
    """Return the deviation (n,) of each component with which 95 % of the magnitudes stay below `upper`: Rice's."""
    from scipy.special import chndtr, ndtr

    low, high = np.zeros(len(upper)), np.maximum(upper, 1e-300)
    for _ in range(60):
        middle = 0.5 * (low + high)
        far = nominal > 30.0 * middle
        beside = np.where(far, 0.0, nominal / middle) ** 2
        near = chndtr((upper / middle) ** 2, 2, beside)
        below = np.where(far, ndtr((upper - nominal) / middle), near)
        low, high = np.where(below > 0.95, middle, low), np.where(below > 0.95, high, middle)
    return np.where(upper > nominal * (1 + 1e-9), high, 0.0)


def _plane(name: str, vectors: Complex, magnitude: Magnitude) -> dict[str, Any]:
    return {
        "id": name,
        "median": magnitude.quantile(0.5),
        "upper": magnitude.quantile(_UPPER),
        "largest": float(np.abs(vectors).max()),
        "out": int((np.abs(vectors) > 1.0).sum()),
        "share_out": magnitude.above(1.0),
        "ppk": _finite(magnitude.ppk),
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _figure(value: float | None) -> str:
    return "not defined: nothing scatters" if value is None else _plain(value)


def _percent(share: float) -> str:
    return f"{_plain(100 * share)} %" if share >= 1e-8 or share == 0 else "below 0.000001 %"


def _plain(value: float, digits: int = 3) -> str:
    """Return a value with so many significant digits, and in a power of ten only where it is next to nothing.

    >>> _plain(100.0, 2), _plain(2500.0), _plain(0.00003), _plain(0.5), _plain(1e-9)
    ('100', '2500', '0.00003', '0.5', '1e-09')
    """
    text = f"{value:.{digits}g}"
    return text if 0 < abs(value) < 1e-7 else f"{Decimal(text):f}"
