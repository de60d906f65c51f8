"""The curves of free rotation: polhode and separatrix in the body, herpolhode in space (textbook § 13.21).

All are curves of ω: the angular momentum along principal axes is moments × ω. Polhodes are sampled evenly in the
amplitude χ of the elliptic functions, in which they are smooth at any distance from the separatrix: about axis r, with
q the intermediate axis and p the other extreme one,

    ω_p = a_p cosχ,  ω_q = a_q sinχ,  ω_r = ±√(b² cos²χ + c² sin²χ).

Every amplitude is a sum of positive terms, c² by way of `stability.separatrix_distance`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.dynamics.arguments import moments_of
from inertia.dynamics.kinematics.stability import separatrix_distance
from inertia.dynamics.special.elliptic import first_kind
from inertia.errors import GeometryError
from inertia.mass.tensor import array_of
from inertia.records import dataclass

_Amplitude = tuple[Float, Float]
"""cosχ and sinχ, (n,) each."""

_SHARES = 0.2, 0.45, 0.7, 0.9  # of the way to the separatrix, in 2T/L²


@dataclass(frozen=True, eq=False)
class Polhode:
    """One body's polhode: the intersection of the momentum sphere and the energy ellipsoid.

    Attributes
    ----------
    axis : the principal axis, numbered from 0, that the curves go round
    branches : (2, n, 3) rad/s: ω along the closed curve that starts at the given ω, and along its mirror image on the
        other side, both in the sense of the motion; the last sample is the first
    """

    axis: int
    branches: Float


@dataclass(frozen=True, eq=False)
class Herpolhode:
    """The curve that ω draws in space, on the invariable plane.

    Attributes
    ----------
    distance : rad/s, 2T/L, of the plane from the centre
    least, greatest : rad/s, radius of the curve about L: it stays between these circles
    advance : rad, the angle by which ω goes round L while it goes once round its polhode; the radius has two greatest
        and two least values in that time
    points : (n, 3) rad/s, ω at the samples of `Polhode.branches[0]`, resolved along space axes of which the third is
        along L and ω starts in the plane of the first and the third
    """

    distance: float
    least: float
    greatest: float
    advance: float
    points: Float


def polhode(moments: ArrayLike, angular_velocity: ArrayLike, samples: int = 361) -> Polhode:
    """Return both branches of a body's polhode.

    On the separatrix itself a branch is its limit, two of the four arcs between the ends of the intermediate axis; of a
    body that spins steadily about one of two equal moments, the circle of such spins.

    Parameters
    ----------
    moments : (3,) kg m², in any order
    angular_velocity : (3,) rad/s, along the principal axes
    samples : along each branch

    Raises `GeometryError` where the body does not rotate, or the sphere and the ellipsoid are one (spherical body).

    >>> curve = polhode([1, 2, 3], [0.1, 0, 1], samples=5)
    >>> curve.axis, curve.branches[0, 1].round(4).tolist()
    (2, [0.0, 0.1, 0.9983])
    """
    curve = _Curve(moments, angular_velocity)
    branch = curve.at(curve.amplitudes(samples))
    other = branch * np.where(np.arange(3) == curve.order[0], 1.0, -1.0)  # half a turn about p keeps the equations
    return Polhode(curve.order[2], np.stack([branch, other]))


def covered(moments: ArrayLike, angular_velocity: ArrayLike, samples: int = 361) -> Float:
    """Return ω (n, 3) in rad/s along what of its polhode a body passes through, in the sense of the motion.

    All of it, from the given ω on; on the separatrix the arc from one end of the intermediate axis to the other, which
    takes for ever; of a steady spin one point.

    Parameters, errors: as in `polhode`.

    >>> covered([3, 4, 6], [2, 3, 1], samples=3).round(4).tolist()
    [[0.0, -3.6742, 0.0], [3.4641, 0.0, 1.7321], [0.0, 3.6742, 0.0]]
    """
    curve = _Curve(moments, angular_velocity)
    if curve.c:
        return curve.at(curve.amplitudes(samples))
    p, _, r = curve.order
    if not curve.omega[r]:
        return np.tile(curve.omega, (samples, 1))
    turn, side = np.linspace(-0.5 * np.pi, 0.5 * np.pi, samples), math.copysign(1.0, curve.omega[p])
    return curve.at((side * np.cos(turn), side * curve.sense * np.sin(turn)))


def separatrix(moments: ArrayLike, angular_momentum: float, samples: int = 361) -> Float:
    """Return the two closed curves (2, n, 3) of ω in rad/s that part polhodes about the axes of least and most moment.

    In terms of L they are great circles of the momentum sphere, through the intermediate axis and inclined to that of
    the smallest moment by ±γ, tan²γ = I3 (I2 − I1)/(I1 (I3 − I2)); 2 T I2 = L² on them.

    Parameters
    ----------
    moments : (3,) kg m², in any order
    angular_momentum : kg m²/s, |L|
    samples : along each curve, evenly along the circle; the last is the first

    Raises `GeometryError` where two moments are equal: such a body has no separatrix.

    >>> (separatrix([1, 2, 3], 6.0, samples=3)[0, 0]).tolist()
    [0.0, 3.0, 0.0]
    """
    moments = moments_of(array_of(moments, (3,), "moments"))
    order = np.argsort(moments, kind="stable")
    i1, i2, i3 = moments[order].tolist()
    if i1 == i2 or i2 == i3:
        raise GeometryError(f"moments are {moments.tolist()} kg m²: a body with equal moments has no separatrix")
    lean = np.arctan2(np.sqrt(i3 * (i2 - i1)), np.sqrt(i1 * (i3 - i2)))
    turn = np.linspace(0.0, 2.0 * np.pi, samples)
    curves = np.empty((2, samples, 3))
    for curve, sign in zip(curves, (1.0, -1.0), strict=True):
        curve[:, order[0]] = np.sin(turn) * np.cos(lean)
        curve[:, order[1]] = np.cos(turn)
        curve[:, order[2]] = np.sin(turn) * np.sin(lean) * sign
    return angular_momentum * curves / moments


def herpolhode(moments: ArrayLike, angular_velocity: ArrayLike, samples: int = 361) -> Herpolhode:
    """Return the herpolhode of a free body over one turn of its polhode.

    Its radius is ρ = |L × ω|/L. It goes round L at the rate ϑ̇ = ω̇·Iω̇/(L ρ²), never backwards, between L/I_p and
    L/I_q; in the amplitude ϑ is a sum of Carlson's R_F and R_J.

    Parameters, errors: as in `polhode`; `GeometryError` on the separatrix too, where the curve winds inwards for ever.

    >>> curve = herpolhode([1, 1, 2], [0.3, 0, 0.4])
    >>> round(curve.least, 12) == round(curve.greatest, 12), round(curve.advance / np.pi, 12)
    (True, 4.272001872659)
    """
    curve = _Curve(moments, angular_velocity)
    if curve.c == 0:
        raise GeometryError(
            "the body is on its separatrix, or spins about one of two equal moments: no herpolhode closes"
        )
    cosine, sine = curve.amplitudes(samples)
    azimuth, advance = curve.azimuth((cosine, sine))
    at_p, at_q = curve.radii()
    radius = np.hypot(at_p * cosine, at_q * sine)
    distance = float(np.sum(curve.moments * curve.omega**2)) / curve.momentum
    points = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), np.full(samples, distance)], axis=-1)
    return Herpolhode(distance, min(at_p, at_q), max(at_p, at_q), advance, points)


def polhode_family(moments: ArrayLike, samples: int = 361) -> list[Float]:
    """Return polhodes of one |L|, some about axis 1 and some about axis 3, as unit vectors (n, 3) along L.

    They lie where 2 T / L² is a share of the way from 1/I1, or 1/I3, to 1/I2, which is that of the separatrix.

    Parameters
    ----------
    moments : (3,) kg m², in any order, all different
    samples : along each curve

    >>> curves = polhode_family([1, 2, 3], samples=5)
    >>> len(curves), (curves[0] ** 2).sum(axis=1).round(12).tolist()
    (16, [1.0, 1.0, 1.0, 1.0, 1.0])
    """
    moments = moments_of(array_of(moments, (3,), "moments"))
    low, middle, high = np.argsort(moments).tolist()
    curves: list[Float] = []
    for share in _SHARES:
        for axis in (low, high):
            direction = np.zeros(3)
            direction[[axis, middle]] = math.sqrt(1.0 - share), math.sqrt(share)
            curves += list(moments * polhode(moments, direction / moments, samples).branches)
    return curves


class _Curve:
    """A polhode in its amplitude: the axes p, q, r, the ends of its range on each, and where on it the body is."""

    def __init__(self, moments: ArrayLike, angular_velocity: ArrayLike) -> None:
        self.moments = moments_of(array_of(moments, (3,), "moments"))
        self.omega = array_of(angular_velocity, (3,), "angular_velocity")
        if np.ptp(self.moments) == 0:
            raise GeometryError("all moments are equal: every rotation of the body is steady and has no polhode")
        excess = float(separatrix_distance(self.moments, self.omega))
        p, q, r = np.argsort(self.moments, kind="stable").tolist()
        if excess > 0 or (excess == 0 and self.moments[q] == self.moments[r]):
            p, r = r, p
        self.order = p, q, r
        ip, iq, ir = self.moments[[p, q, r]].tolist()
        wp, wq, wr = self.omega[[p, q, r]].tolist()
        self.momentum = float(np.linalg.norm(self.moments * self.omega))
        # Σ I (I_k − I) ω² is kept for each k, and free of ω_k: this gives ω at the ends of the range.
        self.flatness = math.sqrt(ip / iq * ((ir - ip) / (ir - iq)))  # a_q / a_p
        self.a = math.hypot(wp, wq / self.flatness)
        self.b = math.hypot(wr, wq * math.sqrt(iq / ir * ((iq - ip) / (ir - ip))))
        self.c = self.momentum * math.sqrt(abs(excess) / ir / abs(ir - iq))
        self.side = math.copysign(1.0, wr)
        cyclic = 1.0 if (q - p) % 3 == 1 else -1.0
        self.sense = math.copysign(1.0, cyclic * (ir - iq) * self.side)

    def amplitudes(self, samples: int) -> _Amplitude:
        """Return χ at samples over one turn from where the body is, in the sense of the motion; the last is the first.

        Near the intermediate axis, where cosχ is small, χ itself would not keep its digits.
        """
        p, q, _ = self.order
        cosine, sine = (self.omega[p] / self.a, self.omega[q] / self.flatness / self.a) if self.a else (1.0, 0.0)
        turn = self.sense * np.linspace(0.0, 2.0 * np.pi, samples)
        along, across = np.cos(turn), np.sin(turn)
        along[-1], across[-1] = along[0], across[0]
        return cosine * along - sine * across, sine * along + cosine * across

    def at(self, amplitude: _Amplitude) -> Float:
        """Return ω (n, 3) at χ (n,)."""
        cosine, sine = amplitude
        omega = np.empty((cosine.size, 3))
        along = self.side * np.hypot(self.b * cosine, self.c * sine)
        omega[:, self.order] = np.stack([self.a * cosine, self.flatness * self.a * sine, along], axis=-1)
        return omega

    def radii(self) -> tuple[float, float]:
        """Return ρ at χ = 0 and at χ = π/2: |L × ω|/L, of which one component is left there."""
        ip, iq, ir = self.moments[list(self.order)].tolist()
        at_p = abs(ir - ip) * self.a * self.b / self.momentum
        at_q = abs(ir - iq) * self.flatness * self.a * self.c / self.momentum
        return at_p, at_q

    def azimuth(self, amplitude: _Amplitude) -> tuple[Float, float]:
        """Return ϑ (n,) from the first of `amplitudes` on, and by how much it grows in a whole turn.

        It is ∫ ϑ̇/χ̇ dχ, with ϑ̇ = L (cos²χ/I_q + ν sin²χ/I_p)/(cos²χ + ν sin²χ), ν = (ρ_q/ρ_p)² and
        χ̇ = (|I_r − I_q|/I_p) (a_q/a_p) ω_r. What is left is R_F and, of sin²χ/(cos²χ + ν sin²χ), R_J.
        """
        from scipy.special import elliprj

        ip, iq, ir = self.moments[list(self.order)].tolist()
        mc = (self.c / self.b) ** 2
        nu = mc * (ip / iq) * ((ir - iq) / (ir - ip))
        behind = np.where(amplitude[0] < 0, -1.0, 1.0)
        # The last is a quarter turn: a cosine that is not zero to the last digit would not be small beside √mc.
        cosine, sine = np.append(np.abs(amplitude[0]), 0.0), np.append(behind * amplitude[1], 1.0)
        squares = cosine**2, sine**2
        time = first_kind(sine, cosine, mc)
        third = sine**3 / 3.0 * elliprj(squares[0], squares[0] + mc * squares[1], 1.0, squares[0] + nu * squares[1])
        rate = abs(ir - iq) / ip * self.flatness * self.b
        angle = self.momentum / rate * (time / iq + (1.0 / ip - 1.0 / iq) * nu * third)
        azimuth: Float = self.sense * (angle[:-1] + 2.0 * angle[-1] * self._half_turns(amplitude))
        return azimuth - azimuth[0], float(4.0 * angle[-1])

    def _half_turns(self, amplitude: _Amplitude) -> Float:
        """Return (n,) how many half turns lead to the side that cosχ says, along `amplitudes`."""
        cosine, sine = amplitude
        begun = math.atan2(sine[0], cosine[0]) + self.sense * np.linspace(0.0, 2.0 * np.pi, cosine.size)
        odd = np.where(cosine < 0, 1.0, 0.0)
        return odd + 2.0 * np.round(0.5 * (begun / np.pi - odd))
