"""Every verb of the algebra, in random chains of ten from mesh-made bodies, is within its bounds (in rationals)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import pytest
from tests.mesh.solids import box, joined, sphere

import inertia
from inertia.errors import GeometryError, InertiaError, UsageError
from inertia.mass.properties import ErrorBound, MassProperties
from inertia_meshes import rational

F = Fraction
DENSITY = 1000
FIGURES = ("mass", "volume", "center_of_mass", "inertia", "about")


@dataclass(frozen=True)
class Body:
    """A body and what it is in truth: its volume, and its moments of mass about the origin of its frame."""

    properties: MassProperties
    volume: Fraction
    moments: rational.Moments

    @classmethod
    def of(cls, vertices: np.ndarray, faces: np.ndarray) -> Body:
        properties = inertia.mass_properties(inertia.Part.from_arrays(vertices, faces))
        moments = rational.moments(vertices[faces])
        return cls(properties, moments.volume, moments.weighted(DENSITY))

    def plus(self, other: Body) -> Body:
        return Body(self.properties + other.properties, self.volume + other.volume, self.moments + other.moments)

    def minus(self, other: Body) -> Body:
        return Body(self.properties - other.properties, self.volume - other.volume, self.moments - other.moments)

    def weighing(self, mass: float) -> Body:
        scaled = self.moments.weighted(F(mass) / self.moments.volume)
        return Body(self.properties.with_mass(mass), self.volume, scaled)

    def seen_from(self, axes: np.ndarray, origin: list[float]) -> Body:
        columns = [[F(k) for k in column] for column in axes.T.tolist()]
        moved = self.moments.moved(*(-F(k) for k in origin)).mapped(columns)
        return Body(self.properties.expressed_in(axes, origin), self.volume, moved)

    def ratios(self, point: list[float]) -> dict[str, float]:
        """Return the true error over the bound of each figure."""
        properties, moments = self.properties, self.moments
        error = properties.error
        tensor, bound = properties.about_with_bound(point)
        there = moments.moved(*(-F(k) for k in point)).second
        xx, yy, zz, yz, zx, xy = there
        about = [yy + zz, -xy, -zx, -xy, zz + xx, -yz, -zx, -yz, xx + yy]
        central = [k for row in moments.inertia for k in row]
        return {
            "mass": ratio([properties.mass], [moments.volume], error.mass, relative=True),
            "volume": ratio([properties.volume], [self.volume], error.volume, relative=True),
            "center_of_mass": ratio(
                properties.center_of_mass.tolist(), moments.center_of_mass, error.center_of_mass, relative=False
            ),
            "inertia": ratio(properties.inertia.ravel().tolist(), central, error.inertia, relative=True),
            "about": ratio(tensor.ravel().tolist(), about, bound, relative=True),
        }


def ratio(values: list[float], truth: object, bound: float, *, relative: bool) -> float:
    numbers = [F(k) for k in values]
    error = sum((a - b) ** 2 for a, b in zip(numbers, truth, strict=True))
    if math.isinf(bound) or not error:
        return 0.0
    allowed = F(bound) ** 2 * (sum(k * k for k in numbers) if relative else 1)
    return math.inf if error > 10**30 * allowed else math.sqrt(error / allowed)


def rotation(rng: np.random.Generator) -> np.ndarray:
    q: np.ndarray = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return q * np.linalg.det(q)


def mesh(rng: np.random.Generator, kind: str) -> tuple[np.ndarray, np.ndarray]:
    vertices, faces = sphere(splits=int(rng.integers(0, 2)))
    vertices = vertices * rng.uniform(0.5, 1, (len(vertices), 1))
    if kind == "needle":
        vertices = vertices * [1, *10.0 ** -rng.uniform(1, 4, 2)]
    if kind == "thin wall":
        vertices = vertices * [1, 1, 10.0 ** -rng.uniform(2, 7)]
    vertices = vertices @ rotation(rng).T + rng.normal(size=3)
    if kind == "far away":
        vertices = vertices + rng.normal(size=3) * 10.0 ** rng.uniform(1, 6)
    power = {"tiny": (-61, -20), "hardly there": (-64.3, -61), "huge": (20, 55)}.get(kind, (0, 0))
    return vertices * 10.0 ** rng.uniform(*power), faces


def another(body: Body, rng: np.random.Generator, verb: str, kind: str) -> Body:
    if verb == "add":
        return body.plus(Body.of(*mesh(rng, kind)))
    if verb == "cut":
        return body.minus(Body.of(*mesh(rng, kind)).weighing(body.properties.mass * 10.0 ** -rng.uniform(0.5, 8)))
    if verb == "double":
        return body.plus(body)
    if verb == "turn":
        return body.seen_from(rotation(rng), (body.properties.center_of_mass * rng.normal(size=3)).tolist())
    if verb == "swap axes":
        axes = np.eye(3)[rng.permutation(3)]
        axes[:, 0] *= np.linalg.det(axes)
        return body.seen_from(axes, body.properties.center_of_mass.tolist())
    if verb == "shift":
        far = 10.0 ** rng.uniform(-3, 6) * float(np.abs(body.properties.center_of_mass).max())
        return body.seen_from(np.eye(3), (far * rng.normal(size=3)).tolist())
    if verb == "weigh":
        return body.weighing(body.properties.mass * 10.0 ** rng.uniform(-3, 3))
    return body.weighing(10.0 ** -rng.uniform(300, 323))


VERBS = ("add", "cut", "double", "turn", "swap axes", "shift", "weigh", "weigh nothing")


@pytest.mark.parametrize("kind", ["ordinary", "needle", "thin wall", "far away", "tiny", "hardly there", "huge"])
def test_chains_of_ten_verbs_stay_within_their_bounds(kind: str) -> None:
    worst = dict.fromkeys(FIGURES, 0.0)
    verbs_done = set()
    for seed in range(12):
        rng = np.random.default_rng(seed)
        body = Body.of(*mesh(rng, "tiny" if kind == "hardly there" and seed % 2 else kind))
        for verb in rng.choice(VERBS, 10, p=[0.14] * 7 + [0.02]):
            try:
                body = another(body, rng, verb, kind if rng.random() < 0.7 else "ordinary")
            except InertiaError:
                continue  # refused: what is left has no mass, or leaves float64
            verbs_done.add(verb)
            point = body.properties.center_of_mass * (1 + 10.0 ** rng.uniform(-8, 3) * rng.normal(size=3))
            try:
                ratios = body.ratios(point.tolist())
            except UsageError:
                continue  # above float64 about that point
            assert max(ratios.values()) <= 1, (seed, verb, ratios, body.properties.error)
            worst = {name: max(worst[name], ratios[name]) for name in FIGURES}
    assert len(verbs_done) >= 7
    assert min(worst.values()) > 0.03  # the bounds are no larger than the errors explain


@pytest.mark.parametrize("kind", ["ordinary", "needle", "thin wall", "far away"])
def test_twice_a_body_and_one_with_a_hole_are_within_their_bounds(kind: str) -> None:
    """Only the centre of mass of what was integrated is uncertain here, and it was left out once."""
    for seed in range(25):
        rng = np.random.default_rng(seed)
        vertices, faces = mesh(rng, kind)
        middle = vertices.mean(axis=0)
        body, hole = Body.of(vertices, faces), Body.of(middle + 0.5 * (vertices - middle), faces)
        for made in (body.plus(body), body.minus(hole)):
            assert max(made.ratios([0.0, 0.0, 0.0]).values()) <= 1, seed


def repeated(body: MassProperties, verb: Callable[[MassProperties], MassProperties], times: int) -> MassProperties:
    for _ in range(times):
        body = verb(body)
    return body


def test_the_bounds_of_many_turns_and_sums_do_not_run_away() -> None:
    """Turned element by element, a bound is up to three times as large each time: 3³⁰ after thirty links of a chain."""
    rng = np.random.default_rng(7)
    link = inertia.mass_properties(inertia.Part.from_arrays(*mesh(rng, "ordinary")))
    chain = repeated(link, lambda body: (body + link).expressed_in(rotation(rng), [0.1, 0.2, 0.3]), 30)
    assert chain.error.inertia < 1e-12
    assert chain.error.center_of_mass < 1e-12
    assert repeated(link, lambda body: body.expressed_in(rotation(rng)), 100).error.inertia < 3e-12


def test_axes_that_are_exact_cost_nothing() -> None:
    vertices, faces = mesh(np.random.default_rng(3), "needle")
    body = inertia.mass_properties(inertia.Part.from_arrays(vertices, faces), accuracy="exact")
    turned = body.expressed_in([[0, 0, 1], [1, 0, 0], [0, 1, 0]], [1e3, 1e3, 1e3])
    assert turned.error == body.error.__class__(
        body.error.method, body.error.volume, body.error.mass, turned.error.center_of_mass, body.error.inertia
    )
    assert turned.principal_moments.tolist() == body.principal_moments.tolist()
    assert turned.principal.moment_bounds.tolist() == body.principal.moment_bounds.tolist()


def test_what_is_given_keeps_its_error_in_another_frame() -> None:
    body = MassProperties(2.0, 1.0, [1, 2, 3], np.diag([1.0, 1.5, 2.0]), ErrorBound("measured", 0.0, 0.0, 1e-4, 1e-3))
    turned = repeated(body, lambda each: each.expressed_in(rotation(np.random.default_rng(1)), [1, 0, 0]), 10)
    assert turned.error.inertia == pytest.approx(1e-3, rel=1e-2)
    assert turned.error.center_of_mass == pytest.approx(1e-4, rel=1e-6)


@pytest.mark.parametrize("mass", [1e-300, 1e-315, 1e-321])
def test_a_mass_at_the_end_of_float64_says_what_it_cost(mass: float) -> None:
    body = Body.of(*joined_box(3.0)).weighing(mass)
    assert max(body.ratios([0.0, 0.0, 0.0]).values()) <= 1
    assert body.properties.error.mass == 0.0
    again = body.weighing(1.0)
    assert max(again.ratios([0.0, 0.0, 0.0]).values()) <= 1
    assert again.properties.error.inertia < 1e-13


@pytest.mark.parametrize("mass", [1e-322, 1e307])
def test_a_mass_whose_tensor_leaves_float64_is_refused(mass: float) -> None:
    body = Body.of(*joined_box(1e-2 if mass < 1 else 1e2)).properties
    with pytest.raises(UsageError, match="the tensor leaves float64: name a mass nearer to"):
        body.with_mass(mass)


def joined_box(size: float) -> tuple[np.ndarray, np.ndarray]:
    surface = joined(box((size, size, size), (2 * size, 3 * size, 4 * size)))
    return surface.vertices, surface.faces


def test_a_frame_below_the_normal_range_says_what_it_cost() -> None:
    rng = np.random.default_rng(5)
    vertices, faces = mesh(rng, "ordinary")
    body = Body.of(vertices * 1e-63, faces).seen_from(rotation(rng), [0.0, 0.0, 0.0])
    assert 1e-15 < body.properties.error.inertia < 1e-2
    assert max(body.ratios([0.0, 0.0, 0.0]).values()) <= 1


def test_masses_that_may_be_none_are_refused_by_every_verb() -> None:
    vague = MassProperties(1.0, 1.0, [0, 0, 0], np.eye(3), ErrorBound("measured", 0.0, 1.0, 0.0, 0.0))
    for verb in (lambda: vague.with_mass(2.0), lambda: vague.expressed_in(np.eye(3)), lambda: vague + vague):
        with pytest.raises(GeometryError, match="is not above its error bound"):
            verb()


def test_a_point_in_the_part_s_unit_is_not_rounded() -> None:
    """0.1 in and 3 in are no metres that float64 has: exactly computed, the tensor is rounded once."""
    vertices, faces = joined_box(1.0)
    part = inertia.Part.from_arrays(vertices, faces, unit="in")
    inch, point = F(254, 10_000), (F(1, 10), F(3), F(-7, 10))
    analysis = inertia.analyse(part, DENSITY, accuracy="exact", about=point)
    xx, yy, zz, yz, zx, xy = rational.moments(vertices[faces]).moved(*(-k for k in point)).second
    true = [[yy + zz, -xy, -zx], [-xy, zz + xx, -yz], [-zx, -yz, xx + yy]]
    assert analysis.about is not None
    assert analysis.about[0] == (0.1, 3.0, -0.7)
    assert analysis.about[1].tolist() == [[float(DENSITY * inch**5 * k) for k in row] for row in true]
    assert analysis.about_bound == 2.0**-53


def test_bodies_of_many_parts_are_added_quickly() -> None:
    """The masses' quotients have denominators of their own, whose product would have a hundred thousand digits."""
    vertices, faces = mesh(np.random.default_rng(2), "ordinary")
    body = inertia.mass_properties(inertia.Part.from_arrays(vertices, faces))
    whole = repeated(body, lambda each: each + body.with_mass(each.mass * 0.37), 300)
    assert whole.error.inertia < 1e-13
    assert whole.center_of_mass == pytest.approx(body.center_of_mass, rel=1e-12)
