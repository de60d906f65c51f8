"""Principal moments and axes: right-handed, of definite signs, and honest about equal moments."""

from fractions import Fraction
from itertools import permutations

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mass.spectra import angle, eigenvalues, frame, plus
from tests.mass.spectra import turned as exactly_turned

from inertia.errors import GeometryError, UsageError
from inertia.mass.elements import point_masses
from inertia.mass.principal import CLASS_TOLERANCE, Principal, principal, radii_of_gyration
from inertia.mass.properties import MassProperties

seeds = st.integers(0, 2**32 - 1)


def equivalent_ellipsoid(moments: list[float], mass: float) -> np.ndarray:
    return MassProperties(mass, 0.0, [0, 0, 0], np.diag(moments)).equivalent_ellipsoid


def rotation(seed: int) -> np.ndarray:
    q: np.ndarray = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return q * np.linalg.det(q)


def turned(moments: list[float], axes: np.ndarray) -> np.ndarray:
    tensor: np.ndarray = axes @ np.diag(moments) @ axes.T
    return (tensor + tensor.T) / 2


def assert_frame(decomposition: Principal) -> None:
    """The axes are a right-handed rotation with the stated signs, the moments ascending."""
    assert decomposition.axes.T @ decomposition.axes == pytest.approx(np.eye(3), abs=1e-14)
    assert np.linalg.det(decomposition.axes) == pytest.approx(1.0)
    assert list(decomposition.moments) == sorted(decomposition.moments)
    for k in (0, 2):
        axis = decomposition.axes[:, k]
        assert axis[np.abs(axis) >= np.abs(axis).max() * (1 - 1e-9)][0] > 0


@settings(deadline=None)
@given(seeds, st.floats(0.05, 1), st.floats(0.05, 0.95), st.sampled_from([1e-280, 1.0, 1e280]))
def test_any_tensor_is_the_product_of_its_axes_and_moments(seed: int, low: float, gap: float, scale: float) -> None:
    moments = [low, low + gap, low + gap + low * gap]  # satisfies the triangle rule
    axes = rotation(seed)
    decomposition = principal(scale * turned(moments, axes))
    assert_frame(decomposition)
    assert decomposition.moments / scale == pytest.approx(moments, rel=1e-13)
    assert decomposition.axes * np.sign((decomposition.axes * axes).sum(axis=0)) == pytest.approx(axes, abs=1e-12)
    assert (decomposition.kind, decomposition.equal, decomposition.tolerance) == ("asymmetric", (), CLASS_TOLERANCE)


@pytest.mark.parametrize("seed", range(4))
def test_moments_agree_with_an_eigensolver_of_fifty_digits(seed: int) -> None:
    tensor = turned([1.0, 1.5, 2.2], rotation(seed))
    with mpmath.workdps(50):
        exact = sorted(mpmath.eigsy(mpmath.matrix(tensor.tolist()), eigvals_only=True))
    assert principal(tensor).moments == pytest.approx([float(k) for k in exact], rel=4e-16)


@pytest.mark.parametrize("signs", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
@pytest.mark.parametrize("order", list(permutations(range(3))), ids=str)
def test_signs_and_order_do_not_depend_on_how_the_tensor_is_written(
    order: tuple[int, ...], signs: tuple[int, int]
) -> None:
    """Permuting x, y, z, or turning two of them round, permutes the axes' components and nothing else."""
    change = np.zeros((3, 3))
    change[range(3), order] = [*signs, 1]
    change[2] *= np.linalg.det(change)
    plain = turned([1.0, 2.0, 2.5], rotation(9))
    decomposition = principal(change @ plain @ change.T)
    assert_frame(decomposition)
    expected = change @ principal(plain).axes
    for k in range(3):
        assert abs(decomposition.axes[:, k] @ expected[:, k]) == pytest.approx(1.0)


def test_axes_along_the_coordinates_are_exactly_these() -> None:
    for order in permutations([1.0, 2.0, 2.5]):
        decomposition = principal(np.diag(order))
        assert decomposition.moments.tolist() == [1.0, 2.0, 2.5]
        assert set(np.abs(decomposition.axes).ravel().tolist()) == {0.0, 1.0}
        assert_frame(decomposition)
        assert not np.signbit(decomposition.axes[decomposition.axes == 0]).any()


def test_components_of_equal_size_take_the_sign_from_the_first() -> None:
    axis = np.array([1.0, -1.0, 0.0]) / np.sqrt(2)
    other = np.array([1.0, 1.0, 0.0]) / np.sqrt(2)
    plain = turned([1.0, 2.0, 2.5], np.column_stack([axis, [0, 0, 1], other]))
    assert not np.signbit(principal(plain).axes[principal(plain).axes == 0]).any()
    for seed in range(10):
        noise = np.random.default_rng(seed).normal(size=(3, 3)) * 1e-14
        decomposition = principal(plain + noise + noise.T)
        assert decomposition.axes[:, 0] == pytest.approx(axis)
        assert decomposition.axes[:, 2] == pytest.approx(other)


CLASSES = [
    ([2.0, 2.0, 2.0], "spherical", ((0, 1, 2),)),
    ([1.0, 2.0, 2.0], "prolate", ((1, 2),)),
    ([2.0, 2.0, 3.0], "oblate", ((0, 1),)),
    ([1.0, 2.0, 2.5], "asymmetric", ()),
    ([0.0, 2.0, 2.0], "rotor", ((1, 2),)),
    ([0.0, 0.0, 0.0], "spherical", ((0, 1, 2),)),
]


@pytest.mark.parametrize("scale", [1e-300, 1.0, 1e300])
@pytest.mark.parametrize("seed", [None, 1, 2])
@pytest.mark.parametrize(("moments", "kind", "equal"), CLASSES, ids=[f"{k} {m}" for m, k, _ in CLASSES])
def test_the_class_and_the_subspaces_of_equal_moments(
    moments: list[float], kind: str, equal: tuple[tuple[int, ...], ...], seed: int | None, scale: float
) -> None:
    axes = np.eye(3) if seed is None else rotation(seed)
    decomposition = principal(scale * turned(moments, axes))
    assert (decomposition.kind, decomposition.equal) == (kind, equal)
    assert_frame(decomposition)
    for group in equal:
        span = axes[:, list(group)]
        assert span @ span.T == pytest.approx(
            decomposition.axes[:, list(group)] @ decomposition.axes[:, list(group)].T, abs=1e-14
        )


@pytest.mark.parametrize("tolerance", [1e-3, CLASS_TOLERANCE, 1e-12])
@pytest.mark.parametrize("scale", [1e-30, 1.0, 1e30])
def test_moments_are_equal_just_within_the_tolerance_and_not_just_outside(tolerance: float, scale: float) -> None:
    """The tolerance is a part of the largest moment."""

    def kind(*moments: float) -> str:
        return principal(scale * np.diag(moments), tolerance).kind

    inside, outside = 0.999 * tolerance, 1.001 * tolerance
    assert kind(1.0, 2.0 * (1 - inside), 2.0) == "prolate"
    assert kind(1.0, 2.0 * (1 - outside), 2.0) == "asymmetric"
    assert kind(1.0, 1.0 + 1.5 * inside, 1.5) == "oblate"
    assert kind(1.0, 1.0 + 1.5 * outside, 1.5) == "asymmetric"
    assert kind(2.0 * inside, 2.0, 2.0) == "rotor"
    assert kind(2.0 * outside, 2.0, 2.0) == "prolate"
    assert kind(1 - inside, 1.0, 1.0) == "spherical"
    assert kind(1 - outside, 1.0, 1.0) == "prolate"


def test_with_no_tolerance_only_equal_bits_are_equal() -> None:
    assert principal(np.diag([1.0, 2.0, 2.0]), 0.0).kind == "prolate"
    assert principal(np.diag([1.0, 2.0, np.nextafter(2.0, 3.0)]), 0.0).kind == "asymmetric"


@pytest.mark.parametrize(
    ("moments", "kind"),
    [
        ([-5.0, 1.0, 1.0], "prolate"),
        ([-1e-3, 1.0, 1.0], "prolate"),
        ([-1e-7, 1.0, 1.0], "rotor"),
        ([-2.0, -1.0, -1.0], "prolate"),
    ],
)
def test_a_moment_that_is_truly_negative_is_not_taken_for_zero(moments: list[float], kind: str) -> None:
    decomposition = principal(np.diag(moments))
    assert (decomposition.moments.tolist(), decomposition.kind) == (moments, kind)


@pytest.mark.parametrize("tolerance", [-1, 1.0, np.nan, np.inf, "1e-6", None, True], ids=str)
def test_a_tolerance_is_a_part_of_the_largest_moment(tolerance: object) -> None:
    for call in (principal, lambda it, tol: MassProperties(1, 1, [0, 0, 0], it).principal_within(tol)):
        with pytest.raises(UsageError, match=r"^the class tolerance is .*: it must be at least 0 and below 1"):
            call(np.eye(3), tolerance)


@pytest.mark.parametrize(("moments", "own"), [([2.0, 2.0, 3.0], 2), ([1.0, 2.0, 2.0], 0)], ids=["oblate", "prolate"])
def test_axes_of_equal_moments_lie_nearest_to_the_coordinates(moments: list[float], own: int) -> None:
    """About z the others are x and y themselves; about a tilted axis one of them is the nearest coordinate's shadow."""
    decomposition = principal(turned(moments, np.eye(3)[:, [1, 2, 0]] if own == 2 else np.eye(3)[:, [2, 0, 1]]))
    assert set(np.abs(decomposition.axes).ravel().tolist()) == {0.0, 1.0}
    z = np.array([0.3, 0.0, 1.0]) / np.hypot(0.3, 1.0)
    frame = np.column_stack([[0, 1, 0], np.cross(z, [0, 1, 0]), z])
    tilted = principal(turned(moments, np.roll(frame, own - 2, axis=1)))
    assert np.abs(tilted.axes[:, own]) == pytest.approx(np.abs(z), abs=1e-12)
    assert np.abs(tilted.axes.T @ [0, 1, 0]).max() == pytest.approx(1.0)


@pytest.mark.parametrize("seed", range(5))
def test_axes_of_equal_moments_do_not_follow_the_rounding_of_the_tensor(seed: int) -> None:
    noise = np.random.default_rng(seed).normal(size=(3, 3)) * 1e-13
    for moments in ([2.0, 2.0, 3.0], [1.0, 2.0, 2.0], [2.0, 2.0, 2.0]):
        plain = turned(moments, rotation(7))
        decomposition, other = principal(plain), principal(plain + noise + noise.T)
        assert other.axes == pytest.approx(decomposition.axes, abs=1e-11)


def test_a_needle_keeps_the_small_moment_that_its_tensor_carries() -> None:
    """A rod a billion times as long as wide: I1/I3 is 1e-18, below what its sum could tell, and stands alone."""
    decomposition = principal(np.diag([1.0, 1e18, 1e18]))
    assert decomposition.moments.tolist() == [1.0, 1e18, 1e18]
    assert decomposition.kind == "rotor"
    assert decomposition.axes.tolist() == np.eye(3).tolist()
    wide = principal(np.diag([1.0, 1e9, 1e9]), 1e-12)
    assert (wide.moments.tolist(), wide.kind) == ([1.0, 1e9, 1e9], "prolate")
    askew = principal(turned([1.0, 1e9, 1e9], rotation(2)), 1e-12)
    assert askew.moments[0] == pytest.approx(1.0, abs=1e9 * 1e-15)
    assert abs(askew.axes[:, 0] @ rotation(2)[:, 0]) == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize("scale", [2.0**-1070, 2.0**-1030, 2.0**1021])
def test_tensors_at_the_ends_of_float64_are_diagonalised(scale: float) -> None:
    decomposition = principal(np.diag([4.0, 3.0, 5.0]) * scale)
    assert decomposition.moments.tolist() == [3.0 * scale, 4.0 * scale, 5.0 * scale]
    assert decomposition.axes.tolist() == [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    assert_frame(decomposition)


@pytest.mark.parametrize("bad", [np.eye(2), np.full((3, 3), np.nan), [1, 2, 3], "x"], ids=str)
def test_what_is_no_tensor_is_refused(bad: object) -> None:
    with pytest.raises(UsageError, match=r"^inertia "):
        principal(bad)


@settings(deadline=None, max_examples=100)
@given(seeds, st.floats(0.05, 0.9), st.floats(-9, 0), st.floats(-16, -1), st.sampled_from([1e-30, 1.0, 1e30]))
def test_moments_and_axes_are_within_their_bounds(
    seed: int, low: float, gap: float, power: float, scale: float
) -> None:
    """The true tensor has rational axes and moments; the one given is off by all that its bound says."""
    largest = low + 1 + (1 - low) * 0.5
    moments = [Fraction(scale) * Fraction(k) for k in (low, largest * (1 - 0.4 * 10.0**gap), largest)]
    axes = frame(seed)
    true = exactly_turned(moments, axes)
    off = np.random.default_rng(seed).normal(size=(3, 3))
    off += off.T
    off *= scale * 10.0**power / np.linalg.norm(off)
    given_tensor = np.array([[float(k) for k in row] for row in plus(true, off)])
    bound = scale * (10.0**power + 1e-15)
    decomposition = principal(given_tensor, 0.0, bound)
    for value, limit, exact in zip(
        decomposition.moments.tolist(), decomposition.moment_bounds.tolist(), moments, strict=True
    ):
        assert abs(Fraction(value) - exact) <= Fraction(limit)
        assert limit <= 1.01 * bound + 1e-15 * scale
    for k in range(3):
        if decomposition.axis_bounds[k] < np.pi / 2:
            assert angle(decomposition.axes[:, k], [row[k] for row in axes]) <= decomposition.axis_bounds[k]
        else:
            assert (
                any(k in group for group in decomposition.equal)
                or decomposition.moment_bounds[k] > 0.1 * np.diff(decomposition.moments).min()
            )


@settings(deadline=None, max_examples=60)
@given(seeds)
def test_a_tensor_that_is_exact_has_its_moments_rounded_once(seed: int) -> None:
    tensor = turned([1.0, 1.5, 2.2], rotation(seed))
    exact = eigenvalues([[Fraction(k) for k in row] for row in tensor.tolist()])
    assert principal(tensor).moments.tolist() == [float(k) for k in exact]
    assert principal(tensor).moment_bounds.max() <= 2.0**-52
    assert principal(tensor).axis_bounds.max() < 1e-15


@pytest.mark.parametrize("gap", [10.0**-k for k in range(3, 16)])
@pytest.mark.parametrize("bound", [0.0, 1e-12, 1e-8])
def test_nearly_equal_moments_have_axes_or_a_subspace(gap: float, bound: float) -> None:
    """An axis where the gap is above the error on both sides, and what the error over the gap makes of it."""
    moments = [Fraction(1), 2 - Fraction(gap), Fraction(2)]
    axes = frame(11)
    tensor = np.array([[float(k) for k in row] for row in exactly_turned(moments, axes)])
    total = bound + 1e-15
    decomposition = principal(tensor, 0.0, total)
    if gap > 5 * total:
        assert (decomposition.kind, decomposition.equal) == ("asymmetric", ())
        assert 0.5 * total / gap < decomposition.axis_bounds[2] < 4 * total / gap
        assert angle(decomposition.axes[:, 2], [row[2] for row in axes]) <= decomposition.axis_bounds[2]
    elif gap < total:
        assert (decomposition.kind, decomposition.equal) == ("prolate", ((1, 2),))
        assert decomposition.axis_bounds[1:].tolist() == [np.pi / 2] * 2
    assert decomposition.axis_bounds[0] < 3 * total
    assert principal(tensor, 1e-6, total).kind == ("prolate" if gap < 2e-6 else "asymmetric")


def test_the_class_is_decided_by_the_bound_too() -> None:
    def kind(*moments: float, bound: float) -> str:
        return principal(np.diag(moments), 0.0, bound).kind

    assert kind(1.0, 1.9, 2.0, bound=0.049) == "asymmetric"
    assert kind(1.0, 1.9, 2.0, bound=0.051) == "prolate"
    assert kind(1.0, 1.1, 2.0, bound=0.051) == "oblate"
    assert kind(1.0, 1.1, 1.2, bound=0.051) == "spherical"
    assert kind(0.05, 2.0, 2.0, bound=0.049) == "prolate"
    assert kind(0.05, 2.0, 2.0, bound=0.051) == "rotor"


@pytest.mark.parametrize("count", [2, 3, 5])
def test_masses_on_a_line_have_no_moment_about_it_and_no_negative_one(count: int) -> None:
    """On lines of integer direction they are so to the last bit; two masses are so wherever they are."""
    rng = np.random.default_rng(count)
    for _ in range(30):
        places = np.outer(np.arange(count) ** 2, rng.integers(1, 9, 3)) + rng.integers(-9, 9, 3)
        body = point_masses(places, np.ones(count))
        pair = point_masses(rng.normal(size=(2, 3)), [1.0, 2.0])
        for each in (body, pair):
            assert (each.principal_moments[0], each.radii_of_gyration[0]) == (0.0, 0.0)
            assert each.principal.moment_bounds[0] < 1e-60 * each.principal_moments[2]


def test_a_negative_moment_is_0_only_where_that_is_within_its_bound() -> None:
    assert principal(np.diag([-0.01, 2.0, 2.0])).moments[0] == -0.01
    assert principal(np.diag([-0.01, 2.0, 2.0]), bound=0.009).moments[0] == -0.01
    unsure = principal(np.diag([-0.01, 2.0, 2.0]), bound=0.011)
    assert unsure.moments[0] == 0.0
    assert 0.001 < unsure.moment_bounds[0] < 0.0111


@pytest.mark.parametrize("bound", [-1.0, np.inf, np.nan])
def test_a_bound_is_a_finite_number(bound: float) -> None:
    with pytest.raises(UsageError, match=r"^bound is .* kg m²: it must be finite and not negative"):
        principal(np.eye(3), bound=bound)


def test_a_moment_beyond_float64_is_refused() -> None:
    tensor = 1e308 * np.array([[1.5, 0.5, 0.0], [0.5, 1.5, 0.0], [0.0, 0.0, 1.5]])
    with pytest.raises(GeometryError, match=r"a principal moment is above 1\.8e308") as e:
        principal(tensor)
    assert e.value.exit_code == 4


def test_radii_of_gyration_of_a_rod_and_a_disc() -> None:
    """l/√12 across a rod, and nothing along it; R/2, R/2 and R/√2 for a disc."""
    assert radii_of_gyration([0.0, 36.0, 36.0], 3.0) == pytest.approx([0, np.sqrt(12), np.sqrt(12)], rel=1e-15)
    assert radii_of_gyration([4.0, 4.0, 8.0], 4.0) == pytest.approx([1, 1, np.sqrt(2)], rel=1e-15)


def test_a_moment_below_zero_by_rounding_has_no_radius() -> None:
    assert radii_of_gyration([-1e-18, 1.0, 1.0], 1.0).tolist() == [0, 1, 1]
    assert equivalent_ellipsoid([1.0, 1.0, 2.0 + 1e-15], 1.0)[2] == 0.0


@settings(deadline=None)
@given(st.tuples(*[st.floats(1e-3, 1e3)] * 3), st.floats(1e-6, 1e6))
def test_an_ellipsoid_is_its_own_equivalent(axes: tuple[float, float, float], mass: float) -> None:
    """I1 = M (b² + c²)/5, cyclic, for semi-axes a ≥ b ≥ c; digits go where one semi-axis is much the smallest."""
    a, b, c = sorted(axes, reverse=True)
    moments = [mass * (b * b + c * c) / 5, mass * (c * c + a * a) / 5, mass * (a * a + b * b) / 5]
    semi_axes = equivalent_ellipsoid(moments, mass)
    assert semi_axes**2 == pytest.approx([a * a, b * b, c * c], rel=1e-14, abs=1e-15 * a * a * 4)


def test_the_equivalent_of_a_unit_cube_is_a_ball_of_the_same_moments() -> None:
    assert equivalent_ellipsoid([1 / 6] * 3, 1.0) == pytest.approx([np.sqrt(5 / 12)] * 3, rel=1e-15)


def test_the_equivalent_of_a_lamina_is_flat() -> None:
    assert equivalent_ellipsoid([1.0, 2.0, 3.0], 2.5).tolist() == pytest.approx([2.0, np.sqrt(2), 0.0])


def test_a_decomposition_cannot_be_written_over() -> None:
    body = point_masses(np.diag([1.0, 2.0, 3.0]), [1.0, 1.0, 1.0])
    for array in (
        body.principal_moments,
        body.principal_axes,
        body.principal.moment_bounds,
        body.principal.axis_bounds,
    ):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0
