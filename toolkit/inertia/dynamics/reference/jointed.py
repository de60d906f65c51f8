"""Equations of a free body whose joints move as prescribed, with exact figures.

Along the axes of the root part: q̇ = ½ q I⁻¹(t) (qᵀ L q − h(t)), as in `inertia.dynamics.models.deforming.motion`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from inertia.dynamics.models.deforming.jointed_body import JointedBody
from inertia.dynamics.models.deforming.joints import Joint
from inertia.dynamics.models.model import Problem
from inertia.dynamics.models.rational import dot as inner
from inertia.dynamics.models.rational import rationals, root
from inertia.dynamics.reference import long
from inertia.dynamics.reference.collocation import Equations, Maker, Rates
from inertia.dynamics.reference.long import Long, Number, exactly
from inertia.dynamics.reference.rigid import IDENTITY

Tensor = Sequence[Sequence[Number]]


class _Pose(NamedTuple):
    """x ↦ R x + place, moving as v(x) = speed + spin × x, root axes."""

    turn: Sequence[Number]
    place: Sequence[Number]
    spin: Sequence[Number]
    speed: Sequence[Number]


def jointed_equations(problem: Problem) -> Equations | None:
    """Return the equations of the attitude P of the root to where it is at t = 0."""
    assembly, exact = problem.scene.body.assembly, problem.exact
    if assembly is None:
        return None
    tensor, inside = _shape(assembly, Long.of, 0.0)(Long(0.0))
    momentum = [x + y for x, y in zip(long.times(tensor, exactly(exact.spin)), inside, strict=True)]
    plain = [float(each.high) for each in momentum]
    first = exactly(exact.attitude)

    def rates(number: Maker, begin: float) -> Rates:
        shape = _shape(assembly, number, begin)
        carried = plain if number is float else momentum
        last: list[Any] = [None, None]  # what goes with the time alone is wanted at the same times again

        def of(time: Number, state: Sequence[Number]) -> Sequence[Number]:
            if last[0] is not time:
                last[:] = time, shape(time)
            tensor, inside = last[1]
            own = [x - y for x, y in zip(long.rotated(long.back(state), carried), inside, strict=True)]
            return long.spun(state, long.solution(tensor, own))

        return of

    return Equations(IDENTITY, np.ones(4), rates, lambda state: long.product(first, state), assembly.keyframes)


def _shape(assembly: JointedBody, number: Maker, begin: float) -> Callable[[Number], tuple[Tensor, list[Number]]]:
    """Return a function of the time that gives the tensor about the centre of mass and the momentum within."""
    zero, one = number(Fraction(0)), number(Fraction(1))
    joints = {joint: _hung(joint, number, begin) for joint in assembly.joints}
    parts = [assembly.parts[k] for k in assembly.order]
    masses = [number(Fraction(part.mass)) for part in parts]
    share = number(1 / sum((Fraction(part.mass) for part in parts), Fraction(0)))
    tensors = [[[number(Fraction(float(x))) for x in row] for row in part.inertia] for part in parts]
    centers = [[number(k) for k in rationals(part.center_of_mass)] for part in parts]
    rest = _Pose([zero, zero, zero, one], [zero] * 3, [zero] * 3, [zero] * 3)

    def at(time: Number) -> tuple[Tensor, list[Number]]:
        poses: dict[str | None, _Pose] = {None: rest}
        places, speeds = [], []
        for part, center in zip(parts, centers, strict=True):
            pose = poses[part.parent]
            for joint in part.joints:
                pose = joints[joint](pose, time)
            poses[part.name] = pose
            places.append([x + y for x, y in zip(long.rotated(pose.turn, center), pose.place, strict=True)])
            speeds.append([x + y for x, y in zip(pose.speed, long.cross(pose.spin, places[-1]), strict=True)])
        middle, drift = ([share * _sum(masses, rows, k) for k in range(3)] for rows in (places, speeds))
        whole: list[list[Number]] = [[zero] * 3 for _ in range(3)]
        inside = [zero] * 3
        for part, mass, own, place, speed in zip(parts, masses, tensors, places, speeds, strict=True):
            pose = poses[part.name]
            arm, slip = ([x - y for x, y in zip(*each, strict=True)] for each in ((place, middle), (speed, drift)))
            columns = [long.rotated(pose.turn, row) for row in own]  # R I, column by column
            turned = [long.rotated(pose.turn, row) for row in zip(*columns, strict=True)]
            orbital = long.shifted(mass, arm)
            rows = zip(whole, turned, orbital, strict=True)
            whole = [[a + b + c for a, b, c in zip(*row, strict=True)] for row in rows]
            spun, swept = long.times(turned, pose.spin), long.cross(arm, slip)
            inside = [a + b + mass * c for a, b, c in zip(inside, spun, swept, strict=True)]
        return whole, inside

    return at


def _sum(masses: Sequence[Number], rows: Sequence[Sequence[Number]], k: int) -> Number:
    total = masses[0] * rows[0][k]
    for mass, row in zip(masses[1:], rows[1:], strict=True):
        total = total + mass * row[k]
    return total


def _hung(joint: Joint, number: Maker, begin: float) -> Callable[[_Pose, Number], _Pose]:
    """Return what hangs a joint on a pose, from the instant `begin` to the next keyframe."""
    typed = rationals(joint.typed_axis)
    size = root(inner(typed, typed))
    axis = [number(k / size) for k in typed]
    point = [number(k) for k in rationals(joint.point)]
    times, (values, rates) = joint.times, joint.columns
    k = int(np.searchsorted(times, begin, side="right")) - 1
    inside = 0 <= k < len(times) - 1
    k = max(k, 0)
    since, value, rate = (Fraction(float(each[k])) for each in (times, values, rates))
    powers = [value, rate]
    if inside:
        length = Fraction(float(times[k + 1])) - since
        rise = Fraction(float(values[k + 1])) - value - rate * length
        gain = (Fraction(float(rates[k + 1])) - rate) * length
        last = 10 * rise - 4 * gain, 7 * gain - 15 * rise, 6 * rise - 3 * gain
        powers += [Fraction(0), *(each / length ** (3 + j) for j, each in enumerate(last))]
    terms, slopes = [number(p) for p in powers], [number(j * p) for j, p in enumerate(powers)][1:]
    origin = number(since)

    def hang(pose: _Pose, time: Number) -> _Pose:
        after = time - origin
        moved, speed = _polynomial(terms, after), _polynomial(slopes, after)
        along = long.rotated(pose.turn, axis)
        if not joint.revolute:
            place = [p + moved * a for p, a in zip(pose.place, along, strict=True)]
            velocity = [v + speed * a for v, a in zip(pose.speed, along, strict=True)]
            return _Pose(pose.turn, place, pose.spin, velocity)
        sine, cosine = long.turn_of(0.5 * moved)
        turn = long.product(pose.turn, [*(sine * a for a in axis), cosine])
        through = [x + y for x, y in zip(long.rotated(pose.turn, point), pose.place, strict=True)]
        place = [x - y for x, y in zip(through, long.rotated(turn, point), strict=True)]
        own = [speed * a for a in along]
        velocity = [x + y for x, y in zip(pose.speed, long.cross(through, own), strict=True)]
        return _Pose(turn, place, [x + y for x, y in zip(pose.spin, own, strict=True)], velocity)

    return hang


def _polynomial(terms: Sequence[Number], x: Number) -> Number:
    total = terms[-1]
    for term in terms[-2::-1]:
        total = total * x + term
    return total
