"""Needles and plates of any slenderness: principal moments within their bounds, the smallest to its last digits."""

from fractions import Fraction

import numpy as np
import pytest
from tests.mass.parts import assert_within_bound, exact, surface
from tests.mass.spectra import eigenvalues
from tests.mesh.solids import sphere

import inertia
from inertia.mass.principal import principal
from inertia.mass.properties import MassProperties
from inertia.mass.triangles.moments_from_sums import moments_of
from inertia.mass.triangles.sums import sum_triangles
from inertia.mesh.part import Part
from inertia_meshes.rational import moments
from inertia_meshes.shapes import box, mapped, moved

F = Fraction
ASPECTS = [1e2, 1e3, 1e6, 1e9, 1e12]
SCALES = [1e-30, 1.0, 1e30]


def turn(seed: int) -> np.ndarray:
    q: np.ndarray = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return q * np.linalg.det(q)


def needle(aspect: float, askew: bool, scale: float = 1.0) -> Part:
    """Return a rod along x, or along no axis, whose section is one by two."""
    rod = box(1, 2 / aspect, 1 / aspect)
    return surface(scale * moved(mapped(rod, turn(1)), 0.01, 0.02, 0.03) if askew else scale * rod)


def plate(aspect: float, askew: bool, scale: float = 1.0) -> Part:
    """Return a sheet of one by 0.7."""
    sheet = box(1, 0.7, 1 / aspect)
    return surface(scale * (mapped(sheet, turn(2)) if askew else sheet))


def assert_moments_bounded(properties: MassProperties, truth: list[Fraction]) -> None:
    principal = properties.principal
    for value, bound, true in zip(principal.moments.tolist(), principal.moment_bounds.tolist(), truth, strict=True):
        assert abs(F(value) - true) <= F(bound) + true / 10**30  # of the oracle


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("askew", [False, True], ids=["along x", "askew"])
@pytest.mark.parametrize("aspect", ASPECTS)
@pytest.mark.parametrize("shape", [needle, plate])
def test_without_being_asked_the_moments_are_right_to_nine_digits(
    shape: object, aspect: float, askew: bool, scale: float
) -> None:
    part = shape(aspect, askew, scale)
    properties = inertia.mass_properties(part)
    truth = exact(part)
    assert_within_bound(properties, truth)
    assert_moments_bounded(properties, eigenvalues(truth.inertia, 90))
    if shape is needle or not askew:
        assert (properties.principal.moment_bounds <= 1e-9 * properties.principal.moments).all()


@pytest.mark.parametrize("power", [11.0, 13.0, 14.5])
def test_the_volume_of_a_thin_lens_is_right_to_nine_digits(power: float) -> None:
    """In float64 the bound of its volume is up to 3 %, which is no drowning, and the moments are as uncertain."""
    vertices, faces = sphere(splits=2)
    part = Part.from_arrays(mapped(vertices * [1, 0.8, 10.0**-power], turn(4)), faces)
    properties, truth = inertia.mass_properties(part), exact(part)
    assert_within_bound(properties, truth)
    assert_moments_bounded(properties, eigenvalues(truth.inertia, 90))
    assert properties.error.volume <= 1e-9
    assert (properties.principal.moment_bounds <= 1e-9 * properties.principal.moments).all()


@pytest.mark.parametrize("kind", ["lens", "needle", "thin wall", "ball"])
def test_no_answer_is_less_certain_than_nine_digits_where_more_can_be_had(kind: str) -> None:
    for seed in range(40):
        rng = np.random.default_rng(seed)
        vertices, faces = sphere(splits=int(rng.integers(1, 4)))
        if kind == "thin wall":
            inner = vertices * (1 - 10.0 ** -rng.uniform(1, 9))
            vertices, faces = np.vstack([vertices, inner]), np.vstack([faces, faces[:, ::-1] + len(vertices)])
        thin = {"lens": [0, 0.2, rng.uniform(1, 9)], "needle": [0, *rng.uniform(0.5, 6, 2)]}.get(kind, [0, 0, 0])
        vertices = mapped(vertices * 10.0 ** -np.array(thin), turn(seed))
        if seed % 2:
            vertices = vertices + rng.normal(size=3) * 10.0 ** rng.uniform(0, 7)
        properties = inertia.mass_properties(Part.from_arrays(vertices, faces))
        assert properties.error.volume <= 1e-9, seed
        assert (properties.principal.moment_bounds <= 1e-9 * properties.principal.moments).all(), seed


def test_what_is_asked_for_less_certainty_is_given_less() -> None:
    vertices, faces = sphere(splits=2)
    part = Part.from_arrays(mapped(vertices * [1, 0.8, 1e-10], turn(4)), faces)
    methods = [inertia.mass_properties(part, accuracy=accuracy).error.method[:7] for accuracy in (1e-3, 1e-8, None)]
    assert methods == ["float64", "double-", "double-"]


@pytest.mark.parametrize("accuracy", [1e-12, "exact"])
@pytest.mark.parametrize("aspect", ASPECTS)
def test_what_is_asked_for_a_needle_is_rounded_once_where_it_has_to_be_exact(
    aspect: float, accuracy: float | str
) -> None:
    part = needle(aspect, True)
    properties = inertia.mass_properties(part, accuracy=accuracy)
    truth = eigenvalues(exact(part).inertia, 90)
    assert_moments_bounded(properties, truth)
    if accuracy == "exact":
        assert properties.principal_moments.tolist() == [float(k) for k in truth]


@pytest.mark.parametrize("askew", [False, True], ids=["along x", "askew"])
@pytest.mark.parametrize("aspect", [1e2, 1e4, 1e6])
def test_float64_sums_say_what_they_lost(aspect: float, askew: bool) -> None:
    """Along x nothing is lost; askew the smallest moment is, and the bound says so."""
    triangles = needle(aspect, askew).triangles
    sums = moments_of(sum_triangles(triangles))
    properties = MassProperties.from_moments(sums, sums.zeroth, sums.zeroth_bound, "test")
    assert_moments_bounded(properties, eigenvalues(moments(triangles.corners()).inertia, 90))
    certain = properties.principal.moment_bounds[0] / properties.principal.moments[0]
    assert (certain < 1e-13) == (not askew)
    assert properties.loses_smallest_moment == askew


def test_only_slender_parts_need_more_digits_than_float64() -> None:
    for part in (needle(10, True), needle(1e9, False), plate(1e3, True), surface(box(1, 2, 3))):
        assert inertia.mass_properties(part).error.method.startswith("float64")
    methods = {aspect: inertia.mass_properties(needle(aspect, True)).error.method for aspect in (1e3, 1e9)}
    assert methods[1e3].startswith("double-double")
    assert methods[1e9].startswith("exact")


def test_the_tensor_in_part_axes_has_lost_what_the_moments_have_not() -> None:
    properties = inertia.mass_properties(needle(1e9, True))
    of_tensor = principal(
        properties.inertia, bound=properties.error.inertia * float(np.linalg.norm(properties.inertia))
    )
    assert of_tensor.moment_bounds[0] > 10 * properties.principal_moments[0]
    assert properties.principal.moment_bounds[0] < 1e-15 * properties.principal_moments[0]


def test_the_axis_of_a_needle_is_certain_and_those_across_are_none() -> None:
    decomposition = inertia.mass_properties(needle(1e9, True)).principal
    assert (decomposition.kind, decomposition.equal) == ("rotor", ((1, 2),))
    assert decomposition.axis_bounds[0] < 1e-15
    assert decomposition.axis_bounds[1:].tolist() == [np.pi / 2] * 2
    across = inertia.mass_properties(needle(1e9, True)).principal_within(0.0)
    assert (across.kind, across.equal) == ("asymmetric", ())
    assert across.axis_bounds.max() < 1e-14


def test_a_needle_keeps_its_moments_in_an_assembly() -> None:
    """Two halves of one needle: the tensors' elements would have lost the smallest moment."""
    whole = box(1, 2e-9, 1e-9)
    halves = [inertia.mass_properties(surface(mapped(k, turn(1)))) for k in (_half(whole, -1), _half(whole, 1))]
    properties = halves[0] + halves[1]
    assert properties.principal_moments[0] == pytest.approx(1000 * 2e-18 * 5e-18 / 12, rel=1e-6)
    assert properties.principal.moment_bounds[0] < 1e-9 * properties.principal_moments[0]


def _half(corners: np.ndarray, side: int) -> np.ndarray:
    half: np.ndarray = corners.copy()
    half[..., 0] = np.where(half[..., 0] * side > 0, half[..., 0], 0)
    return half
