"""`MassProperties`: its algebra, its bounds and what it refuses, against exact sums over point masses."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from tests.mass.spectra import eigenvalues
from tests.mesh.solids import box, cube, joined, part, sphere

from inertia import export, mass_properties
from inertia.errors import GeometryError, UsageError
from inertia.estimate import float_of
from inertia.mass.moments import Moments
from inertia.mass.properties import ErrorBound, MassProperties
from inertia.mass.triangles.exact import exact_moments
from inertia.mass.triangles.moments_from_sums import moments_of
from inertia.mass.triangles.sums import sum_triangles
from inertia.mesh.surface import Surface
from inertia_meshes import rational

F = Fraction
EXACT = ErrorBound("given", 0.0, 0.0, 0.0, 0.0)
seeds = st.integers(0, 2**32 - 1)


def rotation(seed: int) -> np.ndarray:
    q: np.ndarray = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return q * np.linalg.det(q)


def of_surface(surface: Surface, density: int = 1, *, exact: bool = False) -> MassProperties:
    moments = exact_moments(surface) if exact else moments_of(sum_triangles(surface))
    return MassProperties.from_moments(moments.scaled(F(density)), moments.zeroth, moments.zeroth_bound, "test")


def of_box(low: tuple, high: tuple, density: int = 1) -> MassProperties:
    return of_surface(joined(box(low, high)), density)


def assert_same(properties: MassProperties, expected: MassProperties, rel: float = 1e-14) -> None:
    assert properties.mass == pytest.approx(expected.mass, rel=rel)
    assert properties.volume == pytest.approx(expected.volume, rel=rel)
    size = float(np.sqrt(np.trace(expected.inertia) / expected.mass))
    assert properties.center_of_mass == pytest.approx(expected.center_of_mass, abs=rel * size)
    assert properties.inertia == pytest.approx(expected.inertia, abs=rel * float(np.abs(expected.inertia).max()))


# From moments


def test_a_cube_has_a_sixth() -> None:
    properties = of_surface(joined(cube((1, 2, 3))), 6)
    assert (properties.mass, properties.volume) == (6.0, 1.0)
    assert properties.center_of_mass.tolist() == [1, 2, 3]
    assert properties.inertia.tolist() == np.eye(3).tolist()
    assert properties.principal.kind == "spherical"
    assert properties.principal_moments.tolist() == [1, 1, 1]
    assert properties.principal_axes.tolist() == np.eye(3).tolist()


@settings(deadline=None, max_examples=60)
@given(seeds, st.floats(-40, 58), st.one_of(st.just(0.0), st.floats(0, 1e6)), st.booleans())
def test_results_are_within_the_stated_errors(seed: int, power: float, offset: float, exact: bool) -> None:
    rng = np.random.default_rng(seed)
    vertices, faces = sphere(splits=1)
    vertices = (vertices * rng.uniform(0.3, 1, (len(vertices), 1)) @ rotation(seed) + offset) * 10.0**power
    triangles = Surface(vertices, faces)
    properties, true = of_surface(triangles, exact=exact), rational.moments(triangles.corners())
    assert abs(F(properties.volume) - true.volume) <= F(properties.error.volume) * F(properties.volume)
    assert abs(F(properties.mass) - true.volume) <= F(properties.error.mass) * F(properties.mass)
    squares = ((F(a) - b) ** 2 for a, b in zip(properties.center_of_mass.tolist(), true.center_of_mass, strict=True))
    assert sum(squares) <= F(properties.error.center_of_mass) ** 2
    assert_tensor_bounded(properties, true.inertia)
    assert properties.error.inertia <= (1e-15 if exact else 1e-10)


def assert_tensor_bounded(properties: MassProperties, true: list[list[Fraction]] | rational.Matrix) -> None:
    numbers = [F(k) for k in properties.inertia.ravel().tolist()]
    error = sum((a - b) ** 2 for a, b in zip(numbers, (k for row in true for k in row), strict=True))
    assert error <= F(properties.error.inertia) ** 2 * sum(k * k for k in numbers)


def test_an_exact_method_is_rounded_once() -> None:
    properties = of_surface(joined(sphere((0.1, 0.2, 0.3), splits=2)), exact=True)
    true = rational.moments(joined(sphere((0.1, 0.2, 0.3), splits=2)).corners())
    assert properties.mass == float(true.volume)
    assert properties.center_of_mass.tolist() == [float(k) for k in true.center_of_mass]
    assert properties.inertia.tolist() == [[float(k) for k in row] for row in true.inertia]
    assert (properties.error.method, properties.error.mass, properties.error.inertia) == ("test", 2.0**-53, 2.0**-53)


def test_results_below_the_normal_range_state_what_rounding_cost_them() -> None:
    """A cube of 2⁻²¹⁰ m has moments of about 2⁻¹⁰⁵²: 22 bits are left."""
    vertices, faces = sphere(splits=1)
    triangles = Surface(np.ldexp(vertices, -210), faces)
    properties = of_surface(triangles, exact=True)
    assert 1e-8 < properties.error.inertia < 1e-4
    assert_tensor_bounded(properties, rational.moments(triangles.corners()).inertia)


def test_a_mass_below_the_normal_range_states_what_rounding_cost_it() -> None:
    zero = (F(0),) * 3
    mass = F(1, 3 * 2**1070)
    properties = MassProperties.from_moments(
        Moments(zero, mass, zero, (F(1), F(1), F(1), *zero)), F(1), F(0), "thin gas"
    )
    assert 0 < abs(F(properties.mass) - mass) <= F(properties.error.mass) * F(properties.mass)


@pytest.mark.parametrize(("size", "match"), [(1e-70, "below 5e-324"), (1e65, "above 1.8e308")])
def test_a_result_that_leaves_float64_is_refused(size: float, match: str) -> None:
    with pytest.raises(GeometryError, match=match) as e:
        of_surface(joined(cube(size=size)))
    assert e.value.exit_code == 4


def test_a_tensor_at_the_end_of_float64_is_given() -> None:
    """The moments are 1.5e308, so that the tensor's norm is beyond float64."""
    side = 9.0**0.2 * 1e308**0.2
    properties = of_surface(joined(cube(size=side)))
    assert properties.inertia[0, 0] == pytest.approx(1.5e308, rel=1e-10)
    assert properties.error.inertia < 1e-12


@pytest.mark.parametrize(
    ("zeroth", "bound", "volume", "volume_bound", "match"),
    [
        (0, 0, 1, 0, "the mass, 0 kg, is not above its error bound of 0 kg"),
        (1, 1, 1, 0, "the mass, 1 kg, is not above its error bound of 1 kg"),
        (-1, 0, 1, 0, "the mass, -1 kg"),
        (-(10**400), 10**400, 1, 0, "the mass, inf kg, is not above its error bound of inf kg"),
        (1, 0, -1, 0, "the volume, -1 m³, is not above its error bound of 0 m³"),
        (1, 0, 1, 1, "the volume, 1 m³, is not above its error bound of 1 m³"),
        (1, 0, 0, 1, "the volume, 0 m³"),
    ],
)
def test_what_is_not_above_its_bound_is_refused(
    zeroth: int, bound: int, volume: int, volume_bound: int, match: str
) -> None:
    zero = (F(0),) * 3
    moments = Moments(zero, F(zeroth), zero, (F(1), F(1), F(1), *zero), F(bound))
    with pytest.raises(GeometryError, match=match):
        MassProperties.from_moments(moments, F(volume), F(volume_bound), "test")


def test_no_volume_is_a_volume() -> None:
    zero = (F(0),) * 3
    properties = MassProperties.from_moments(Moments(zero, F(2), zero, (F(1), *zero, F(0), F(0))), F(0), F(0), "wire")
    assert (properties.volume, properties.error.volume) == (0.0, 0.0)


# What is refused


@pytest.mark.parametrize("mass", [0.0, -1.0, math.inf, math.nan, 10**400], ids=lambda mass: f"{float_of(mass)}")
def test_a_mass_is_positive_and_finite(mass: float) -> None:
    with pytest.raises(
        GeometryError, match=f"^the mass is {float_of(mass):.6g} kg: it must be positive and finite"
    ) as e:
        MassProperties(mass, 1.0, [0, 0, 0], np.eye(3))
    assert e.value.exit_code == 4
    with pytest.raises(UsageError, match=r"^mass is .* kg: it must be positive and finite") as e:
        MassProperties(1.0, 1.0, [0, 0, 0], np.eye(3)).with_mass(mass)
    assert e.value.exit_code == 2


@pytest.mark.parametrize("value", [True, "two", None, 2j], ids=str)
def test_what_is_no_number_is_no_mass(value: object) -> None:
    for call in (
        lambda: MassProperties(value, 1.0, [0, 0, 0], np.eye(3)),
        lambda: MassProperties(1.0, value, [0, 0, 0], np.eye(3)),
    ):
        with pytest.raises(UsageError, match=r"^(mass|volume) is .*: it must be a number of (kg|m³)$"):
            call()
    with pytest.raises(UsageError, match=r"^mass is .*: it must be a number of kg$"):
        MassProperties(1.0, 1.0, [0, 0, 0], np.eye(3)).with_mass(value)


@pytest.mark.parametrize("value", [True, "dense"], ids=str)
def test_what_is_no_number_is_no_density(value: object) -> None:
    with pytest.raises(UsageError, match=r"^density is .*: it must be a number of kg/m³$"):
        mass_properties(part(cube()), density=value)


@pytest.mark.parametrize("volume", [-1.0, -1e-300, math.inf, math.nan], ids=str)
def test_a_volume_is_finite_and_not_negative(volume: float) -> None:
    with pytest.raises(GeometryError, match=r"^the volume is .* m³: it must be finite and not negative"):
        MassProperties(1.0, volume, [0, 0, 0], np.eye(3))


@pytest.mark.parametrize("scale", [1e-30, 1.0, 1e30])
@pytest.mark.parametrize(
    ("tensor", "match"),
    [
        (np.diag([1.0, 1.0, 3.0]), "break the triangle rule"),
        (-np.eye(3), "are not all positive"),
        (np.array([[1.0, 0.1, 0], [0, 1, 0], [0, 0, 1]]), "not symmetric"),
    ],
)
def test_a_tensor_that_no_body_has_is_refused(tensor: np.ndarray, match: str, scale: float) -> None:
    with pytest.raises(GeometryError, match=f"^the inertia tensor is not physical: .*{match}"):
        MassProperties(1.0, 1.0, [0, 0, 0], tensor * scale)


@pytest.mark.parametrize(
    ("com", "tensor", "match"),
    [
        ([0, 0], np.eye(3), "center_of_mass must have shape"),
        ([0, 0, np.nan], np.eye(3), "center_of_mass holds a value that is not finite"),
        ("abc", np.eye(3), "center_of_mass must be numbers"),
        ([0, 0, 0], np.eye(2), "inertia must have shape"),
        ([0, 0, 0], [1, 1, 1], "inertia must have shape"),
        ([0, 0, 0], np.full((3, 3), np.inf), "inertia holds a value that is not finite"),
    ],
)
def test_arrays_have_their_shapes(com: object, tensor: object, match: str) -> None:
    with pytest.raises(UsageError, match=f"^{match}"):
        MassProperties(1.0, 1.0, com, tensor)


def test_a_tensor_is_physical_within_its_own_error() -> None:
    """Beyond the triangle rule by a thousandth: refused as exact, accepted where the tensor may be off by that."""
    tensor = np.diag([1.0, 1.0, 2.002])
    with pytest.raises(GeometryError, match="triangle rule"):
        MassProperties(1.0, 1.0, [0, 0, 0], tensor)
    assert MassProperties(1.0, 1.0, [0, 0, 0], tensor, ErrorBound("given", 0, 0, 0, 1e-3)).mass == 1.0


@pytest.mark.parametrize("scale", [1e-250, 1.0, 1e300])
@pytest.mark.parametrize("apart", [2.0**-52, 1e-9, 1e-7, 1e-6])
def test_mirrored_elements_that_rounding_set_apart_are_their_mean_and_all_verbs_take_it(
    apart: float, scale: float
) -> None:
    """What is farther from the mean than the stated bound says cannot be the tensor, so that the bound covers it."""
    tensor = scale * np.array([[1.0, 0.2, 0.0], [0.2, 1.0, 0.0], [0.0, 0.0, 1.0]])
    tensor[1, 0] += apart * scale
    body = MassProperties(1.0, 1.0, [0, 0, 0], tensor)
    assert body.inertia.tolist() == ((tensor / 2) + (tensor / 2).T).tolist()
    off = np.linalg.norm((body.inertia - tensor) / scale) / np.linalg.norm(body.inertia / scale)
    assert off <= body.error.inertia <= off * (1 + 1e-9)
    assert body.principal_moments / scale == pytest.approx([0.8, 1.0, 1.2], rel=2 * apart)
    assert (body + body).inertia.tolist() == (2 * body.inertia).tolist()
    assert body.about([0, 0, 0]).tolist() == body.expressed_in(np.eye(3)).inertia.tolist() == body.inertia.tolist()
    wide = MassProperties(1.0, 1.0, [0, 0, 0], tensor, ErrorBound("measured", 0, 0, 0, 0.1))
    assert wide.error.inertia == pytest.approx(0.1, rel=1e-9)
    assert "kg" in body._repr_html_()


def test_a_tensor_of_single_precision_is_a_body() -> None:
    turned = rotation(3).astype(np.float32)
    tensor = turned @ np.diag([1.0, 2.0, 2.5]).astype(np.float32) @ turned.T
    assert not np.array_equal(tensor, tensor.T)
    body = MassProperties(1.0, 1.0, [0, 0, 0], tensor)
    assert body.principal_moments == pytest.approx([1.0, 2.0, 2.5], rel=1e-6)
    assert export(body, "urdf")


def test_an_error_is_one() -> None:
    with pytest.raises(UsageError, match=r"error is a NoneType, not a ErrorBound: give what inertia.ErrorBound"):
        MassProperties(1.0, 1.0, [0, 0, 0], np.eye(3), None)


def test_the_arrays_are_copies_and_stay_as_they_are() -> None:
    com, tensor = np.zeros(3), np.eye(3)
    properties = MassProperties(1.0, 1.0, com, tensor)
    com[0], tensor[0, 0] = 1, 5
    assert (properties.center_of_mass[0], properties.inertia[0, 0]) == (0, 1)
    for array in (properties.center_of_mass, properties.inertia):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


# Principal moments and axes


def test_an_ordinary_part_has_small_bounds() -> None:
    decomposition = of_box((0, 0, 0), (1, 2, 3)).principal
    assert (decomposition.moment_bounds < 1e-13 * decomposition.moments).all()
    assert (decomposition.axis_bounds < 1e-12).all()


@pytest.mark.parametrize("accuracy", [1e-15, 1e-6])
def test_given_properties_lend_their_error_to_the_moments(accuracy: float) -> None:
    body = MassProperties(1.0, 1.0, [0, 0, 0], np.diag([1.0, 2.0, 2.5]), ErrorBound("given", 0, 0, 0, accuracy))
    bound = accuracy * np.sqrt(1 + 4 + 6.25)
    assert body.principal.moment_bounds == pytest.approx([bound] * 3, rel=1e-9)
    assert body.principal.axis_bounds == pytest.approx([bound, 2 * bound, 2 * bound], rel=1e-4, abs=1e-15)


def test_the_tolerance_of_the_class_can_be_chosen() -> None:
    body = of_box((0, 0, 0), (1, 1, 1.001))
    assert body.principal.kind == "prolate"
    assert body.principal_within(0.01).kind == "spherical"
    assert body.principal_within(0.01).tolerance == 0.01


@settings(deadline=None, max_examples=40)
@given(seeds, st.floats(0, 4), st.floats(0, 4), st.sampled_from([0.0, 1.0, 1e5]))
def test_moments_of_any_part_are_within_their_bounds(seed: int, a: float, b: float, offset: float) -> None:
    """Ellipsoids from round to slender, at any place and in any attitude."""
    vertices, faces = sphere(splits=1)
    vertices = vertices * [1, 10.0**-a, 10.0**-b] @ rotation(seed).T + offset
    triangles = Surface(vertices, faces)
    true = rational.moments(triangles.corners())
    for exact in (False, True):
        try:
            decomposition = of_surface(triangles, exact=exact).principal
        except GeometryError:
            assume(exact)
            raise
        for value, bound, k in zip(
            decomposition.moments, decomposition.moment_bounds, eigenvalues(true.inertia), strict=True
        ):
            assert abs(F(value) - k) <= F(bound) * (1 + F(1, 10**20))


def test_what_the_tensor_has_lost_is_kept_for_the_algebra() -> None:
    """A needle askew, moved and put together with nothing but itself, still has its smallest moment."""
    rod = Surface(sphere(splits=1)[0] * [1, 1e-9, 2e-9] @ rotation(3).T, sphere(splits=1)[1])
    properties = of_surface(rod, exact=True)
    twice = properties + properties
    assert twice.principal_moments == pytest.approx(2 * properties.principal_moments, rel=1e-13)
    given_tensor = MassProperties(
        properties.mass, properties.volume, properties.center_of_mass, properties.inertia, properties.error
    )
    assert given_tensor.principal.moment_bounds[0] > given_tensor.principal.moments[0]


# The algebra


def test_a_box_cut_in_two_adds_up_and_comes_apart() -> None:
    whole = of_box((0, 0, 0), (3, 2, 1), 5)
    left, right = of_box((0, 0, 0), (1, 2, 1), 5), of_box((1, 0, 0), (3, 2, 1), 5)
    for body, expected in ((left + right, whole), (right + left, whole), (whole - left, right), (whole - right, left)):
        assert_same(body, expected)
        assert body.error.method == "test"


def test_a_hollow_cube_is_one_cut_out_of_another() -> None:
    """(a⁵ − b⁵)/6 for sides a and b about a common middle."""
    properties = of_surface(joined(cube((7, 8, 9), size=4.0))) - of_surface(joined(cube((7, 8, 9), size=2.0)))
    assert (properties.mass, properties.volume) == (56.0, 56.0)
    assert properties.inertia == pytest.approx((4**5 - 2**5) / 6 * np.eye(3), rel=1e-15)


def test_bodies_of_different_densities_are_an_assembly() -> None:
    """A point of 1 kg on the face of a 3 kg cube: Steiner for both about the common centre at a quarter of ½."""
    cube_ = of_surface(joined(cube()), 3)
    assembly = cube_ + MassProperties(1.0, 0.0, [0.5, 0, 0], np.zeros((3, 3)))
    assert (assembly.mass, assembly.volume) == (4.0, 1.0)
    assert assembly.center_of_mass.tolist() == [0.125, 0, 0]
    across = 0.5 + 3 * 0.125**2 + 1 * 0.375**2
    assert assembly.inertia.tolist() == np.diag([0.5, across, across]).tolist()
    assert assembly.error.method == "test + given"


@pytest.mark.parametrize(
    "body", [of_box((0, 0, 0), (1, 2, 3)), MassProperties(2.0, 1.0, [1, 2, 3], np.eye(3))], ids=["box", "given"]
)
def test_a_body_cut_out_of_itself_leaves_nothing(body: MassProperties) -> None:
    with pytest.raises(GeometryError, match=r"nothing is left of (.*) kg where .* kg are cut out: subtract") as e:
        _ = body - body
    assert e.value.exit_code == 4


def test_cutting_out_more_than_there_is_is_refused() -> None:
    small, large = of_box((0, 0, 0), (1, 1, 1), 8), of_box((0, 0, 0), (2, 2, 2), 2)
    with pytest.raises(GeometryError, match="nothing is left of 8 kg where 16 kg are cut out"):
        _ = small - of_box((0, 0, 0), (2, 2, 2), 2)
    heavier = of_box((0, 0, 0), (1, 1, 1), 100)
    with pytest.raises(GeometryError, match="the volume, -7 m³, is not above its error bound"):
        _ = heavier - large
    with pytest.raises(GeometryError, match="the inertia tensor is not physical"):
        _ = of_box((0, 0, 0), (1, 1, 1), 8) - MassProperties(1.0, 0.0, [50, 0, 0], np.zeros((3, 3)))


def test_the_sum_of_a_list_is_an_assembly_and_nothing_but_zero_is_no_body() -> None:
    bodies = [of_box((k, 0, 0), (k + 1, 1, 1)) for k in range(0, 6, 2)]
    whole = sum(bodies)
    assert isinstance(whole, MassProperties)
    assert whole.inertia.tolist() == (bodies[0] + bodies[1] + bodies[2]).inertia.tolist()
    for other in (1, False, None):
        with pytest.raises(UsageError, match="mass properties combine with mass properties, not with"):
            _ = other + bodies[0]


@pytest.mark.parametrize("other", [0, None, np.eye(3), "body"], ids=["0", "None", "array", "text"])
def test_only_mass_properties_combine(other: object) -> None:
    body = of_box((0, 0, 0), (1, 1, 1))
    for call in (body.__add__, body.__sub__):
        with pytest.raises(UsageError, match="mass properties combine with mass properties, not with") as e:
            call(other)
        assert e.value.exit_code == 2


def test_about_a_corner_a_cube_has_two_thirds_and_a_quarter() -> None:
    """2/3 M a² on the diagonal and −M a²/4 off it about a corner."""
    moments = of_box((0, 0, 0), (1, 1, 1), 12).about([0, 0, 0])
    assert moments.tolist() == [[8, -3, -3], [-3, 8, -3], [-3, -3, 8]]


@settings(deadline=None)
@given(seeds, st.tuples(*[st.floats(-1e9, 1e9)] * 3))
def test_about_any_point_is_rounded_once(seed: int, point: tuple[float, float, float]) -> None:
    com = np.random.default_rng(seed).normal(size=3)
    body = MassProperties(3.0, 1.0, com, np.diag([1.0, 1.5, 2.0]))
    d = [F(c) - F(p) for c, p in zip(com.tolist(), point, strict=True)]
    for i in range(3):
        for j in range(3):
            exact = F(body.inertia[i, j]) + 3 * ((i == j) * sum(k * k for k in d) - d[i] * d[j])
            assert body.about(point)[i, j] == float(exact)


@pytest.mark.parametrize("size", [1e-45, 1e-30, 1e30, 1e55])
def test_the_algebra_holds_at_any_size(size: float) -> None:
    """Where the squares of the tensor's elements are no float64."""
    body = of_box((0, 0, 0), (size, size, size))
    assert body.about([0, 0, 0])[0, 0] == pytest.approx(2 / 3 * size**5, rel=1e-13)
    assert_same(body + body.expressed_in(np.eye(3), [size, 0, 0]), of_box((-size, 0, 0), (size, size, size)), rel=1e-13)
    assert (body + body).error.inertia < 1e-11


def test_about_a_point_beyond_float64_is_refused() -> None:
    body = of_box((0, 0, 0), (1, 1, 1))
    with pytest.raises(UsageError, match="is above"):
        body.about([1e200, 0, 0])
    with pytest.raises(UsageError, match="point must have shape"):
        body.about([0, 0])
    with pytest.raises(UsageError, match="point holds a value that is not finite"):
        body.about([0, 0, np.inf])


def test_another_frame_has_its_axes_as_columns_and_its_own_origin() -> None:
    body = of_box((0, 0, 0), (1, 2, 3))
    new_x_is_old_y = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    properties = body.expressed_in(new_x_is_old_y, [0, 0, -10])
    assert_same(properties, of_box((0, 10, 0), (2, 13, 1)))


@settings(deadline=None, max_examples=50)
@given(seeds, seeds)
def test_another_frame_keeps_what_does_not_depend_on_it(seed: int, turned: int) -> None:
    body = of_surface(Surface(sphere(splits=1)[0] * [1, 2, 3] @ rotation(seed).T, sphere(splits=1)[1]))
    axes, origin = rotation(turned), np.random.default_rng(turned).normal(size=3)
    properties = body.expressed_in(axes, origin)
    assert (properties.mass, properties.volume) == (body.mass, body.volume)
    assert properties.principal_moments == pytest.approx(body.principal_moments, rel=1e-14)
    assert_same(properties.expressed_in(axes.T, -axes.T @ origin), body)
    point = np.array([1.0, -2.0, 0.5])
    expected = axes.T @ body.about(point) @ axes
    assert properties.about(axes.T @ (point - origin)) == pytest.approx(expected, abs=1e-13 * np.abs(expected).max())


@settings(deadline=None, max_examples=60)
@given(seeds, st.sampled_from([0.0, 1.0, 1e6]), st.sampled_from([0.0, 1.0, 1e6]))
def test_what_another_frame_rounds_is_in_the_errors(seed: int, away: float, origin_away: float) -> None:
    """Against Rᵀ J R and Rᵀ (c − o) in rationals; the body itself is exact."""
    rng = np.random.default_rng(seed)
    com, origin = away * rng.normal(size=3), origin_away * rng.normal(size=3)
    body = MassProperties(1.0, 1.0, com, np.diag([1.0, 1.3, 2.1]), EXACT)
    properties = body.expressed_in(rotation(seed), origin)
    axes = [[F(k) for k in row] for row in rotation(seed).tolist()]
    d = [F(c) - F(o) for c, o in zip(com.tolist(), origin.tolist(), strict=True)]
    true = [sum(axes[k][i] * d[k] for k in range(3)) for i in range(3)]
    squares = sum((F(a) - b) ** 2 for a, b in zip(properties.center_of_mass.tolist(), true, strict=True))
    assert squares <= F(properties.error.center_of_mass) ** 2
    tensor = [F(k) for k in body.inertia.diagonal().tolist()]
    assert_tensor_bounded(
        properties, [[sum(axes[k][i] * tensor[k] * axes[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    )


def test_a_frame_is_a_rotation() -> None:
    body = of_box((0, 0, 0), (1, 2, 3))
    with pytest.raises(UsageError, match="left-handed"):
        body.expressed_in(-np.eye(3))
    with pytest.raises(UsageError, match="origin must have shape"):
        body.expressed_in(np.eye(3), [1, 2])


def test_another_mass_takes_the_tensor_along() -> None:
    body = of_box((0, 0, 0), (1, 2, 3))
    properties = body.with_mass(18.0)
    assert properties.mass == 18.0
    assert properties.volume == 6.0
    assert properties.center_of_mass.tolist() == body.center_of_mass.tolist()
    assert properties.inertia.tolist() == (3 * body.inertia).tolist()


# Errors, carried through


def true_body(seed: int, size: float, mass: int) -> tuple[Fraction, list[Fraction], list[list[Fraction]]]:
    """Return mass, first and second moments (about the origin) of six points."""
    rng = np.random.default_rng(seed)
    places = [[F(x) for x in row] for row in (size * rng.normal(size=(6, 3))).tolist()]
    m = F(mass, 6)
    first = [sum(m * p[i] for p in places) for i in range(3)]
    second = [[sum(m * p[i] * p[j] for p in places) for j in range(3)] for i in range(3)]
    return F(mass), first, second


def central(mass: Fraction, first: list, second: list) -> tuple[list[Fraction], list[list[Fraction]]]:
    com = [k / mass for k in first]
    s = [[second[i][j] - first[i] * com[j] for j in range(3)] for i in range(3)]
    trace = s[0][0] + s[1][1] + s[2][2]
    return com, [[(i == j) * trace - s[i][j] for j in range(3)] for i in range(3)]


def as_measured(body: tuple, error: ErrorBound, seed: int) -> MassProperties:
    """Return a body whose figures are off by just less than its errors say, in directions at random."""
    rng = np.random.default_rng(seed)
    mass, *_ = body
    com, tensor = (np.array(k, float) for k in central(*body))
    direction = rng.normal(size=3)
    twist = rng.normal(size=(3, 3))
    twist += twist.T
    near = 0.999
    size = np.linalg.norm(tensor) * error.inertia / (1 + error.inertia)
    tensor = tensor + near * size * twist / np.linalg.norm(twist)
    return MassProperties(
        float(mass) * (1 + near * rng.choice([-1, 1]) * error.mass / (1 + error.mass)),
        0.0,
        com + near * error.center_of_mass * direction / np.linalg.norm(direction),
        tensor,
        error,
    )


def assert_covers(
    properties: MassProperties, mass: Fraction, com: list[Fraction], tensor: list[list[Fraction]]
) -> None:
    assert abs(F(properties.mass) - mass) <= F(properties.error.mass) * F(properties.mass)
    squares = sum((F(a) - b) ** 2 for a, b in zip(properties.center_of_mass.tolist(), com, strict=True))
    assert squares <= F(properties.error.center_of_mass) ** 2
    assert_tensor_bounded(properties, tensor)


errors = st.tuples(*[st.sampled_from([1e-11, 1e-9, 1e-3, 0.1])] * 3).map(
    lambda e: ErrorBound("measured", 0.0, e[0], e[1], e[2])
)


@settings(deadline=None, max_examples=80)
@given(seeds, errors, errors, st.sampled_from([1, -1]))
def test_sums_and_differences_cover_the_errors_of_both(
    seed: int, error: ErrorBound, other_error: ErrorBound, sign: int
) -> None:
    large, small = true_body(seed, 3.0, 12), true_body(seed + 1, 0.5, 2)
    a, b = as_measured(large, error, seed + 2), as_measured(small, other_error, seed + 3)
    mass = large[0] + sign * small[0]
    first = [x + sign * y for x, y in zip(large[1], small[1], strict=True)]
    second = [[x + sign * y for x, y in zip(u, v, strict=True)] for u, v in zip(large[2], small[2], strict=True)]
    try:
        combined = a + b if sign > 0 else a - b
    except GeometryError:
        assume(sign > 0)  # the difference of two wrong bodies may be no body
        raise
    assert_covers(combined, mass, *central(mass, first, second))


@settings(deadline=None, max_examples=40)
@given(seeds, errors, st.floats(1e-3, 1e3))
def test_another_mass_covers_the_errors_of_the_old(seed: int, error: ErrorBound, mass: float) -> None:
    true = true_body(seed, 2.0, 5)
    properties = as_measured(true, error, seed + 1).with_mass(mass)
    com, tensor = central(*true)
    assert_covers(properties, F(mass), com, [[k * F(mass) / true[0] for k in row] for row in tensor])


def test_a_sum_covers_a_light_body_in_the_wrong_place() -> None:
    """Taken for 1 kg at the origin, it is 1.9 kg at 0.1 m: beside a large mass only its own place counts."""
    heavy = MassProperties(1e6, 0.0, [0, 0, 0], np.eye(3), EXACT)
    light = MassProperties(1.0, 0.0, [0, 0, 0], np.eye(3), ErrorBound("measured", 0.0, 0.9, 0.1, 0.0))
    mass, at = F(10**6) + F(19, 10), F(1, 10)
    first = [F(19, 10) * at, F(0), F(0)]
    second = [[F(1 if i == j else 0) for j in range(3)] for i in range(3)]  # two bodies of ∫x² = ½ each
    second[0][0] += F(19, 10) * at**2
    assert_covers(heavy + light, mass, *central(mass, first, second))


@settings(deadline=None, max_examples=50)
@given(seeds, st.floats(1e-3, 1e3))
def test_what_another_mass_rounds_is_in_the_errors(seed: int, mass: float) -> None:
    axes = rotation(seed)
    tensor = axes @ np.diag([1.0, 1.3, 2.1]) @ axes.T
    body = MassProperties(0.7, 1.0, [0, 0, 0], (tensor + tensor.T) / 2, EXACT)
    scale = F(mass) / F(0.7)
    assert_tensor_bounded(body.with_mass(mass), [[F(k) * scale for k in row] for row in body.inertia.tolist()])


def test_the_error_of_a_volume_is_that_of_both() -> None:
    large = MassProperties(8.0, 8.0, [0, 0, 0], np.eye(3), ErrorBound("a", 0.125, 0, 0, 0))
    small = MassProperties(1.0, 1.0, [0, 0, 0], np.eye(3) / 16, ErrorBound("b", 0.25, 0, 0, 0))
    assert (large - small).error.volume == pytest.approx(1.25 / 7, rel=1e-12)
    assert (large + small).error.volume == pytest.approx(1.25 / 9, rel=1e-12)
    assert (large + small).error.method == "a + b"


def test_errors_of_a_sum_are_not_absurd() -> None:
    body = of_box((0, 0, 0), (1, 1, 1))
    twice = body + of_box((1, 0, 0), (2, 1, 1))
    assert twice.error.inertia < 20 * body.error.inertia
    alone, together = (np.linalg.norm(k.inertia) * k.error.inertia for k in (body, twice))
    assert together > 2 * alone
    assert twice.error.mass < 3 * body.error.mass
    assert twice.error.volume < 3 * body.error.volume
