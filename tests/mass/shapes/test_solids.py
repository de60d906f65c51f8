"""Moments of trimmed faces against closed forms: errors, bounds, gaps, and what is refused."""

import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from tests.mass.shapes.by_hand import TURN, box, circle, frustum, line, sphere, torus

from inertia.errors import GeometryError
from inertia.mass.moments import inertia_bounds, inertia_tensor
from inertia.mass.shapes.solids import solid_moments
from inertia.mesh.shape import Face, Shape, Solid, Trim

_ASKEW = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3.0


def _frustum_tensor(low: float, high: float, height: float) -> tuple[float, float, np.ndarray]:
    """Volume, height of the centre, and tensor about it, by polynomials in rationals."""
    a, b, h = map(Fraction, (low, high, height))
    slope = (b - a) / h

    def integral(power: int, of_z: int) -> Fraction:  # ∫ r^power z^of_z dz
        total = Fraction(0)
        for k in range(power + 1):
            total += math.comb(power, k) * a ** (power - k) * slope**k * h ** (k + of_z + 1) / (k + of_z + 1)
        return total

    volume, first, second = (integral(2, k) for k in range(3))
    along = integral(4, 0) / 2
    across = along / 2 + second - first * first / volume
    tensor = math.pi * np.diag([float(across), float(across), float(along)])
    return math.pi * float(volume), float(first / volume), tensor


def _known(name: str) -> tuple[Callable[..., Shape], float, float, np.ndarray, float]:
    """How it is made; volume, height of the centre along its axis, tensor about the centre, and area."""
    if name == "sphere":
        r = 3.0
        v = 4 / 3 * math.pi * r**3
        return lambda **k: sphere(r, **k), v, 0.0, 0.4 * v * r * r * np.eye(3), 4 * math.pi * r * r
    if name == "torus":
        a, b = 5.0, 2.0
        v = 2 * math.pi**2 * a * b * b
        across, along = v * (a * a / 2 + 5 * b * b / 8), v * (a * a + 3 * b * b / 4)
        return lambda **k: torus(a, b, **k), v, 0.0, np.diag([across, across, along]), 4 * math.pi**2 * a * b
    low, high, height = {"cylinder": (2.0, 2.0, 5.0), "frustum": (2.0, 0.5, 5.0)}[name]
    v, z, tensor = _frustum_tensor(low, high, height)
    area = math.pi * (low**2 + high**2 + (low + high) * math.hypot(low - high, height))
    return lambda **k: frustum(low, high, height, **k), v, z, tensor, area


@pytest.mark.parametrize("at", [(0.0, 0.0, 0.0), (1000.3, -20.7, 5.1)])
@pytest.mark.parametrize("name", ["sphere", "torus", "cylinder", "frustum"])
def test_turned_solids_to_twelve_digits(name: str, at: tuple[float, float, float]) -> None:
    make, volume, height, tensor, area = _known(name)
    shape = make(axes=_ASKEW, at=at)
    answer = solid_moments(shape.solids[0], shape.tolerances, 1e-12)
    moments = answer.moments
    far = 1 + max(map(abs, at)) / 10
    assert abs(float(moments.zeroth) - volume) <= min(1e-13 * far * volume, float(moments.zeroth_bound))
    assert float(moments.zeroth_bound) < 1e-12 * far * volume
    assert answer.area == pytest.approx(area, rel=1e-13)
    center = np.array([float(k) for k in moments.centroid])
    truth = np.array(at) + height * _ASKEW[2]
    assert np.linalg.norm(center - truth) <= float(moments.centroid_bound) + 2e-16 * max(map(abs, at))
    central = moments.central()
    computed = np.array([[float(k) for k in row] for row in inertia_tensor(central.second)])
    bounds = np.array([[float(k) for k in row] for row in inertia_bounds(central.second_bound)])
    assert (np.abs(computed - _ASKEW.T @ tensor @ _ASKEW) <= bounds + 1e-15 * np.abs(tensor).max()).all()
    assert bounds.max() < 1e-11 * far * tensor.max()


@pytest.mark.parametrize("spline", [False, True])
def test_a_box_of_planes_or_of_splines(spline: bool) -> None:
    shape = box((1, 2, 3), at=(10, 20, 30), spline=spline)
    moments = solid_moments(shape.solids[0], shape.tolerances, 1e-12).moments
    assert float(moments.zeroth) == pytest.approx(6, rel=1e-14)
    assert [float(k) for k in moments.centroid] == pytest.approx([10.5, 21, 31.5], rel=1e-14)
    xx, yy, zz, *products = (float(k) for k in moments.central().second)
    assert [xx, yy, zz] == pytest.approx([0.5, 2.0, 4.5], rel=1e-12)
    assert np.abs(products).max() <= 1e-12


def test_a_gap_is_closed_by_a_strip_wherever_the_solid_lies() -> None:
    """A lid larger than its side by 1e-6: what its rim encloses is a flat ring, at right angles to the side."""
    for at in ((0, 0, 0), (50, -70, 90)):
        shape = frustum(2.0, 2.0, 5.0, at=at, lid=1e-6)
        answer = solid_moments(shape.solids[0], shape.tolerances, 1e-12)
        assert answer.gap == pytest.approx(1e-6, rel=1e-6)
        off = abs(float(answer.moments.zeroth) - 20 * math.pi)
        assert off <= float(answer.moments.zeroth_bound) < 1e-10
        assert off < 1e-11


def test_a_cap_that_is_tangent_to_its_side_counts_its_gap_at_first_order() -> None:
    """A cylinder under half a sphere that is larger by a gap: they are tangent, so that the bound counts the gap."""
    r, gap = 2.0, 1e-5
    pieces = frustum(r, r, 5.0, lid=0).solids[0].faces[:2]
    loop = (
        Trim(line((0, 0), (TURN, 0)), 0, 1, 2),
        Trim(line((TURN, 0), (TURN, TURN / 4)), 0, 1, 4),
        Trim(line((0, TURN / 4), (TURN, TURN / 4)), 1, 0, 3),
        Trim(line((0, 0), (0, TURN / 4)), 1, 0, 4),
    )
    patch = replace(
        sphere(r + gap).solids[0].faces[0].patch, frame=frustum(1, 1, 1, at=(0, 0, 5.0)).solids[0].faces[0].patch.frame
    )
    solid = Solid("1", (*pieces, Face(patch, (loop,), False, 3)), np.eye(3, 4), True)
    answer = solid_moments(solid, np.full(5, 1e-4), 1e-12)
    assert answer.gap == pytest.approx(gap)
    assert float(answer.moments.zeroth_bound) >= 0.5 * gap * 1e-4 * 2 * math.pi * r  # tolerance times gap times length


def test_a_loop_of_nothing_bounds_nothing() -> None:
    shape = frustum(2.0, 2.0, 5.0)
    (side, *rest) = shape.solids[0].faces
    solid = replace(shape.solids[0], faces=(replace(side, loops=(*side.loops, ())), *rest))
    assert float(solid_moments(solid, shape.tolerances, 1e-12).moments.zeroth) == pytest.approx(20 * math.pi, rel=1e-14)
    with pytest.raises(GeometryError, match="edges without a tolerance"):
        solid_moments(solid, shape.tolerances[:2], 1e-12)


def test_a_mirror_image_and_a_left_handed_frame() -> None:
    shape = frustum(2.0, 0.5, 5.0)
    (side, *rest) = shape.solids[0].faces
    frame = side.patch.frame * np.array([[1], [1], [-1], [1]])  # y turned round: u runs the other way
    loops = tuple(tuple(replace(trim, curve=line(*_flipped(trim))) for trim in loop) for loop in side.loops)
    ordered = tuple(tuple(Trim(t.curve, t.stop, t.start, t.edge) for t in reversed(loop)) for loop in loops)
    mirrored = Face(replace(side.patch, frame=frame), ordered, True, 1)
    solid = replace(shape.solids[0], faces=(mirrored, *rest))
    moments = solid_moments(solid, shape.tolerances, 1e-12).moments
    assert float(moments.zeroth) == pytest.approx(_frustum_tensor(2, 0.5, 5)[0], rel=1e-14)


def _flipped(trim: Trim) -> tuple[list[float], list[float]]:
    o, x = trim.curve.frame[:2]
    return [TURN - o[0], o[1]], [TURN - o[0] - x[0], o[1] + x[1]]


def _without(shape: Shape, face: int) -> Shape:
    solid = shape.solids[0]
    return replace(shape, solids=(replace(solid, faces=solid.faces[:face] + solid.faces[face + 1 :]),))


def _with_patch(shape: Shape, **fields: object) -> Shape:
    solid = shape.solids[0]
    first = replace(solid.faces[0], patch=replace(solid.faces[0].patch, **fields))
    return replace(shape, solids=(replace(solid, faces=(first, *solid.faces[1:])),))


def _with_loop(shape: Shape, loop: tuple[Trim, ...]) -> Shape:
    solid = shape.solids[0]
    last = replace(solid.faces[-1], loops=(loop,))
    return replace(shape, solids=(replace(solid, faces=(*solid.faces[:-1], last)),))


_PIPE = frustum(2.0, 2.0, 5.0)


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        (_without(_PIPE, 2), "face 1 has no other face beside it: the solid is open"),
        (_without(box((1, 2, 3)), 4), "has no other face beside it"),
        (_with_patch(_PIPE, sizes=(math.nan,)), "face 1: its cylinder holds a number that is not finite"),
        (_with_patch(_PIPE, sizes=()), "face 1: its cylinder lacks a size"),
        (_with_patch(_PIPE, sizes=(1e300,)), "beyond the numbers"),
        (_with_patch(_PIPE, sizes=(2.5,)), "apart at an edge, and the file allows 1e-07"),
        (_with_patch(_PIPE, kind="spline"), "face 1: its spline is missing"),
        (_with_loop(_PIPE, (Trim(circle(2.0), TURN, 0, 2),)), "they do not face alike"),
        (_with_loop(_PIPE, (Trim(circle(2.0), 0, 3.0, 2),)), "face 3: its loop is open by"),
        (_with_loop(_PIPE, (Trim(circle(math.inf), 0, TURN, 2),)), "face 3: its ellipse holds a number"),
        (_with_loop(_PIPE, (Trim(circle(2.0), 0, math.inf, 2),)), "face 3: a trimming curve has an end"),
        (_with_loop(_PIPE, ()), "face 3: it has no boundary"),
        (replace(_PIPE, solids=(replace(_PIPE.solids[0], faces=()),)), "it has no faces"),
    ],
)  # fmt: skip
def test_damaged_solids_end_in_a_sentence(shape: Shape, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        solid_moments(shape.solids[0], shape.tolerances, 1e-10)
