"""Shifting, re-expressing and judging tensors, against sums over point masses."""

import re
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from inertia.errors import UsageError
from inertia.mass.principal import principal
from inertia.mass.tensor import VALIDITY_TOLERANCE, array_of, faults, point_inertia, reexpress, rotation_of, steiner

_MASKED = np.ma.array(np.eye(3), mask=np.eye(3) == 1)
_COMPLEX = np.array([[2, 1j, 0], [1j, 2, 0], [0, 0, 2]])
SCALES = [1e-30, 1.0, 1e30]
seeds = st.integers(0, 2**32 - 1)


def cloud(seed: int, count: int = 7) -> tuple[np.ndarray, np.ndarray]:
    """Return positions (n, 3) and masses (n,) of points."""
    rng = np.random.default_rng(seed)
    return rng.normal(size=(count, 3)) * [3.0, 1.0, 0.3], rng.uniform(0.1, 2, count)


def summed(positions: np.ndarray, masses: np.ndarray, about: np.ndarray) -> np.ndarray:
    """Return Σ m (r² δ − r rᵀ) as the textbook's double sum writes it."""
    r = positions - about
    tensor = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            tensor[i, j] = sum(m * ((i == j) * (x @ x) - x[i] * x[j]) for m, x in zip(masses, r, strict=True))
    return tensor


def rotation(seed: int) -> np.ndarray:
    q: np.ndarray = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return q * np.linalg.det(q)


@settings(deadline=None)
@given(seeds, st.floats(0, 100))
def test_shifting_between_any_points_is_summing_about_the_other(seed: int, distance: float) -> None:
    positions, masses = cloud(seed)
    mass, com = masses.sum(), masses @ positions / masses.sum()
    about, to = distance * np.random.default_rng(seed + 1).normal(size=(2, 3))
    shifted = steiner(summed(positions, masses, about), mass, com, about=about, to=to)
    size = max(np.linalg.norm(summed(positions, masses, p)) for p in (about, to))
    assert shifted == pytest.approx(summed(positions, masses, to), abs=1e-13 * size)


def test_shifting_to_the_same_point_changes_nothing() -> None:
    tensor = rotation(3) @ np.diag([1.0, 2, 2.5]) @ rotation(3).T
    assert steiner(tensor, 7.0, [0.1, 0.2, 0.3], about=[5, 6, 7], to=[5, 6, 7]).tolist() == tensor.tolist()


def test_a_rod_about_its_end_and_a_disc_about_its_rim() -> None:
    """M l²/12 + M (l/2)² = M l²/3 for a rod; 3/2 M R² for a disc about its rim."""
    m, l, r = 3.0, 4.0, 2.0
    rod = np.diag([0.0, m * l**2 / 12, m * l**2 / 12])
    assert steiner(rod, m, [2, 0, 0], about=[2, 0, 0], to=[0, 0, 0]).diagonal().tolist() == [0, 16, 16]
    disc = np.diag([m * r**2 / 4, m * r**2 / 4, m * r**2 / 2])
    assert steiner(disc, m, [0, 0, 0], about=[0, 0, 0], to=[r, 0, 0])[2, 2] == 1.5 * m * r**2


def test_products_of_inertia_are_negative_off_the_diagonal() -> None:
    assert point_inertia(2.0, [1, 2, 3]).tolist() == [[26, -4, -6], [-4, 20, -12], [-6, -12, 10]]
    assert steiner(np.zeros((3, 3)), 2.0, [1, 1, 0], about=[1, 1, 0], to=[0, 0, 0])[0, 1] == -2


@settings(deadline=None)
@given(seeds, seeds)
def test_reexpressing_is_summing_coordinates_along_the_new_axes(seed: int, turned: int) -> None:
    positions, masses = cloud(seed)
    axes = rotation(turned)
    tensor = reexpress(summed(positions, masses, np.zeros(3)), axes)
    assert tensor == pytest.approx(summed(positions @ axes, masses, np.zeros(3)), abs=1e-13 * np.abs(tensor).max())
    assert tensor.tolist() == tensor.T.tolist()


def test_reexpressing_takes_columns_as_the_new_axes() -> None:
    new_x_is_old_y = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert reexpress(np.diag([1.0, 2, 2.5]), new_x_is_old_y).diagonal().tolist() == [2.0, 1.0, 2.5]


@pytest.mark.parametrize("size", [1e-9, -1e-9])
def test_a_rotation_is_taken_just_inside_its_limit_and_refused_just_outside(size: float) -> None:
    skewed = rotation(5) @ (np.eye(3) + np.diag([size / 2, 0, 0]))  # RᵀR is off by `size`
    inside = rotation(5) @ (np.eye(3) + np.diag([0.499 * size, 0, 0]))
    outside = rotation(5) @ (np.eye(3) + np.diag([0.501 * size, 0, 0]))
    assert abs(skewed.T @ skewed - np.eye(3)).max() == pytest.approx(1e-9, rel=1e-5)
    assert rotation_of(inside).tolist() == inside.tolist()
    with pytest.raises(UsageError, match="off orthonormal by 1e-09, the limit is 1e-9"):
        rotation_of(outside)


@pytest.mark.parametrize(
    ("value", "match"),
    [
        (np.diag([1.0, 1, -1]), "left-handed"),
        (-np.eye(3), "left-handed"),
        (2 * np.eye(3), "off orthonormal by 3"),
        (rotation(5).astype(np.float32), "limit is 1e-9: give more digits, or, .* Rotation.from_matrix of scipy"),
        (np.zeros((3, 3)), "off orthonormal by 1"),
        (np.eye(2), r"rotation must have shape \(3, 3\), not \(2, 2\)"),
        (np.full((3, 3), np.nan), "rotation holds a value that is not finite"),
        ([[1, 0], [0, 1, 0], [0, 0, 1]], "rotation must be numbers of shape"),
    ],
)
def test_what_is_no_rotation_is_refused(value: object, match: str) -> None:
    for call in (rotation_of, lambda r: reexpress(np.eye(3), r)):
        with pytest.raises(UsageError, match=match) as e:
            call(value)
        assert e.value.exit_code == 2


@pytest.mark.parametrize(
    "call",
    [
        lambda bad: steiner(np.eye(3), 1.0, bad, about=[0, 0, 0], to=[0, 0, 0]),
        lambda bad: steiner(np.eye(3), 1.0, [0, 0, 0], about=bad, to=[0, 0, 0]),
        lambda bad: steiner(np.eye(3), 1.0, [0, 0, 0], about=[0, 0, 0], to=bad),
        lambda bad: steiner(bad, 1.0, [0, 0, 0], about=[0, 0, 0], to=[0, 0, 0]),
        lambda bad: point_inertia(1.0, bad),
        lambda bad: faults(bad),
        lambda bad: reexpress(bad, np.eye(3)),
    ],
)
@pytest.mark.parametrize(
    "bad", [[1, 2], [[1, 2, np.inf]] * 3, [1, np.nan, 2], "abc", None, [[1], [2, 3], 4], _MASKED, _COMPLEX], ids=str
)
def test_what_is_no_array_of_the_shape_is_refused(call: Callable[[object], object], bad: object) -> None:
    with pytest.raises(UsageError):
        call(bad)


@pytest.mark.parametrize(
    "call",
    [principal, lambda it: reexpress(it, np.eye(3)), lambda it: steiner(it, 1, [0, 0, 0], about=[0] * 3, to=[1] * 3)],
)
@pytest.mark.parametrize("scale", [1e-250, 1.0, 1e300])
def test_a_tensor_whose_mirrored_elements_differ_is_refused(call: Callable[[object], object], scale: float) -> None:
    tensor = scale * np.array([[2.0, 0.1, 0.0], [0.1, 3.0, 0.0], [0.0, 0.0, 4.0]])
    call(tensor + np.triu(1e-10 * tensor, 1))
    tensor[0, 1] = -tensor[1, 0]
    with pytest.raises(UsageError, match=r"not symmetric: -\S+ at \[0\]\[1\] and \S+ at \[1\]\[0\]"):
        call(tensor)


def test_elements_that_differ_in_their_last_digits_are_shown_with_them_and_the_remedy_helps() -> None:
    turned = rotation(3).astype(np.float32)
    tensor = turned @ np.diag([1.0, 2.0, 2.5]).astype(np.float32) @ turned.T
    with pytest.raises(
        UsageError, match=r"differ by \d\S*e-0\d, the limit is 1e-09 of the largest .*\(J \+ J.T\)/2"
    ) as e:
        principal(tensor)
    here, there = re.findall(r"(\S+) at ", str(e.value))
    assert here != there
    assert principal((tensor + tensor.T) / 2).moments == pytest.approx([1.0, 2.0, 2.5], rel=1e-6)


def test_the_rotation_nearest_to_one_of_few_digits_is_taken() -> None:
    rounded = rotation(5).astype(np.float32)
    assert rotation_of(Rotation.from_matrix(rounded)) == pytest.approx(rounded, abs=1e-7)


@pytest.mark.parametrize("mass", [-2.0, 0.0, np.nan, np.inf, 10**400, "heavy", None, True])
def test_a_mass_that_is_none_shifts_nothing(mass: object) -> None:
    with pytest.raises(UsageError, match=r"mass is .*: it must be (positive and finite|a number of kg)"):
        steiner(np.eye(3), mass, [0, 0, 0], about=[0, 0, 0], to=[0, 0, 3])


def test_a_shift_beyond_float64_is_refused() -> None:
    with pytest.raises(UsageError, match=r"about .* \[0.0, 0.0, 1e\+200\] is above 1.8e308: name nearer points"):
        steiner(np.eye(3), 1.0, [0, 0, 0], about=[0, 0, 0], to=[0, 0, 1e200])


def test_an_array_is_a_copy() -> None:
    vector = np.zeros(3)
    array_of(vector, (3,), "x")[0] = 1
    assert vector[0] == 0


# Physical validity


def turned(moments: list[float], seed: int) -> np.ndarray:
    axes = rotation(seed)
    tensor: np.ndarray = axes @ np.diag(moments) @ axes.T
    return (tensor + tensor.T) / 2


@settings(deadline=None)
@given(seeds, st.sampled_from(SCALES), st.integers(1, 6))
def test_every_cloud_of_points_has_a_physical_tensor(seed: int, scale: float, count: int) -> None:
    """One point has rank 2, two lie on a line, three in a plane: the edges of what is physical."""
    positions, masses = cloud(seed, count)
    com = masses @ positions / masses.sum()
    assert faults(scale * summed(positions, masses, com)) == []
    assert faults(scale * summed(positions, masses, np.ones(3))) == []


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("tolerance", [1e-6, VALIDITY_TOLERANCE, 1e-12])
def test_the_triangle_rule_is_held_to_its_tolerance_from_both_sides(scale: float, seed: int, tolerance: float) -> None:
    """With I1 + I2 = I3 − e, the trace is 2 I3 − e: refused where e > tolerance × trace."""
    for share, expected in ((0.99, 0), (1.01, 1)):
        e = share * tolerance * 6 / (1 + share * tolerance)
        sentences = faults(scale * turned([1.0, 2.0 - e, 3.0], seed), tolerance)
        assert len(sentences) == expected
        assert all("break the triangle rule: no body has I1 + I2 < I3" in text for text in sentences)


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("tolerance", [1e-6, VALIDITY_TOLERANCE, 1e-12])
def test_positivity_is_held_to_its_tolerance_from_both_sides(scale: float, tolerance: float) -> None:
    """Negative by e beside two equal moments: refused where e > tolerance × trace, as I3 − I2 = 0 > −e − tolerance."""
    for share, expected in ((0.99, 0), (1.01, 1)):
        e = share * tolerance * 2 / (1 + share * tolerance)
        sentences = faults(scale * np.diag([1.0, -e, 1.0]), tolerance)
        assert len(sentences) == expected
        assert all("are not all positive" in text for text in sentences)


@pytest.mark.parametrize("scale", SCALES)
def test_symmetry_is_held_to_its_tolerance_from_both_sides(scale: float) -> None:
    for share, expected in ((0.99, 0), (1.01, 1)):
        tensor = np.diag([2.0, 2.0, 2.0])
        tensor[0, 1] += share * VALIDITY_TOLERANCE * 6
        sentences = faults(scale * tensor)
        assert len(sentences) == expected
        assert all("not symmetric" in text for text in sentences)


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize(
    ("moments", "match"),
    [
        ([-1.0, -1.0, -1.0], "-1, -1, -1 are not all positive"),
        ([-1.0, 1.0, 1.0], "are not all positive"),
        ([1.0, 1.0, 2.1], "break the triangle rule"),
        ([0.0, 0.0, 1.0], "break the triangle rule"),
    ],
)
def test_no_body_has_such_moments(moments: list[float], match: str, scale: float) -> None:
    (text,) = faults(scale * np.diag(moments))
    assert match.replace("-1, -1, -1", ", ".join([f"{-scale:.6g}"] * 3)) in text


def test_a_tensor_without_a_trace() -> None:
    assert faults(np.zeros((3, 3))) == []
    assert faults(np.diag([1.0, 0.0, -1.0])) == ["the trace is zero but the tensor is not"]
    assert faults([[0, 1, 0], [1, 0, 0], [0, 0, 0]]) == ["the trace is zero but the tensor is not"]


def test_a_lamina_and_a_rod_are_on_the_edge_and_physical() -> None:
    assert faults(np.diag([1.0, 2.0, 3.0])) == []
    assert faults(np.diag([0.0, 1.0, 1.0])) == []
