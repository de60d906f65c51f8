"""An assembly as a swarm of particles, in mpmath: nothing here but where each of them is at what time.

Each part is four particles with its mass, centre of mass and tensor. Velocities are finite differences, sums are sums
over particles, and the attitude follows by Gragg–Bulirsch–Stoer extrapolation. Only the numbers that describe the
parts and their keyframes are taken from the package under test, none of its formulas.
"""

from collections.abc import Iterator, Sequence

import mpmath
import numpy as np
from mpmath import mpf

from inertia.dynamics.models.deforming.jointed_body import JointedBody
from inertia.dynamics.models.deforming.joints import Joint, JointedPart

DIGITS = 40
TICK = mpf(10) ** -14  # s, of the finite differences, whose error goes with its square
CORNERS = ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))

Vector = list[mpf]


def cross(a: Sequence[mpf], b: Sequence[mpf]) -> Vector:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a: Sequence[mpf], b: Sequence[mpf]) -> mpf:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def rotate(vector: Sequence[mpf], axis: Sequence[mpf], c: mpf, s: mpf) -> Vector:
    """Turn a vector by Rodrigues' formula, by an angle of this cosine and sine."""
    across, along = cross(axis, vector), dot(axis, vector) * (1 - c)
    return [c * v + s * w + along * a for v, w, a in zip(vector, across, axis, strict=True)]


def value(joint: Joint, time: mpf) -> mpf:
    """Return a joint's value by the quintic Hermite basis."""
    column = joint.angles if joint.revolute else joint.displacements
    times, values, rates = ([mpf(float(x)) for x in c] for c in (joint.times, column, joint.rates))
    if time <= times[0] or len(times) == 1:
        return values[0] + rates[0] * (time - times[0])
    if time >= times[-1]:
        return values[-1] + rates[-1] * (time - times[-1])
    k = max(i for i, t in enumerate(times) if t <= time)
    length = times[k + 1] - times[k]
    s = (time - times[k]) / length
    rise = s**3 * (10 - 15 * s + 6 * s**2)
    first = s * (1 - s) ** 3 * (1 + 3 * s)
    last = -(s**3) * (1 - s) * (4 - 3 * s)
    return values[k] * (1 - rise) + values[k + 1] * rise + length * (rates[k] * first + rates[k + 1] * last)


def pose(joint: Joint, time: mpf) -> tuple[Vector, Vector, mpf, mpf, mpf]:
    """Return axis and point of a joint, its value, and the cosine and sine of that."""
    axis, point = ([mpf(float(a)) for a in vector] for vector in (joint.axis, joint.point))
    size, moved = mpmath.sqrt(dot(axis, axis)), value(joint, time)
    return [a / size for a in axis], point, moved, mpmath.cos(moved), mpmath.sin(moved)


class Swarm:
    """The particles of an assembly."""

    def __init__(self, assembly: JointedBody, tick: mpf = TICK) -> None:
        self.tick = tick
        self.named = {part.name: part for part in assembly.parts}
        self.particles = [(part, m, x) for part in assembly.parts for m, x in self.split(part)]
        self.masses = [m for _, m, _ in self.particles]
        self.mass = sum(self.masses)
        self.known: dict[mpf, tuple[mpmath.matrix, Vector, mpf]] = {}

    @staticmethod
    def split(part: JointedPart) -> Iterator[tuple[mpf, Vector]]:
        with mpmath.workdps(DIGITS):
            tensor = mpmath.matrix(part.inertia.tolist())
            second = mpmath.eye(3) * sum(tensor[i, i] for i in range(3)) / 2 - tensor
            moments, axes = mpmath.eigsy(second)
            reach = [mpmath.sqrt(max(k, 0) / mpf(part.mass)) for k in moments]
            for corner in CORNERS:
                offset = axes * mpmath.matrix([r * c for r, c in zip(reach, corner, strict=True)])
                yield mpf(part.mass) / 4, [mpf(float(c)) + x for c, x in zip(part.center_of_mass, offset, strict=True)]

    def places(self, time: mpf) -> list[Vector]:
        """Return where the particles are, root axes."""
        poses = {joint: pose(joint, time) for part in self.named.values() for joint in part.joints}
        out = []
        for part, _, start in self.particles:
            x, at = start, part
            while at.parent is not None:
                for joint in reversed(at.joints):
                    axis, point, moved, c, s = poses[joint]
                    if joint.revolute:
                        arm = rotate([a - b for a, b in zip(x, point, strict=True)], axis, c, s)
                        x = [a + b for a, b in zip(arm, point, strict=True)]
                    else:
                        x = [a + b * moved for a, b in zip(x, axis, strict=True)]
                at = self.named[at.parent]
            out.append(x)
        return out

    def centered(self, time: mpf) -> list[Vector]:
        """Return the places relative to the centre of mass."""
        places = self.places(time)
        center = [sum(m * x[i] for m, x in zip(self.masses, places, strict=True)) / self.mass for i in range(3)]
        return [[a - b for a, b in zip(x, center, strict=True)] for x in places]

    def moments(self, time: mpf) -> tuple[mpmath.matrix, Vector, mpf]:
        """Return tensor, internal angular momentum and internal energy about the centre of mass, root axes."""
        before, after = (self.centered(time + k * self.tick) for k in (-1, 1))
        tensor, momentum, energy = [[mpf(0)] * 3 for _ in range(3)], [mpf(0)] * 3, mpf(0)
        for m, a, b in zip(self.masses, before, after, strict=True):
            x = [(p + q) / 2 for p, q in zip(b, a, strict=True)]
            v = [(p - q) / (2 * self.tick) for p, q in zip(b, a, strict=True)]
            momentum = [h + m * k for h, k in zip(momentum, cross(x, v), strict=True)]
            energy += m * dot(v, v) / 2
            square = dot(x, x)
            for i in range(3):
                for j in range(3):
                    tensor[i][j] += m * ((i == j) * square - x[i] * x[j])
        return mpmath.matrix(tensor), momentum, energy

    def spin(self, time: mpf, attitude: Vector, momentum: Vector) -> Vector:
        """Return ω in root axes, L (space) being given."""
        x, y, z, w = attitude
        u = [-x, -y, -z]
        twice = cross(u, [a + w * b for a, b in zip(cross(u, momentum), momentum, strict=True)])
        inside = [a + 2 * b for a, b in zip(momentum, twice, strict=True)]
        if time not in self.known:
            self.known[time] = self.moments(time)
        tensor, internal, _ = self.known[time]
        left, rows = [a - b for a, b in zip(inside, internal, strict=True)], tensor.tolist()
        columns = [cross(rows[i - 2], rows[i - 1]) for i in range(3)]
        size = dot(rows[0], columns[0])
        return [dot([column[k] for column in columns], left) / size for k in range(3)]

    def rate(self, time: mpf, attitude: Vector, momentum: Vector) -> Vector:
        """Return q̇ of a quaternion (x, y, z, w), root to space."""
        x, y, z, w = attitude
        a, b, c = self.spin(time, attitude, momentum)
        return [
            (w * a + y * c - z * b) / 2,
            (w * b + z * a - x * c) / 2,
            (w * c + x * b - y * a) / 2,
            -(x * a + y * b + z * c) / 2,
        ]

    def follow(
        self, momentum: Sequence[float], times: Sequence[float], step: float, start: Sequence[float] = (0, 0, 0, 1)
    ) -> np.ndarray:
        """Return attitudes (n, 4) of mpf at `times`, from t = 0 on; every keyframe must be one of the times."""
        columns = 10
        with mpmath.workdps(DIGITS):
            carried = [mpf(x) for x in momentum]
            q, now, out = [mpf(x) for x in start], mpf(0), []
            for end in map(mpf, times):
                pieces = max(1, int(mpmath.ceil((end - now) / step)))
                length = (end - now) / pieces
                for _ in range(pieces if length else 0):
                    rows: list[list[Vector]] = []
                    for j in range(columns):
                        row = [self._midpoint(now, q, carried, length, 2 * j + 2)]
                        for k in range(j):
                            ratio = (mpf(j + 1) / (j - k)) ** 2 - 1
                            pairs = zip(row[k], rows[j - 1][k], strict=True)
                            row.append([a + (a - b) / ratio for a, b in pairs])
                        rows.append(row)
                    q, now = rows[-1][-1], now + length
                out.append(q)
            return np.array(out, dtype=object)

    def _midpoint(self, time: mpf, q: Vector, momentum: Vector, length: mpf, count: int) -> Vector:
        h = length / count
        a, b = q, [x + h * y for x, y in zip(q, self.rate(time, q, momentum), strict=True)]
        for k in range(1, count):
            a, b = b, [x + 2 * h * y for x, y in zip(a, self.rate(time + length * k / count, b, momentum), strict=True)]
        return [(x + y + h * z) / 2 for x, y, z in zip(a, b, self.rate(time + length, b, momentum), strict=True)]


def apart(attitude: np.ndarray, true: np.ndarray) -> float:
    """Return the largest angle in rad between float64 attitudes (n, 4) and true ones."""
    worst = mpf(0)
    with mpmath.workdps(DIGITS):
        for p, q in zip(attitude.tolist(), true.tolist(), strict=True):
            p, q = ([mpf(x) / mpmath.norm(list(map(mpf, r))) for x in r] for r in (p, q))
            sign = 1 if sum(a * b for a, b in zip(p, q, strict=True)) > 0 else -1
            chord = mpmath.norm([a - sign * b for a, b in zip(p, q, strict=True)])
            worst = max(worst, 4 * mpmath.asin(chord / 2))
    return float(worst)
