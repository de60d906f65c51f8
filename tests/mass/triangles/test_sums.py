"""Sums over triangles: the compiled and the numpy path give the same bits, and say what they cannot sum."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mesh.solids import cube, facets, joined, ring

from inertia import native
from inertia.errors import GeometryError
from inertia.mass.triangles import fine_sums
from inertia.mass.triangles import sums as module
from inertia.mass.triangles.kernels import BLOCK, LANES, BlockKernel
from inertia.mass.triangles.sums import PlainSums, SumsOnGrid, sum_triangles
from inertia.mesh.surface import Facets, Surface, Triangles
from inertia.native import Kernel
from inertia_meshes.rational import moments

Numbers = tuple[bytes, int, bytes, list[float], list[float]]


def bits(sums: PlainSums) -> Numbers:
    return sums.origin.tobytes(), sums.exponent, sums.sums.tobytes(), sums.low.tolist(), sums.high.tolist()


@pytest.fixture(scope="module", autouse=True)
def compiled_at_any_size() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("INERTIA_NATIVE", raising=False)
        patch.setattr(native, "SHIPPED_ABOVE", 0)
        patch.setattr(native, "LOAD_ABOVE", 0)
        patch.setattr(native, "COMPILE_ABOVE", 0)
        patch.setattr(module, "MANY", 10**9)
        yield


def both_paths(triangles: Triangles, surface: bool) -> tuple[Numbers, Numbers]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "vectorised_rows", lambda *_: pytest.fail("the numpy path ran"))
        compiled = bits(sum_triangles(triangles, surface=surface))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("INERTIA_NATIVE", "0")
        patch.setattr(BlockKernel, "rows", lambda *_: pytest.fail("the compiled path ran"))
        return compiled, bits(sum_triangles(triangles, surface=surface))


def soup(count: int, seed: int = 0, offset: float = 0.0) -> Surface:
    """Return triangles at random: neither path asks whether they bound anything."""
    points = np.random.default_rng(seed).normal(size=(3 * count, 3)) + offset
    return Surface(points, np.arange(3 * count).reshape(-1, 3))


@pytest.mark.parametrize("stored", [facets, lambda surface: surface], ids=["facets", "surface"])
def test_a_kernel_runs_where_that_very_kernel_is_at_hand(
    stored: Callable[[Surface], Triangles], monkeypatch: pytest.MonkeyPatch
) -> None:
    triangles = stored(soup(100))
    own = module.KERNEL.facets if isinstance(triangles, Facets) else module.KERNEL.faces
    monkeypatch.setattr(own, "worthwhile", lambda count: False)
    monkeypatch.setattr(BlockKernel, "rows", lambda *_: pytest.fail("the compiled path ran"))
    assert sum_triangles(triangles).count == 100


COUNTS = [1, 2, LANES - 1, LANES, LANES + 1, BLOCK - 1, BLOCK, BLOCK + 1, 16 * BLOCK + 17, 3 * 16 * BLOCK - 31]


@pytest.mark.parametrize("surface", [False, True], ids=["solid", "shell"])
@pytest.mark.parametrize("stored", [facets, lambda surface: surface], ids=["facets", "surface"])
@pytest.mark.parametrize("count", COUNTS)
def test_both_paths_give_the_same_bits(count: int, stored: Callable[[Surface], Triangles], surface: bool) -> None:
    compiled, plain = both_paths(stored(soup(count)), surface)
    assert compiled == plain


@pytest.mark.parametrize("surface", [False, True], ids=["solid", "shell"])
@pytest.mark.parametrize("offset", [1e6, -3e12, 1e200], ids=str)
def test_both_paths_give_the_same_bits_far_from_the_origin(offset: float, surface: bool) -> None:
    compiled, plain = both_paths(soup(1500, 1, offset), surface)
    assert compiled == plain


@pytest.mark.parametrize("stored", [facets, lambda surface: surface], ids=["facets", "surface"])
def test_both_paths_give_the_same_bits_with_signed_zeros(stored: Callable[[Surface], Triangles]) -> None:
    points = np.random.default_rng(2).choice([-0.0, 0.0, 1.0, -1.0], size=(3 * 1100, 3))
    triangles = stored(Surface(points, np.arange(3300).reshape(-1, 3)))
    compiled, plain = both_paths(triangles, False)
    assert compiled == plain


def test_both_paths_give_the_same_bits_in_several_native_runs() -> None:
    compiled, plain = both_paths(soup(128 * BLOCK + 4321, 3), False)
    assert compiled == plain


@settings(deadline=None, max_examples=60)
@given(
    st.lists(st.lists(st.floats(-1e3, 1e3), min_size=9, max_size=9), min_size=1, max_size=70),
    st.booleans(),
    st.sampled_from([2.0**-90, 1.0, 2.0**85]),
)
def test_both_paths_give_the_same_bits_on_any_triangles(rows: list[list[float]], shell: bool, scale: float) -> None:
    corners = np.array(rows).reshape(-1, 3) * scale
    exponent = module.frame_of(triangles := Surface(corners, np.arange(len(corners)).reshape(-1, 3))).exponent
    if exponent == 0:
        compiled, plain = both_paths(triangles, shell)
        assert compiled == plain


@pytest.mark.parametrize("scale", [1.0, 2.0**-300, 2.0**300], ids=["plain", "tiny", "huge"])
def test_extents_are_the_smallest_and_largest_stored_coordinates(scale: float) -> None:
    surface = soup(5000, 4, offset=7.0)
    surface.vertices *= scale
    sums = sum_triangles(surface)
    assert sums.low.tolist() == surface.vertices.min(axis=0).tolist()
    assert sums.high.tolist() == surface.vertices.max(axis=0).tolist()
    assert sums.count == 5000


def test_the_sums_are_those_of_the_definition() -> None:
    """On small integers nothing is rounded, so each sum equals its definition over the triangles."""
    corners = np.random.default_rng(5).integers(-8, 9, size=(777, 3, 3))
    lowest, highest = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    assert (lowest == -8).all()
    assert (highest == 8).all()
    surface = Surface(corners.reshape(-1, 3), np.arange(3 * 777).reshape(-1, 3))
    sums = sum_triangles(surface)
    a, b, c = (corners - sums.origin.astype(int)).transpose(1, 2, 0).astype(object)
    n = np.cross((b - a).T, (c - a).T).T
    d, s = (a * n).sum(axis=0), a + b + c
    assert sums.sums[0] == d.sum()
    assert sums.sums[1:4].tolist() == (d * s).sum(axis=1).tolist()
    assert sums.sums[4:7].tolist() == (d * (s * s + a * a + b * b + c * c) / 2).sum(axis=1).tolist()
    for row, (i, j) in enumerate([(1, 2), (2, 0), (0, 1)], start=7):
        assert sums.sums[row] == (d * (s[i] * s[j] + a[i] * a[j] + b[i] * b[j] + c[i] * c[j])).sum()
    lengths = np.sqrt((n * n).sum(axis=0).astype(float))
    assert sums.sums[11] == pytest.approx(lengths.sum(), rel=1e-14)
    assert sums.sums[10] >= abs(d).sum()
    shell = sum_triangles(surface, surface=True)
    assert shell.sums[0] == shell.sums[11] == sums.sums[11]
    assert shell.sums[1:4] == pytest.approx(((lengths * s).sum(axis=1)).astype(float), rel=1e-12)


@pytest.mark.parametrize("path", ["compiled", "numpy"])
def test_progress_rises_to_one(path: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if path == "numpy":
        monkeypatch.setenv("INERTIA_NATIVE", "0")
    fractions: list[float] = []
    sum_triangles(facets(soup(128 * BLOCK + 1)), progress=fractions.append)
    assert fractions == sorted(set(fractions))
    assert 0 < fractions[0] < fractions[-1] == 1.0


@pytest.mark.parametrize("native_path", [True, False], ids=["compiled", "numpy"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf], ids=str)
@pytest.mark.parametrize("stored", [facets, lambda surface: surface], ids=["facets", "surface"])
@pytest.mark.parametrize(("face", "corner", "axis"), [(0, 0, 0), (1033, 0, 0), (1033, 2, 1), (2056, 1, 2)])
def test_a_coordinate_that_is_not_finite_is_placed(
    face: int, corner: int, axis: int, stored: Callable[[Surface], Triangles], value: float, native_path: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    surface = soup(2057, 6)
    surface.vertices[3 * face + corner, axis] = value
    if not native_path:
        monkeypatch.setenv("INERTIA_NATIVE", "0")
    with pytest.raises(GeometryError, match=rf"^triangle {face}, corner {corner} has the coordinates .*{value}") as e:
        sum_triangles(stored(surface))
    assert e.value.exit_code == 4


def test_the_first_of_several_bad_coordinates_is_named() -> None:
    surface = soup(3000, 7)
    surface.vertices[[8000, 4000, 4001], 1] = np.nan
    with pytest.raises(GeometryError, match="triangle 1333, corner 1 "):
        sum_triangles(surface)


def test_coordinates_at_the_end_of_float64_are_summed() -> None:
    vertices, faces = cube(size=2.0)
    sums = sum_triangles(Surface(vertices * 2.0**1023, faces))
    assert sums.exponent < 0
    assert Fraction(sums.sums[0]) / 6 * (Fraction(2) ** -sums.exponent) ** 3 == 8 * Fraction(2) ** (3 * 1023)


@pytest.mark.parametrize("power", [-1000, -400, -104, 104, 400, 1000])
@pytest.mark.parametrize("surface", [False, True], ids=["solid", "shell"])
def test_a_size_beyond_the_range_changes_no_digit(power: int, surface: bool) -> None:
    vertices, faces = ring(33, 17)
    plain = sum_triangles(Surface(vertices, faces), surface=surface)
    scaled = sum_triangles(Surface(np.ldexp(vertices, power), faces), surface=surface)
    assert plain.exponent == 0 != scaled.exponent
    for row, degree in enumerate([0, 1, 1, 1, 2, 2, 2, 2, 2, 2, 0, 0]):
        degree += 2 if surface or row == 11 else 3
        size = Fraction(2) ** ((power + scaled.exponent) * degree)
        assert Fraction(scaled.sums[row]) == Fraction(plain.sums[row]) * size
    assert scaled.low.tolist() == np.ldexp(plain.low, power).tolist()
    assert scaled.origin.tolist() == np.ldexp(plain.origin, power).tolist()


def test_the_origin_lies_inside_the_part() -> None:
    for offset in (0.0, 1e7, 1e300):
        sums = sum_triangles(joined(cube((offset, -offset, offset / 3), size=max(1.0, offset / 1e10))))
        assert (sums.low <= sums.origin).all()
        assert (sums.origin <= sums.high).all()


def test_float32_facets_sum_to_the_exact_volume_of_what_is_stored() -> None:
    stored = facets(joined(ring(31, 9)))
    sums = sum_triangles(stored)
    exact = moments(stored.corners())
    assert abs(Fraction(sums.sums[0]) / 6 - exact.volume) <= Fraction(1, 10**13) * exact.volume


def test_a_process_without_native_kernels_gives_the_same_bits(tmp_path: object) -> None:
    """Over the threshold for compiling, in processes of their own: what the environment says is what runs."""
    script = (
        "import sys, numpy as np\n"
        "from inertia import native\n"
        "native.SHIPPED /= sys.argv[1]\n"
        "from inertia.mass.triangles.sums import sum_triangles\n"
        "from inertia.mesh.part import Surface\n"
        "points = np.random.default_rng(8).normal(size=(3000, 3))\n"
        "faces = np.random.default_rng(9).integers(0, 3000, (400_001, 3))\n"
        "print(sum_triangles(Surface(points, faces), surface=True).sums.tobytes().hex(), 'numba' in sys.modules)\n"
    )
    answers = set()
    for setting, shipped, compiles in (("0", ".", "False"), ("1", ".", str(not SHIPPED_HERE)), ("1", "none", "True")):
        environment = {**os.environ, "INERTIA_NATIVE": setting, "INERTIA_CACHE": f"{tmp_path}/{setting}"}
        command = [sys.executable, "-c", script, shipped]
        answer, compiled = subprocess.check_output(command, env=environment, text=True).split()
        assert compiled == compiles
        answers.add(answer)
    assert len(answers) == 1


SHIPPED_HERE = native.of_shipped_level()


@pytest.mark.skipif(not native.of_shipped_level(native.WIDE), reason="vectors of 512 bits")
@pytest.mark.parametrize("shape", [Surface, facets])
@pytest.mark.parametrize("thickness", [1.0, 1e-4])
def test_vectors_of_512_bits_give_the_same_bits(
    thickness: float, shape: Callable[[Surface], Triangles], monkeypatch: pytest.MonkeyPatch
) -> None:
    vertices, faces = ring(500, 203)
    turn = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    surface = Surface((vertices * [1, 1, thickness]) @ turn, faces)
    triangles = surface if shape is Surface else shape(surface)
    monkeypatch.setattr(module, "MANY", 0)
    own, answers = fine_sums.KERNEL, []
    for level in (native.LEVEL, native.WIDE):
        monkeypatch.setattr(native, "processor_lines", lambda of=level: ("flags : " + " ".join(of.flags),))
        one, other = (Kernel(k.module, k.name, k.abi, wide=True) for k in (own.facets, own.faces))
        monkeypatch.setattr(fine_sums, "KERNEL", replace(own, facets=one, faces=other))
        sums = sum_triangles(triangles)
        assert isinstance(sums, SumsOnGrid)
        assert (sums.fine.grid.shear is not None) == (thickness < 1)
        fine = sums.fine.high, sums.fine.low, sums.fine.edges, [sums.fine.size]
        answers.append(np.concatenate([[sums.area], sums.low, sums.high, sums.fine.far, *fine]).tobytes())
    assert answers[0] == answers[1]


@pytest.mark.parametrize("surface", [False, True])
def test_sums_while_others_read_in_any_order_have_the_same_bits(surface: bool) -> None:
    triangles = facets(Surface(*ring(120, 60)))
    summed = module.SummedFacets(triangles, surface=surface)
    whole = range(0, triangles.count, BLOCK)
    for start in (*reversed(whole[3:]), whole[5], 17):  # some not at all, one again, one from the middle of a block
        assert np.array_equal(summed.block(start, start + 40), triangles.block(start, start + 40))
        summed.block(start, min(start + BLOCK, triangles.count))
    one, other = summed.sums(), sum_triangles(triangles, surface=surface)
    assert np.array_equal(one.sums, other.sums)
    assert np.array_equal([one.low, one.high], [other.low, other.high])
