"""Mistakes made on purpose in what is stated of real links, and whether the audit names them.

Nothing here is computed by the code that is tried: mass properties come from sums over triangles in extended precision,
each mistake is a few lines of numpy. A link's meshes are taken as they are placed; what is stated of them is true
but for the mistake and the noise.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.auditing.bodies import Body, Shape
from inertia.auditing.claim import Context, Statement, difference
from inertia.auditing.judge import LinkAudit, Subject, Weighed, judge
from inertia.auditing.search import EXPLAINED, explain
from inertia.mass.properties import ErrorBound, MassProperties

NOISE = (0.0, 0.001, 0.01)
SEEN = 3 * EXPLAINED
"""A mistake that changes less cannot be told from noise at the tolerance, and is not made."""
SAME = 0.005
"""Statements that differ by less cannot be told from one another at the noise there is."""
INCH, POUND = 0.0254, 0.45359237


@dataclass(frozen=True)
class Stated:
    """What is written down of a link: bodies as (mass, centre, tensor), then the whole of them."""

    bodies: tuple[tuple[float, Float, Float], ...]
    mass: float = 0.0
    center: Float | None = None
    inertia: Float | None = None
    steiner: bool = True
    mass_stays: bool = True

    def whole(self) -> Stated:
        """Return it put together, with the mass it had."""
        mass = sum(m for m, _, _ in self.bodies)
        center = sum((m * c for m, c, _ in self.bodies), np.zeros(3)) / mass
        inertia = sum((i for _, _, i in self.bodies), np.zeros((3, 3)))
        if self.steiner:
            inertia = inertia + sum(m * _point(c - center) for m, c, _ in self.bodies)
        factor = self.mass / mass if self.mass_stays and self.mass else 1.0
        return replace(self, mass=factor * mass, center=center, inertia=factor * inertia)


Change = Callable[[Stated], Stated]


@dataclass(frozen=True)
class Made:
    """A mistake: its code, when it is made (0 to the bodies, 1 to the whole, 2 to its units), and what it does."""

    code: str
    stage: int
    change: Change


def _point(way: Float) -> Float:
    return np.asarray(way @ way * np.eye(3) - np.outer(way, way))


def solid(corners: Float) -> tuple[float, Float, Float]:
    """Return volume, centre and tensor about it of the solid that triangles (m, 3, 3) enclose."""
    t = corners.astype(np.longdouble)
    origin = t.mean(axis=(0, 1))
    t = t - origin
    a, b, c = t[:, 0], t[:, 1], t[:, 2]
    six = (a * np.cross(b, c)).sum(axis=1)
    volume = six.sum() / 6
    total = a + b + c
    center = (six[:, None] * total).sum(axis=0) / 24 / volume
    second = sum((six[:, None] * x).T @ x for x in (a, b, c, total)) / 120
    second = second - volume * np.outer(center, center)
    tensor = np.trace(second) * np.eye(3) - second
    return float(volume), np.asarray(center + origin, float), np.asarray(tensor, float)


def shell(corners: Float) -> tuple[float, Float, Float]:
    """Return the same of the surface itself, by three points a triangle (exact for second moments)."""
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    points = (corners + np.roll(corners, 1, axis=1)) / 2  # the middles of the edges
    weights = np.repeat(areas / 3, 3)
    places = points.reshape(-1, 3)
    center = (weights[:, None] * places).sum(axis=0) / weights.sum()
    ways = places - center
    second = (weights[:, None] * ways).T @ ways
    return float(weights.sum()), center, np.trace(second) * np.eye(3) - second


def box(corners: Float) -> tuple[float, Float, Float]:
    """Return the same of the box around triangles, along the axes they are given in."""
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    x, y, z = high - low
    volume = x * y * z
    return volume, (low + high) / 2, volume / 12 * np.diag([y * y + z * z, x * x + z * z, x * x + y * y])


def hull(corners: Float) -> tuple[float, Float, Float]:
    """Return the same of the convex hull."""
    from scipy.spatial import ConvexHull

    around = ConvexHull(np.unique(corners.reshape(-1, 3), axis=0))
    triangles = around.points[around.simplices]
    middle = around.points[around.vertices].mean(axis=0)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    inward = ((triangles[:, 0] - middle) * normals).sum(axis=1) < 0
    triangles[inward] = triangles[inward, ::-1]
    return solid(triangles)


def ways(shapes: Sequence[Shape], density: float, rotation: Float, rng: random.Random) -> list[Made]:
    """Return a mistake of each kind that can be made with a link, its details chosen at random.

    `rotation` (3, 3) are the axes that the tensor is written along.
    """

    def instead(of: Callable[[Float], tuple[float, Float, Float]]) -> Change:
        return lambda stated: replace(stated, bodies=tuple(of(shape.corners) for shape in shapes))

    def about_bodies(of: Callable[[int, tuple[float, Float, Float]], tuple[float, Float, Float]]) -> Change:
        return lambda stated: replace(stated, bodies=tuple(of(k, body) for k, body in enumerate(stated.bodies)))

    def tensor(of: Callable[[Stated, Float], Float]) -> Change:
        return lambda stated: replace(stated, inertia=of(stated, np.asarray(stated.inertia)))

    def in_axes(of: Callable[[Float], Float]) -> Change:
        return tensor(lambda _, inertia: rotation @ of(rotation.T @ inertia @ rotation) @ rotation.T)

    signs = rng.choice([(-1, -1, -1)] * 3 + [(-1, 1, 1), (1, -1, 1), (1, 1, -1), (-1, -1, 1), (1, -1, -1)])
    pattern = np.array([[1, signs[0], signs[1]], [signs[0], 1, signs[2]], [signs[1], signs[2], 1]])
    order = rng.choice(list(permutations(range(3))))
    turn = np.eye(3)[list(rng.choice(list(permutations(range(3)))[1:]))]
    mirror = np.ones(3)
    mirror[rng.randrange(3)] = -1
    quarter = np.roll(np.roll(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), (k := rng.randrange(3)), 0), k, 1)
    inertia_factor = rng.choice([1e6, 1e-6, 1e4, 1e9, INCH**-2])
    both = rng.choice([(1e3, 1e6), (1 / INCH, INCH**-2), (1e3, 1.0)])
    mass_factor = rng.choice([1e3, 1e-3])

    def conjugated(inertia: Float) -> Float:
        axes = np.linalg.eigh(inertia)[1]
        axes = axes * [1, 1, np.linalg.det(axes)]
        return np.asarray(axes.T @ (axes.T @ inertia @ axes) @ axes)

    def box_of(corners_of: Shape) -> tuple[float, Float, Float]:
        volume, center, inertia = box((corners_of.corners - corners_of.origin) @ corners_of.rotation)
        own = corners_of.rotation
        return volume, own @ center + corners_of.origin, own @ inertia @ own.T

    made = [
        Made("product_signs", 1, in_axes(lambda inertia: inertia * pattern)),
        Made("about_origin", 1, tensor(lambda s, inertia: inertia + s.mass * _point(np.asarray(s.center)))),
        Made("center_at_origin", 1, lambda stated: replace(stated, center=np.zeros(3))),
        Made(
            "principal_moments_as_diagonal",
            1,
            in_axes(lambda inertia: np.diag(np.linalg.eigvalsh(inertia)[list(order)])),
        ),
        Made("principal_moments_as_diagonal", 1, tensor(lambda _, inertia: conjugated(inertia))),
        Made("axes_permuted", 1, tensor(lambda _, inertia: turn @ inertia @ turn.T)),
        Made("shell_for_solid", 0, instead(shell)),
        Made("hull_for_mesh", 0, instead(hull)),
        Made("hull_for_mesh", 0, lambda stated: replace(stated, bodies=tuple(map(box_of, shapes)))),
        Made(
            "mirrored",
            0,
            about_bodies(lambda _, body: (body[0], body[1] * mirror, body[2] * np.outer(mirror, mirror))),
        ),
        Made(
            "mesh_turned",
            0,
            about_bodies(
                lambda k, body: (
                    body[0],
                    (way := shapes[k].rotation @ quarter @ shapes[k].rotation.T) @ (body[1] - shapes[k].origin)
                    + shapes[k].origin,
                    way @ body[2] @ way.T,
                )
            ),
        ),
        Made("unit_scale", 2, tensor(lambda _, inertia: inertia * inertia_factor)),
        Made(
            "unit_scale",
            2,
            lambda s: replace(s, center=np.asarray(s.center) * both[0], inertia=np.asarray(s.inertia) * both[1]),
        ),
        Made("mass_scale", 2, tensor(lambda _, inertia: inertia * mass_factor)),
        Made("mass_scale", 2, lambda stated: replace(stated, mass=stated.mass * mass_factor)),
        Made("unphysical", 2, tensor(lambda _, inertia: np.eye(3) * np.trace(inertia) / 3)),
        Made("placeholder", 2, tensor(lambda _, inertia: np.eye(3) * rng.choice([1.0, 0.1, 1e-3, 1e-5]))),
    ]
    if abs(rotation - np.eye(3)).max() > 0.01:
        made.append(Made("axes_permuted", 1, tensor(lambda _, inertia: rotation @ inertia @ rotation.T)))
    moved = [shape for shape in shapes[:3] if abs(shape.rotation - np.eye(3)).max() > 0.01 or shape.origin.any()]
    if moved:
        frame = rng.choice(moved)
        made.append(
            Made(
                "mesh_frame",
                1,
                lambda s: replace(
                    s,
                    center=frame.rotation.T @ (np.asarray(s.center) - frame.origin),
                    inertia=frame.rotation.T @ np.asarray(s.inertia) @ frame.rotation,
                ),
            )
        )
    if len(shapes) > 1:
        made.append(Made("missing_steiner", 0, lambda stated: replace(stated, steiner=False)))
    if 1 < len(shapes) <= 12:
        number = rng.randrange(len(shapes))

        def rest(stated: Stated) -> Stated:
            _, center, inertia = stated.bodies[number]
            return replace(
                stated,
                bodies=(*stated.bodies[:number], (0.0, center, 0 * inertia), *stated.bodies[number + 1 :]),
            )

        def twice(stated: Stated) -> Stated:
            mass, center, inertia = stated.bodies[number]
            return replace(
                stated,
                bodies=(*stated.bodies[:number], (2 * mass, center, 2 * inertia), *stated.bodies[number + 1 :]),
            )

        made += [Made("mesh_left_out", 0, rest), Made("mesh_counted_twice", 0, twice)]
    return made


def tried(shapes: Sequence[Shape], count: int, rng: random.Random) -> Iterator[dict[str, Any]]:
    """Make mistakes with a link, alone and in pairs, with each noise; yield what was made and what came of it."""
    density = 10 ** rng.uniform(2.3, 3.9)
    rotation = np.eye(3) if rng.random() < 0.8 else _rotation(rng)
    bodies = tuple((v, c, i) for v, c, i in (solid(shape.corners) for shape in shapes))
    if any(
        abs(shape.solid.mass - volume) > 1e-6 * volume for shape, (volume, _, _) in zip(shapes, bodies, strict=True)
    ):
        return  # a round primitive is no polyhedron
    mass = density * sum(volume for volume, _, _ in bodies)
    truth = Stated(bodies, mass)
    subject = Subject("link", None, [_weighed(shape) for shape in shapes])

    def audited(stated: Stated, noise: float) -> tuple[LinkAudit, Context]:
        body = _noisy(Body(stated.mass, np.asarray(stated.center), np.asarray(stated.inertia)), noise, rotation, rng)
        about = replace(subject, stated=Statement(body, rotation))
        context = about.context
        assert context is not None
        return judge(about, (), EXPLAINED), context

    for noise in NOISE:
        result, _ = audited(truth.whole(), noise)
        yield {"made": [], "noise": noise, "outcome": "quiet" if result.state == "consistent" else "false alarm"}
        for number in range(count):
            mistakes = _some(ways(shapes, density, rotation, rng), 1 + number % 2, rng)
            stated = _seen(truth, mistakes, shapes)
            if stated is None:
                continue
            typed = any(mistake.code == "placeholder" for mistake in mistakes)  # by somebody, without noise
            result, context = audited(stated, 0.0 if typed else noise)
            codes = {mistake.code for mistake in mistakes}
            named = {finding.code for finding in result.findings}
            yield {
                "made": sorted(codes),
                "noise": noise,
                "outcome": _outcome(codes, result, context, stated),
                "named": sorted(named - {"alike", "outside_hull"}),
            }
        result, context = audited(_hollow(truth, shapes, rng), noise)
        if context.truth.residual > EXPLAINED:
            search = {finding.code for finding in result.findings} - {"unexplained", "ambiguous", "outside_hull"}
            yield {
                "made": ["hollow"],
                "noise": noise,
                "outcome": "wrong" if search else "quiet",
                "named": sorted(search),
            }


def _weighed(shape: Shape) -> Weighed:
    error = ErrorBound("benchmark", 1e-12, 1e-12, 0.0, 1e-12)
    body = shape.solid
    return Weighed(shape, MassProperties(body.mass, body.mass, body.center, body.inertia, error))


def _some(mistakes: list[Made], count: int, rng: random.Random) -> list[Made]:
    """Choose mistakes of different kinds; a placeholder covers whatever else is wrong of a tensor."""
    by_code: dict[str, list[Made]] = {}
    for mistake in mistakes:
        by_code.setdefault(mistake.code, []).append(mistake)
    if count > 1:
        by_code.pop("placeholder")
    codes = rng.sample(sorted(by_code), min(count, len(by_code)))
    return sorted((rng.choice(by_code[code]) for code in codes), key=lambda mistake: mistake.stage)


def _with(truth: Stated, mistakes: Sequence[Made]) -> Stated:
    stated = truth
    for mistake in mistakes:
        if mistake.stage == 0:
            stated = mistake.change(stated)
    stated = stated.whole()
    for mistake in mistakes:
        if mistake.stage > 0:
            stated = mistake.change(stated)
    return stated


def _seen(truth: Stated, mistakes: Sequence[Made], shapes: Sequence[Shape]) -> Stated | None:
    """Return what is stated with mistakes; None where one of them makes no difference that could be seen."""
    stated = _with(truth, mistakes)
    corners = np.concatenate([shape.corners.reshape(-1, 3) for shape in shapes])
    size = float(np.linalg.norm(np.ptp(corners, axis=0)))
    for k in range(len(mistakes)):
        if _difference(stated, _with(truth, [*mistakes[:k], *mistakes[k + 1 :]]), size) <= SEEN:
            return None
    return stated if np.isfinite(np.asarray(stated.inertia)).all() else None


def _difference(one: Stated, other: Stated, size: float) -> float:
    tensors = [np.asarray(each.inertia) for each in (one, other)]
    norms = max(float(np.linalg.norm(tensor)) for tensor in tensors)
    return max(
        abs(one.mass - other.mass) / max(one.mass, other.mass),
        float(np.linalg.norm(tensors[0] - tensors[1])) / norms,
        float(np.linalg.norm(np.asarray(one.center) - np.asarray(other.center))) / size,
    )


def _noisy(body: Body, noise: float, rotation: Float, rng: random.Random) -> Body:
    """Return a body whose numbers, as they are written, are wrong by up to `noise` of each, if that can be one."""

    def blurred(values: Float) -> Float:
        return values * (1 + noise * np.array([rng.uniform(-1, 1) for _ in range(values.size)]).reshape(values.shape))

    center = blurred(body.center)
    sound = _possible(body.inertia)
    for _ in range(30):
        inertia = np.tril(blurred(rotation.T @ body.inertia @ rotation))
        inertia = rotation @ (inertia + np.tril(inertia, -1).T) @ rotation.T
        if _possible(inertia) or not sound:
            return Body(body.mass, center, inertia)
    return body._replace(center=center)


def _possible(inertia: Float) -> bool:
    least, middle, greatest = np.linalg.eigvalsh(inertia)
    return bool(least > 0 and least + middle >= greatest)


def _outcome(codes: set[str], result: LinkAudit, context: Context, stated: Stated) -> str:
    named = {finding.code for finding in result.findings} - {"outside_hull", "alike"}
    if codes <= named or (result.state == "unphysical" and "unphysical" in codes):
        return "named"
    if result.state == "consistent":
        return "consistent"
    if "ambiguous" in named:
        return "ambiguous"
    if named <= {"unexplained", "unphysical", "undecided"}:
        return "unphysical" if "unphysical" in named else "unexplained"
    search = explain(context)
    if search.named is not None:
        if any(codes == each.codes for each in search.named.alike):
            return "named"
        body = Body(stated.mass, np.asarray(stated.center), np.asarray(stated.inertia))
        if difference(context, search.named.body, body) <= SAME:
            return "same"
    return "wrong"


def _hollow(truth: Stated, shapes: Sequence[Shape], rng: random.Random) -> Stated:
    """Return what a link has whose mass is partly in its skin, partly in two motors near its corners."""
    corners = np.concatenate([shape.corners for shape in shapes])
    size = float(np.linalg.norm(np.ptp(corners, axis=(0, 1))))
    whole, skin = truth.whole(), shell(corners)
    share = rng.uniform(0.1, 0.5) * whole.mass / skin[0]
    solids = rng.uniform(0.2, 1) * whole.mass / sum(volume for volume, _, _ in truth.bodies)
    bodies = [(solids * v, c, solids * i) for v, c, i in truth.bodies]
    bodies.append((share * skin[0], skin[1], share * skin[2]))
    for _ in range(2):
        place = np.mean([corners.reshape(-1, 3)[rng.randrange(3 * len(corners))] for _ in range(3)], axis=0)
        mass = whole.mass * rng.uniform(0.1, 0.6)
        bodies.append((mass, place, mass * (0.05 * size) ** 2 * np.eye(3)))
    return Stated(tuple(bodies), truth.mass).whole()


def _rotation(rng: random.Random) -> Float:
    matrix = np.linalg.qr(np.array([[rng.gauss(0, 1) for _ in range(3)] for _ in range(3)]))[0]
    return np.asarray(matrix * np.sign(np.linalg.det(matrix)))
