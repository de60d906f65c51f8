"""Many small meshes at once: within their bounds of the exact moments, and one that is refused stops no other."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from tests.benchmarks.extremes.cases import ball
from tests.benchmarks.meshes import wavy_torus

import inertia
from inertia.errors import UsageError
from inertia.mass.small import small_sums
from inertia.mesh.geometry import simple as passes
from inertia_meshes import rational

F = Fraction
Mesh = tuple[np.ndarray, np.ndarray]


def shaped(seed: int) -> Mesh:
    """Return a ball or torus that is noisy, stretched to a plate, wall or needle, turned and moved off."""
    rng = np.random.default_rng(seed)
    vertices, faces = ball(seed % 3) if seed % 2 else wavy_torus(int(rng.integers(60, 300)))
    vertices = vertices * (1.0 + 1e-3 * rng.normal(size=(len(vertices), 1))) * rng.choice([1.0, 0.1, 0.02], size=3)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn[0] *= np.sign(np.linalg.det(turn))
    return vertices @ turn + rng.normal(size=3) * rng.choice([0.0, 1.0, 100.0]), np.asarray(faces, np.int64)


def norm(values: list[Fraction]) -> Fraction:
    return sum((k * k for k in values), F(0))


def assert_within_bounds(answer: inertia.Many, k: int, mesh: Mesh, density: float, f: Fraction) -> None:
    """Compare the figures of mesh k, of a unit of f metres, with the exact ones."""
    vertices, faces = mesh
    weight = F(density)
    exact = rational.moments(vertices[faces])
    volume = exact.volume * f**3
    centre = [x / exact.volume * f for x in exact.first]
    xx, yy, zz, yz, zx, xy = (
        weight * (s * f**5 - centre[i] * centre[j] * volume)
        for s, (i, j) in zip(exact.second, ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)), strict=True)
    )
    tensor = [yy + zz, -xy, -zx, -xy, zz + xx, -yz, -zx, -yz, xx + yy]
    assert abs(F(answer.volume[k]) - volume) <= F(answer.volume_error[k]) * volume
    assert abs(F(answer.mass[k]) - weight * volume) <= F(answer.volume_error[k]) * weight * volume
    off = norm([F(a) - b for a, b in zip(answer.center_of_mass[k].tolist(), centre, strict=True)])
    assert off <= F(answer.center_of_mass_error[k]) ** 2
    off = norm([F(a) - b for a, b in zip(answer.inertia[k].ravel().tolist(), tensor, strict=True)])
    assert off <= F(answer.inertia_error[k]) ** 2 * norm(tensor)


def test_each_figure_is_within_its_bound_of_the_exact_one() -> None:
    meshes = [shaped(seed) for seed in range(40)]
    density = np.linspace(0.5, 3.0, len(meshes))
    answer = inertia.many([v for v, _ in meshes], [f for _, f in meshes], density, unit="mm")
    assert answer.answered.all()
    assert answer.refusals == {}
    for k, mesh in enumerate(meshes):
        assert_within_bounds(answer, k, mesh, float(density[k]), F(1, 1000))
        assert answer.volume_error[k] < 1e-11
        assert answer.inertia_error[k] < 1e-9


@pytest.mark.parametrize("size", [1e-30, 1e-29, 3e-29, 1e-20, 1e20, 2e29, 4e29, 6e29])
@pytest.mark.parametrize("density", [1e-150, 1.0, 1e15, 1e30])
def test_bounds_hold_where_the_squares_of_tensors_are_beyond_float64(size: float, density: float) -> None:
    vertices, faces = ball(1)
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    turn[0] *= np.linalg.det(turn)
    meshes = [(vertices * [1, 1, thickness] @ turn * size, faces) for thickness in (1.0, 1e-2, 1e-4, 1e-6)]
    answer = inertia.many([v for v, _ in meshes], [f for _, f in meshes], density, unit="m")
    for k in np.flatnonzero(answer.answered).tolist():
        assert_within_bounds(answer, k, meshes[k], density, F(1))


def test_the_figures_are_those_of_one_mesh_by_itself() -> None:
    meshes = [shaped(seed) for seed in range(30)]
    answer = inertia.many([v for v, _ in meshes], [f for _, f in meshes], 7850.0)
    for k, mesh in enumerate(meshes):
        one = inertia.mass_properties(inertia.Part.from_arrays(*mesh), 7850.0)
        assert answer.volume[k] == pytest.approx(one.volume, rel=one.error.volume + answer.volume_error[k])
        off = np.linalg.norm(answer.inertia[k] - one.inertia) / np.linalg.norm(one.inertia)
        assert off <= one.error.inertia + answer.inertia_error[k]


@pytest.mark.skipif(not passes.at_hand(), reason="without compiled kernels each mesh goes its way alone")
def test_small_simple_meshes_are_answered_in_one_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    vertices, faces = ball(2)
    sizes = np.arange(1.0, 9.0)
    monkeypatch.setattr("inertia.mass.many.mass_properties", lambda *_: pytest.fail("a mesh went its way alone"))
    answer = inertia.many(sizes[:, None, None] * vertices, faces)
    assert answer.mass / answer.mass[0] == pytest.approx(sizes**3, rel=1e-14)
    assert answer.inertia[:, 0, 0] / answer.inertia[0, 0, 0] == pytest.approx(sizes**5, rel=1e-14)


def test_a_fault_of_the_program_is_not_put_down_to_the_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    def faulty(*_: object) -> None:
        raise ValueError("a fault")

    vertices, faces = ball(1)
    monkeypatch.setattr("inertia.mass.many.mass_properties", faulty)
    with pytest.raises(ValueError, match="a fault"):
        inertia.many([vertices], [np.concatenate([faces, faces])])  # which takes a look by itself


def test_a_mesh_that_is_refused_stops_no_other() -> None:
    vertices, faces = ball(1)
    gone = faces.copy()
    gone[0, 0] = len(vertices)
    bad = vertices.copy()
    bad[2, 2] = np.nan
    meshes = [
        (vertices, faces), (vertices, faces[1:]), (vertices, gone), (bad, faces), (vertices[:, :2], faces),
        ([["a", "b", "c"]], faces), (vertices, faces[:0]), (vertices, faces[:, ::-1]), (vertices, faces),
    ]  # fmt: skip
    answer = inertia.many([v for v, _ in meshes], [f for _, f in meshes])
    assert np.flatnonzero(answer.answered).tolist() == [0, 8]
    assert sorted(answer.refusals) == [1, 2, 3, 4, 5, 6, 7]
    assert answer.mass[0] == answer.mass[8]
    assert np.isnan(answer.inertia[1:8]).all()
    assert "open" in answer.refusals[1]
    assert "names vertex" in answer.refusals[2]
    assert "shape" in answer.refusals[4]
    assert "inside out" in answer.refusals[7]


def test_what_is_large_slender_or_of_several_bodies_goes_its_way_alone() -> None:
    vertices, faces = ball(1)
    two = np.concatenate([vertices, vertices + 3.0]), np.concatenate([faces, faces + len(vertices)])
    needle = vertices * [1.0, 1e-9, 1e-9]
    meshes = [wavy_torus(2000), two, (needle, faces)]
    answer = inertia.many([v for v, _ in meshes], [f for _, f in meshes])
    for k, (points, corners) in enumerate(meshes):
        one = inertia.mass_properties(inertia.Part.from_arrays(points, corners))
        assert (answer.mass[k], answer.inertia[k].tolist()) == (one.mass, one.inertia.tolist())
        assert answer.inertia_error[k] == one.error.inertia


def test_no_mesh_at_all_is_an_empty_answer() -> None:
    answer = inertia.many([], [])
    assert (answer.mass.shape, answer.inertia.shape, answer.refusals) == ((0,), (0, 3, 3), {})


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (([[[0, 0, 0]]], [[[0, 0, 0]], [[0, 0, 0]]]), "1 arrays of vertices and 2 of faces"),
        (([[[0, 0, 0]]], [[0, 0, 0]], [1.0, 2.0]), "one number or 1 of them"),
        (([[[0, 0, 0]]], [[0, 0, 0]], -1.0), "density is -1"),
        (([[[0, 0, 0]]], [[0, 0, 0]], "steel"), "density is 'steel': it must be a number"),
        ((None, [[0, 0, 0]]), "vertices must be arrays, one of each mesh, not None"),
        (([[[0, 0, 0]]], None), "faces must be arrays, one of each mesh, not None"),
        (([[[0, 0, 0]]], [[0, 0.5, 0]]), "faces hold 0.5, which is no number of a vertex"),
        (([[[0, 0, 0]]], np.array([[0, 0, 0]], object)), "faces must be an array of whole numbers"),
    ],
)
def test_what_cannot_be_meant_is_said(arguments: tuple[object, ...], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        inertia.many(*arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", [bool, complex])
def test_vertices_that_are_no_real_numbers_are_refused(kind: type) -> None:
    answer = inertia.many([np.eye(4, 3, -1).astype(kind)], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    assert answer.refusals == {0: "vertices must be an array of real numbers, (n, 3)"}


def test_rows_of_what_is_not_simple_are_not_read() -> None:
    if not passes.at_hand():
        return
    vertices, faces = ball(0)
    table = np.array([[0, len(vertices), 0, len(faces)], [0, len(vertices), 1, len(faces) - 1]])
    assert small_sums(vertices, np.asarray(faces, np.int64), table)[1].tolist() == [True, False]


def test_a_subnormal_mass_is_within_its_bound() -> None:
    vertices, faces = ball(1)
    one = inertia.mass_properties(inertia.Part.from_arrays(vertices, faces), 1e-316)
    answer = inertia.many([vertices], faces, 1e-316)
    assert (answer.mass[0], answer.volume_error[0]) == (one.mass, one.error.mass)
    assert one.error.mass > one.error.volume


def test_meshes_of_any_sizes_one_after_another_are_answered_as_apart() -> None:
    meshes = [shaped(seed) for seed in range(12)]
    meshes[5] = meshes[5][0], meshes[5][1][1:]  # open
    apart = inertia.many([v for v, _ in meshes], [f for _, f in meshes], 3.0)
    starts = [np.cumsum([0, *(len(mesh[k]) for mesh in meshes)]) for k in (0, 1)]
    rows = [np.concatenate([mesh[k] for mesh in meshes]) for k in (0, 1)]
    together = inertia.many(rows[0], rows[1], 3.0, offsets=(starts[0], starts[1]))
    for name in ("volume", "mass", "center_of_mass", "inertia", "volume_error", "inertia_error"):
        assert getattr(together, name).tobytes() == getattr(apart, name).tobytes()
    assert together.refusals == apart.refusals
    assert list(together.refusals) == [5]


@pytest.mark.parametrize(
    "offsets",
    [
        ([0, 5, 4], [0, 4, 8]),
        (np.uint64([0, 8, 4]), np.uint64([0, 4, 8])),  # of which no difference is negative
        ([0, 4, 9], [0, 4, 8]),
        ([0.5, 4], [0, 4]),
        ([], []),
        ([0, 4, 8], [0, 8]),
        ([0, 4], [0, 4], [0, 4]),
        3,
    ],
    ids=str,
)
def test_offsets_that_fit_no_meshes_are_refused(offsets: tuple[list[float], list[float]]) -> None:
    vertices, faces = np.zeros((8, 3)), np.zeros((8, 3), int)
    with pytest.raises(UsageError):
        inertia.many(vertices, faces, offsets=offsets)


def test_many_meshes_shared_out_have_the_bits_that_each_has_alone() -> None:
    vertices, faces = wavy_torus(1000)
    several = np.random.default_rng(3).uniform(0.5, 2.0, 220)[:, None, None] * vertices
    several[7, 3] = np.nan
    whole = inertia.many(several, faces)
    assert list(whole.refusals) == [7]
    for start in range(0, 220, 44):
        few = inertia.many(several[start : start + 44], faces)
        for name in ("volume", "inertia", "center_of_mass_error", "inertia_error"):
            assert np.array_equal(getattr(whole, name)[start : start + 44], getattr(few, name), equal_nan=True)


@pytest.mark.skipif(not passes.at_hand(), reason="sums in double-double are the compiled kernel's")
@pytest.mark.parametrize("seed", range(6))
def test_sums_beside_float64_are_exact_to_what_the_bounds_allow(seed: int) -> None:
    vertices, faces = shaped(seed)
    rows, usable = small_sums(vertices, faces, np.array([[0, len(vertices), 0, len(faces)]]))
    assert usable[0]
    origin, size, pairs = rows[0, :3].tolist(), F(rows[0, 13]) + F(rows[0, 15]), rows[0, 22:].tolist()
    points = [[F(x) - F(o) for x, o in zip(point, origin, strict=True)] for point in vertices.tolist()]
    exact = [F(0)] * 10
    for corners in faces.tolist():
        a, b, c = (points[k] for k in corners)
        u, v = ([q - p for p, q in zip(a, end, strict=True)] for end in (b, c))
        normal = [u[k - 2] * v[k - 1] - u[k - 1] * v[k - 2] for k in range(3)]
        d = sum((p * n for p, n in zip(a, normal, strict=True)), F(0))
        s = [p + q + r for p, q, r in zip(a, b, c, strict=True)]
        squares = [p * p + q * (p + q) + r * t for p, q, r, t in zip(a, b, c, s, strict=True)]
        mixed = [s[i] * s[j] + a[i] * a[j] + b[i] * b[j] + c[i] * c[j] for i, j in ((1, 2), (2, 0), (0, 1))]
        exact = [e + d * k for e, k in zip(exact, [F(1), *s, *squares, *mixed], strict=True)]
    reach = max(abs(x) for point in points for x in point)
    for k, true in enumerate(exact):
        scale = (1, 3 * reach, 12 * reach**2)[(k > 0) + (k > 3)]
        assert abs(F(pairs[2 * k]) + F(pairs[2 * k + 1]) - true) <= F(1, 10**28) * size * scale / 100
