"""The gravity gradient along a Kepler orbit: where the body is on its ellipse, and the torque of the primary there."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import fields
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import cached_property
from typing import Annotated, Any

import numpy as np

from inertia.arrays import Float
from inertia.documents import FieldError, Reader, choice, number, numbers
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.loads.gravity import across_gradient
from inertia.dynamics.loads.load import Load, TurningBody
from inertia.records import dataclass

PRIMARIES = {
    "earth": (3.986004418e14, 6378137.0),
    "moon": (4.902800118e12, 1737400.0),
    "mars": (4.2828375816e13, 3396190.0),
    "sun": (1.32712440041279419e20, 6.957e8),
}
"""Gravitational parameter in m³/s² and equatorial radius in m. Earth: WGS 84; others: JPL DE440 (Park et al.,
Astron. J. 161 (2021) 105) and the IAU (Archinal et al., Celest. Mech. Dyn. Astron. 130 (2018) 22; Prša et al.,
Astron. J. 152 (2016) 41)."""

_DIGITS = 50
_PI = Decimal("3.14159265358979323846264338327950288419716939937510")
_ROUND = 1e-15  # the eccentricity below which an orbit is a circle to rounding
_SLENDER = 0.1  # the eccentricity from which on passages of the periapsis are instants to step to
_EVEN = 1e-6  # the square of a rate of swings, over that of the orbit, which is no rate
_PASSAGES = 100_000  # that are listed: more revolutions are beyond any limit of computing time
_SMALL = 1.0  # rad, below which E − sin E is summed as a series
_TERMS = [(-1.0) ** k / math.factorial(2 * k + 3) for k in range(9)][::-1]
_BITS = 2.0**24


def eccentric_anomaly(mean: float, eccentricity: float, gap: float) -> float:
    """Return E in rad, −π … π, from Kepler's equation E − e sin E = M.

    With E ≥ 0 the left side is convex, so that Newton's method comes down to the root from any start above it; the
    least of π, M + e, M/(1 − e) and ∛(10 M/e) is such a start. The equation is taken as (1 − e) E + e (E − sin E) = M,
    which keeps its digits near the periapsis of a slender orbit. Battin, *An Introduction to the Mathematics and
    Methods of Astrodynamics* (1999), § 5.1.

    Parameters
    ----------
    mean : M in rad, −π … π; eccentricity : e, 0 ≤ e < 1; gap : 1 − e, to its own digits

    >>> eccentric_anomaly(1.0, 0.0, 1.0), round(eccentric_anomaly(-1e-9, 0.9999, 1e-4), 15)
    (1.0, -9.999998334e-06)
    """
    goal = abs(mean)
    if not goal:
        return mean
    at = min(math.pi, goal + eccentricity, goal / gap)
    if eccentricity:
        at = min(at, (10.0 * goal / eccentricity) ** (1.0 / 3.0))
    while True:
        step = (gap * at + eccentricity * _versed(at) - goal) / (gap + 2.0 * eccentricity * math.sin(0.5 * at) ** 2)
        if not at - step < at:
            return math.copysign(at, mean)
        at -= step


def _versed(angle: float) -> float:
    """Return x − sin x."""
    if abs(angle) > _SMALL:
        return angle - math.sin(angle)
    square, total = angle * angle, 0.0
    for term in _TERMS:
        total = total * square + term
    return total * square * angle


@dataclass(frozen=True, eq=False)
class Ellipse:
    """A Kepler ellipse about a primary at the origin of space.

    Attributes
    ----------
    semi_major_axis : m; eccentricity : e; gap : 1 − e
    axes : (3, 3), columns to the periapsis, along the motion there, and along the orbit's normal
    start : mean anomaly at t = 0, rad
    motion : mean motion, rad/s
    period : s, in a part that few revolutions multiply exactly, and the rest
    """

    semi_major_axis: float
    eccentricity: float
    gap: float
    axes: Float
    start: float
    motion: float
    period: tuple[float, float]

    @classmethod
    def of_elements(cls, mu: float, size: Decimal, eccentricity: float, axes: Float, anomaly: float) -> Ellipse:
        """Take the semi-major axis in m and the true anomaly in rad at t = 0."""
        gap = 1.0 - eccentricity
        half = 0.5 * anomaly
        first = 2.0 * math.atan2(math.sqrt(gap) * math.sin(half), math.sqrt(1.0 + eccentricity) * math.cos(half))
        return cls._timed(Decimal(mu), size, eccentricity, gap, axes, first)

    @classmethod
    def of_state(cls, mu: float, position: Float, velocity: Float) -> Ellipse | None:
        """Take the place (3,) m and velocity (3,) m/s at t = 0; None where the orbit does not close."""
        with localcontext() as context:
            context.prec = _DIGITS
            field = Decimal(mu)
            r, v = ([Decimal(x) for x in vector.tolist()] for vector in (position, velocity))
            distance, speed2, along = _dot(r, r).sqrt(), _dot(v, v), _dot(r, v)
            inverse = 2 / distance - speed2 / field
            if inverse <= 0:
                return None
            normal = [r[i - 2] * v[i - 1] - r[i - 1] * v[i - 2] for i in range(3)]
            square = 1 - _dot(normal, normal) * inverse / field
            eccentricity = max(square, Decimal(0)).sqrt()
            to = r
            if eccentricity:
                to = [(speed2 / field - 1 / distance) * x - along / field * y for x, y in zip(r, v, strict=True)]
            cosine, sine = 1 - distance * inverse, along * (inverse / field).sqrt()
            first = math.atan2(sine, cosine) if eccentricity else 0.0
            gap = float(_dot(normal, normal) * inverse / field / (1 + eccentricity))
            toward, up = (np.array([float(x / _dot(line, line).sqrt()) for x in line]) for line in (to, normal))
            axes = np.column_stack([toward, np.cross(up, toward), up])
            return cls._timed(field, 1 / inverse, float(eccentricity), gap, axes, first)

    @classmethod
    def _timed(cls, mu: Decimal, size: Decimal, eccentricity: float, gap: float, axes: Float, first: float) -> Ellipse:
        """Find the mean motion and the period to more digits than float64 has, and the mean anomaly at t = 0."""
        with localcontext() as context:
            context.prec = _DIGITS
            motion = (mu / size).sqrt() / size
            period = 2 * _PI / motion
            mantissa, exponent = math.frexp(float(period))
            high = math.ldexp(round(mantissa * _BITS) / _BITS, exponent)
            mean = gap * first + eccentricity * _versed(first)
            rest = float(period - Decimal(high))
            return cls(float(size), eccentricity, gap, axes, mean, float(motion), (high, rest))

    @property
    def circular(self) -> bool:
        """Whether it is a circle, to rounding."""
        return self.eccentricity < _ROUND

    def anomaly(self, time: float) -> float:
        """Return the eccentric anomaly E in rad, −π … π, at `time` s."""
        high, rest = self.period
        turns = round(time / high)
        mean = self.start + self.motion * ((time - turns * high) - turns * rest)
        return eccentric_anomaly(math.remainder(mean, 2.0 * math.pi), self.eccentricity, self.gap)

    def place(self, time: float) -> tuple[float, float, float]:
        """Return the coordinates along the first two axes, and the distance, in units of the semi-major axis."""
        anomaly = self.anomaly(time)
        squared = 2.0 * math.sin(0.5 * anomaly) ** 2
        across = math.sqrt(self.gap * (1.0 + self.eccentricity)) * math.sin(anomaly)
        return self.gap - squared, across, self.gap + self.eccentricity * squared

    def position(self, time: Float) -> Float:
        """Return the places (n, 3) m at `time` (n,) s."""
        along = np.array([self.place(t)[:2] for t in time.tolist()]).reshape(-1, 2)
        return np.asarray(self.semi_major_axis * along @ self.axes[:, :2].T)

    def seen_from(self, time: Float, attitude: Float) -> dict[str, Float]:
        """Return the distance (n,) m, and the attitudes (n, 4) to axes along the radius, across it and the normal."""
        places = self.position(time)
        distance = np.linalg.norm(places, axis=1)
        radial, normal = places / distance[:, None], np.broadcast_to(self.axes[:, 2], places.shape)
        frame = np.stack([radial, np.cross(normal, radial), normal], axis=-1)
        turned = quaternion.multiply(quaternion.conjugate(quaternion.from_matrix(frame)), attitude)
        return {"distance to the primary": distance, "attitude in the orbit": quaternion.continuous(turned)}


def _dot(a: list[Decimal], b: list[Decimal]) -> Decimal:
    return sum((x * y for x, y in zip(a, b, strict=True)), Decimal(0))


def _field(value: Any, path: str) -> float | str:
    """Read a gravitational parameter, or the name of a primary."""
    name = choice(*PRIMARIES)
    read: Reader = name if isinstance(value, str) else number("m³/s²", positive=True)
    parameter: float | str = read(value, path)
    return parameter


_ANGLES = ("inclination", "node", "argument", "anomaly")


@dataclass(frozen=True, eq=False)
class Orbit(Load):
    """The gravity gradient on a free body that goes round a primary at the origin of space on a Kepler orbit.

        N = 3 (μ/r³) r̂ × I r̂,    r(t) from Kepler's equation;

    the body is a point to the orbit. Hughes, *Spacecraft Attitude Dynamics* (1986), § 8.1. On a circular orbit, of
    normal h and rate n, it keeps ½ ω·I ω + (3/2) n² r̂·I r̂ − n h·L, the energy as seen from the orbit (§ 9.2).

    Attributes
    ----------
    mu : m³/s², gravitational parameter of the primary, or one of `PRIMARIES`
    position, velocity : (3,) m, m/s, of the centre of mass from the primary at t = 0; or
    semi_major_axis : m; or, of a named primary,
    altitude : m, of the periapsis over its equatorial radius; with one of them
    eccentricity : below 1; inclination, node, argument : rad, to the plane z = 0, of the ascending node from x, and of
        the periapsis from the node; anomaly : rad, the true one at t = 0; all of them 0 without

    Raises `FieldError` where the orbit is stated twice, or not at all, where it does not close, or goes through the
    primary.

    >>> orbit = Orbit("earth", altitude=400e3, inclination=0.9)
    >>> round(2 * np.pi / orbit.ellipse.motion, 3)
    5553.624
    """

    kind = "orbit"
    noun = "the gravity gradient along an orbit"
    starts_motion = True
    free_bodies_only = True

    mu: Annotated[float | str, _field]
    position: Annotated[Float | None, numbers((3,), "m")] = None
    velocity: Annotated[Float | None, numbers((3,), "m/s")] = None
    semi_major_axis: Annotated[float | None, number("m", positive=True)] = None
    altitude: Annotated[float | None, number("m")] = None
    eccentricity: Annotated[float, number("", negative=False)] = 0.0
    inclination: Annotated[float, number("rad")] = 0.0
    node: Annotated[float, number("rad")] = 0.0
    argument: Annotated[float, number("rad")] = 0.0
    anomaly: Annotated[float, number("rad")] = 0.0

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where there is not one closed orbit outside the primary."""
        self._require_one(path)
        if self.position is not None and self.velocity is not None:
            if not np.any(np.cross(self.position, self.velocity)):
                raise FieldError(f"{path}.velocity", "is along the position: the body would fall straight down")
            if Ellipse.of_state(self.strength, self.position, self.velocity) is None:
                speed, escape = np.linalg.norm(self.velocity), math.sqrt(2 * self.strength / _length(self.position))
                raise FieldError(
                    f"{path}.velocity",
                    f"is {speed:.6g} m/s, and {escape:.6g} m/s is enough to escape: the orbit must close",
                )
        if self.eccentricity >= 1:
            raise FieldError(
                f"{path}.eccentricity", f"is {self.eccentricity:g}: the orbit must close, give less than 1"
            )
        radius = self._radius
        lowest = self.ellipse.semi_major_axis * self.ellipse.gap
        if lowest < radius * (1.0 - _ROUND):
            raise FieldError(
                path, f"is an orbit through the {self.mu}: it comes to {lowest:.6g} m, and the radius is {radius:.6g} m"
            )

    def _require_one(self, path: str) -> None:
        state = [name for name in ("position", "velocity") if getattr(self, name) is not None]
        sizes = [name for name in ("semi_major_axis", "altitude") if getattr(self, name) is not None]
        if len(state) == 1:
            other = "velocity" if state[0] == "position" else "position"
            raise FieldError(f"{path}.{other}", f"is missing: {path}.{state[0]} goes with it")
        if len(sizes) + bool(state) != 1:
            raise FieldError(path, "is an orbit: give one of position and velocity, semi_major_axis, altitude")
        if state:
            for name in ("eccentricity", *_ANGLES):
                if getattr(self, name):
                    raise FieldError(f"{path}.{name}", "is given beside position and velocity, which decide it")
        if self.altitude is not None and not isinstance(self.mu, str):
            names = ", ".join(map(repr, PRIMARIES))
            raise FieldError(
                f"{path}.altitude", f"needs a primary of known radius: give semi_major_axis, or mu as one of {names}"
            )

    @cached_property
    def ellipse(self) -> Ellipse:
        """The orbit."""
        if self.position is not None and self.velocity is not None:
            ellipse = Ellipse.of_state(self.strength, self.position, self.velocity)
            assert ellipse is not None  # the section saw to it
            return ellipse
        x, _, z = np.eye(3)
        turn = quaternion.from_rotation_vector(self.node * z)
        for along in (self.inclination * x, self.argument * z):
            turn = quaternion.multiply(turn, quaternion.from_rotation_vector(along))
        with localcontext() as context:
            context.prec = _DIGITS
            size = Decimal(self.size.numerator) / Decimal(self.size.denominator)
        axes = quaternion.matrix(turn)
        return Ellipse.of_elements(self.strength, size, self.eccentricity, axes, self.anomaly)

    @property
    def strength(self) -> float:
        """The gravitational parameter of the primary, m³/s²."""
        return PRIMARIES[self.mu][0] if isinstance(self.mu, str) else self.mu

    @property
    def size(self) -> Fraction:
        """The semi-major axis of an orbit of elements, m, before it is rounded."""
        if self.semi_major_axis is not None:
            return Fraction(self.semi_major_axis)
        return (Fraction(self._radius) + Fraction(self.altitude or 0.0)) / (1 - Fraction(self.eccentricity))

    @property
    def _radius(self) -> float:
        return PRIMARIES[self.mu][1] if isinstance(self.mu, str) else 0.0

    @cached_property
    def breaks(self) -> Float:
        """Passages of the periapsis of a slender orbit: a method that steps to them cannot miss what happens there."""
        if self.ellipse.eccentricity < _SLENDER:
            return np.empty(0)
        high, rest = self.ellipse.period
        turns = np.arange(_PASSAGES)
        return -self.ellipse.start / self.ellipse.motion + turns * high + turns * rest

    def torque_at(self, time: float, attitude: Float, angular_velocity: Float, body: TurningBody) -> Float:
        """Return 3 (μ/r³) r̂ × I r̂."""
        x, y, distance = self.ellipse.place(time)
        axes = self.ellipse.axes
        toward = quaternion.to_body(attitude, (x * axes[:, 0] + y * axes[:, 1]) / distance)
        strength = 3.0 * (self.ellipse.motion**2 / distance**3)
        return strength * across_gradient(toward, body.moments)

    def integrals(
        self, time: Float, attitude: Float, angular_velocity: Float, body: TurningBody
    ) -> dict[str, tuple[Float, float]]:
        """Return the energy as seen from a circular orbit, and the angular momentum about an axis of revolution."""
        momentum = body.moments * angular_velocity
        largest = float(np.linalg.norm(momentum, axis=1).max())
        even = [k for k in range(3) if body.moments[k - 1] == body.moments[k - 2]]
        kept = {f"angular momentum about body axis {body.numbers[k]}": (momentum[:, k], largest) for k in even}
        if not self.ellipse.circular:
            return kept
        rate, normal = self.ellipse.motion, self.ellipse.axes[:, 2]
        places = self.ellipse.position(time)
        toward = quaternion.to_body(attitude, places / np.linalg.norm(places, axis=1)[:, None])
        kinetic = 0.5 * (momentum * angular_velocity).sum(axis=-1)
        potential = 1.5 * rate**2 * (body.moments * toward**2).sum(axis=-1)
        carried = rate * (quaternion.to_space(attitude, momentum) @ normal)
        size = float((kinetic + potential + np.abs(carried)).max())
        return kept | {"Jacobi integral": (kinetic + potential - carried, size)}

    def librations(
        self, attitude: Float, angular_velocity: Float, body: TurningBody
    ) -> tuple[dict[str, Float], tuple[str, ...]]:
        """Return the periods in s of small swings about the principal axes nearest to those of the orbit, and say them.

        With I₁, I₂, I₃ along the radius, across it in the plane and along the normal, a circular orbit has the rates
        ω² = 3 n² (I₂ − I₁)/I₃ in its plane and, out of it, ω⁴ − (1 + 3 a + a b) n² ω² + 4 a b n⁴ = 0 with a =
        (I₃ − I₁)/I₂ and b = (I₃ − I₂)/I₁; where they are not real, swings grow. Hughes (1986), § 9.2.

        Parameters
        ----------
        attitude : (4,) of the principal axes at t = 0; angular_velocity : (3,) rad/s along them
        body : whose principal moments and numbers of axes they are
        """
        ellipse = self.ellipse
        if ellipse.eccentricity > _SLENDER:
            return {}, ()
        turn = quaternion.matrix(ellipse.seen_from(np.zeros(1), attitude[None])["attitude in the orbit"][0])
        normal = int(np.argmax(np.abs(turn[2])))
        radial, along = sorted({0, 1, 2} - {normal}, key=lambda k: -abs(turn[0, k]))
        slip = angular_velocity - ellipse.motion * turn[2]
        near = min(abs(turn[0, radial]), abs(turn[1, along]), abs(turn[2, normal])) > math.sqrt(0.5)
        if not near or np.linalg.norm(slip) > ellipse.motion:
            return {}, ()
        one, two, three = (float(body.moments[k]) for k in (radial, along, normal))
        flat, a, b = (two - one) / three, (three - one) / two, (three - two) / one
        roots = np.roots([1.0, -(1.0 + 3.0 * a + a * b), 4.0 * a * b]).astype(complex)
        squares = np.array([3.0 * flat, *sorted(roots, key=lambda root: -root.real)])
        if (np.abs(squares) < _EVEN).any():
            return {}, ()
        how = (
            f"With axis {body.numbers[radial]} along the radius and axis {body.numbers[normal]} along the normal of a "
            "circular orbit, small"
        )
        growth = float(np.sqrt(-squares).real.max()) * ellipse.motion
        if growth > _EVEN * ellipse.motion:
            return {}, (f"{how} swings grow e-fold every {1.0 / growth:.4g} s.",)
        periods = 2.0 * math.pi / (np.sqrt(squares.real) * ellipse.motion)
        first, second, third = (f"{period:.6g}" for period in periods.tolist())
        names = ("in the plane", "out of the plane, fast", "out of the plane, slow")
        quantities = {f"libration period {name}": np.array(x) for name, x in zip(names, periods, strict=True)}
        return quantities, (f"{how} swings have periods of {first} s in its plane, {second} and {third} s out of it.",)

    def described(self, listed: Callable[[Float | float], str]) -> str:
        """Return the size and shape of the orbit, and its period."""
        ellipse = self.ellipse
        primary = f"the {self.mu}" if isinstance(self.mu, str) else f"μ = {listed(self.strength)} m³/s²"
        return (
            f"gravity gradient of {primary} on an orbit of semi-major axis {listed(ellipse.semi_major_axis)} m, "
            f"eccentricity {listed(0.0 if ellipse.circular else ellipse.eccentricity)}, period "
            f"{listed(sum(ellipse.period))} s"
        )

    def entries(self, principal_axes: Float) -> dict[str, Any]:
        """Return its section, without what is not stated."""
        stated = {each.name: getattr(self, each.name) for each in fields(self)}
        return {"kind": self.kind, **{name: value for name, value in stated.items() if value is not None}}


def _length(vector: Float) -> float:
    return float(np.linalg.norm(vector))
