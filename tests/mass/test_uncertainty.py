"""Standard uncertainties against Monte Carlo (JCGM 101) of the moments of tetrahedra, and against closed forms."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.mass.cells.textbook_cells import reference
from tests.mass.parts import cells as cells_of
from tests.mesh.readers.step_sample import step_torus
from tests.mesh.solids import cube, joined, sphere

import inertia
from inertia import Estimate
from inertia.arrays import Float
from inertia.errors import GeometryError, UsageError
from inertia.mesh.part import Part, Regions
from inertia.units import length_unit
from inertia_meshes import path
from inertia_meshes.rational import moments

DRAWS = 20_000
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def ellipsoid(splits: int = 1) -> tuple[Float, np.ndarray]:
    vertices, faces = sphere((0.3, -0.2, 0.5), 1.0, splits)
    return np.asarray(vertices) * [1.0, 1.6, 2.5], np.asarray(faces)


def drawn(vertices: Float, faces: np.ndarray, sigma: float, draws: int = DRAWS, seed: int = 4) -> Float:
    """Return volume, centre and tensor elements (draws, 10) of solids with noisy vertices, at unit density."""
    rng = np.random.default_rng(seed)
    rows = []
    for _ in range(0, draws, 1000):
        corners = (vertices + rng.normal(0, sigma, (1000, *vertices.shape)))[:, faces]
        a, b, c = (corners[:, :, k] for k in range(3))
        d = np.einsum("nti,nti->nt", a, np.cross(b, c))
        s = a + b + c
        volume = d.sum(axis=1) / 6
        com = np.einsum("nt,nti->ni", d, s) / 24 / volume[:, None]
        second = np.einsum("nt,nti,ntj->nij", d, s, s) + sum(np.einsum("nt,nti,ntj->nij", d, x, x) for x in (a, b, c))
        central = second / 120 - volume[:, None, None] * com[:, :, None] * com[:, None]
        tensor = np.trace(central, axis1=1, axis2=2)[:, None, None] * np.eye(3) - central
        rows.append(np.column_stack([volume, com, *(tensor[:, i, j] for i, j in PAIRS)]))
    return np.concatenate(rows)


def tensors(rows: Float) -> Float:
    result = np.empty((len(rows), 3, 3))
    for k, (i, j) in enumerate(PAIRS, 4):
        result[:, i, j] = result[:, j, i] = rows[:, k]
    return result


def test_noise_of_vertices_scatters_the_results_as_the_covariance_says() -> None:
    vertices, faces = ellipsoid()
    sigma = 0.01
    u = inertia.analyse(Part.from_arrays(vertices, faces), 1.0, sigma=sigma).uncertainty
    rows = drawn(vertices, faces, sigma)
    np.testing.assert_allclose(u.of()[[0, 2, 3, 4, 5, 6, 7, 8, 9, 10]], rows.std(axis=0), rtol=0.03)
    assert u.mass == u.volume
    pick = [0, 2, 3, 4, 5, 6, 7, 8, 9, 10]
    scale = np.outer(u.of()[pick], u.of()[pick])
    np.testing.assert_allclose(u.covariance[np.ix_(pick, pick)] / scale, np.cov(rows.T) / scale, atol=0.04)


def test_noise_turns_the_axes_and_moves_the_moments_as_stated() -> None:
    vertices, faces = ellipsoid()
    sigma = 0.01
    analysis = inertia.analyse(Part.from_arrays(vertices, faces), 1.0, sigma=sigma)
    values, columns = np.linalg.eigh(tensors(drawn(vertices, faces, sigma)))
    u = analysis.uncertainty
    np.testing.assert_allclose(u.principal_moments, values.std(axis=0), rtol=0.03)
    cosines = np.abs(np.einsum("nik,ik->nk", columns, analysis.principal.axes))
    angles = np.arccos(np.minimum(cosines, 1.0))
    np.testing.assert_allclose(u.principal_axes, np.sqrt((angles**2).mean(axis=0)), rtol=0.03)
    assert u.principal.equal == ()


def test_a_tensor_about_another_point_shares_its_noise_with_the_centre() -> None:
    vertices, faces = ellipsoid()
    sigma, point = 0.01, np.array([2.0, -1.0, 0.5])
    u = inertia.analyse(Part.from_arrays(vertices, faces), 1.0, sigma=sigma).uncertainty
    rows = drawn(vertices, faces, sigma)
    b = rows[:, 1:4] - point
    shift = (b * b).sum(axis=1)[:, None, None] * np.eye(3) - b[:, :, None] * b[:, None]
    about = tensors(rows) + rows[:, 0, None, None] * shift
    np.testing.assert_allclose(u.about(point), about.std(axis=0), rtol=0.03)
    np.testing.assert_allclose(u.about(u.properties.center_of_mass), u.inertia, rtol=1e-12)


@pytest.mark.parametrize("weighed", [False, True])
def test_noise_makes_a_computed_tensor_larger_on_average_by_the_bias_stated(weighed: bool) -> None:
    vertices, faces = ellipsoid(0)
    sigma = 0.05
    part = Part.from_arrays(vertices, faces)
    analysis = inertia.analyse(part, None if weighed else 1.0, mass=2.0 if weighed else None, sigma=sigma)
    rows = drawn(vertices, faces, sigma, 200_000)
    if weighed:
        rows[:, 4:] *= 2.0 / rows[:, :1]
    bias = analysis.uncertainty.bias
    expected = np.array([bias[i, j] for i, j in PAIRS])
    truth = np.array([analysis.properties.inertia[i, j] for i, j in PAIRS])
    error = rows[:, 4:].std(axis=0) / math.sqrt(len(rows))
    np.testing.assert_array_less(np.abs(rows[:, 4:].mean(axis=0) - truth - expected), 4 * error + 0.05 * expected.max())
    assert (expected[:3] > 10 * error[:3]).all()
    assert abs(rows[:, 0].mean() - inertia.mass_properties(part).volume) < 4 * rows[:, 0].std() / math.sqrt(len(rows))


def test_bias_of_a_fine_mesh_is_mass_times_variance_and_is_said_where_it_shows() -> None:
    vertices, faces = ellipsoid(4)
    analysis = inertia.analyse(Part.from_arrays(vertices, faces), 3.0, sigma=0.02)
    expected = analysis.properties.mass * 0.02**2 * np.eye(3)
    np.testing.assert_allclose(analysis.uncertainty.bias, expected, atol=0.02 * expected.max())
    assert any("larger by" in remark for remark in analysis.uncertainty.remarks)


def test_noise_as_large_as_the_edges_is_said_to_leave_first_order() -> None:
    vertices, faces = ellipsoid(2)
    part = Part.from_arrays(vertices, faces)
    small, large = (inertia.analyse(part, 1.0, sigma=sigma).uncertainty for sigma in (0.005, 0.3))
    assert small.remarks == ()
    assert any("not small beside the edges" in remark for remark in large.remarks)
    fine, coarse = (drawn(vertices, faces, sigma, 4000)[:, 0].std() for sigma in (0.005, 0.3))
    assert fine == pytest.approx(small.volume, rel=0.04)
    assert coarse > 1.05 * large.volume


def test_moments_of_a_cube_are_equal_and_scatter_together() -> None:
    mesh = joined(cube())
    vertices, faces = np.unique(mesh.vertices, axis=0, return_inverse=True)
    faces = faces.reshape(-1)[mesh.faces]
    u = inertia.analyse(Part.from_arrays(vertices, faces), 1.0, sigma=0.002).uncertainty
    assert u.principal.equal == ((0, 1, 2),)
    assert np.isnan(u.principal_axes).all()
    values = np.linalg.eigvalsh(tensors(drawn(vertices, faces, 0.002)))
    spread = math.sqrt(((values - 1 / 6) ** 2).mean())
    np.testing.assert_allclose(u.principal_moments, spread, rtol=0.03)


def test_moments_nearer_than_their_uncertainty_have_undetermined_axes() -> None:
    vertices, faces = ellipsoid()
    near = np.asarray(vertices) * [1.0, 1.0 / 1.59, 1.0]
    analysis = inertia.analyse(Part.from_arrays(near, faces), 1.0, sigma=0.02)
    assert analysis.principal.equal == ()
    assert analysis.uncertainty.principal.equal == ((1, 2),)
    axes = analysis.uncertainty.principal_axes
    assert np.isnan(axes).tolist() == [False, True, True]
    columns = np.linalg.eigh(tensors(drawn(near, faces, 0.02)))[1]
    angle = np.arccos(np.minimum(np.abs(columns[:, :, 0] @ analysis.principal.axes[:, 0]), 1.0))
    assert axes[0] == pytest.approx(math.sqrt((angle**2).mean()), rel=0.04)


def test_noise_of_cells_is_that_of_their_outside() -> None:
    corners = reference("hexahedron")  # a cube of edge 2: a corner has a quarter of three faces, ∂V/∂x = (1, 1, 1)
    one = inertia.analyse(cells_of("hexahedron", corners), 1.0, sigma=0.01).uncertainty
    assert one.volume == pytest.approx(0.01 * math.sqrt(8 * 3))
    # Of two, the four nodes that they share move nothing across their common face, and twice as much along it.
    both = cells_of("hexahedron", corners, corners + np.array([2, 0, 0]))
    assert inertia.analyse(both, 1.0, sigma=0.01).uncertainty.volume == pytest.approx(0.01 * math.sqrt(8 * 3 + 4 * 8))


def test_noise_makes_a_shell_larger_and_it_is_said() -> None:
    vertices, faces = ellipsoid(4)
    analysis = inertia.analyse(Part.from_arrays(vertices, faces), 1.0, shell=0.1, sigma=0.02)
    rng = np.random.default_rng(2)
    areas = []
    for _ in range(20):
        a, b, c = np.moveaxis((vertices + rng.normal(0, 0.02, vertices.shape))[faces], 1, 0)
        areas.append(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
    (remark,) = analysis.uncertainty.remarks
    stated = float(remark.split("larger by ")[1].split(" m²")[0])
    assert stated == pytest.approx(np.mean(areas) - analysis.area, rel=0.1)


def two_boxes() -> Part:
    mesh = joined(cube((0, 0, 0)), cube((3, 0, 0)))
    regions = Regions(("steel", "lead"), np.repeat(np.arange(2, dtype=np.int32), 12))
    return Part(mesh, length_unit("m"), "option", regions=regions)


def test_one_density_is_common_to_all_and_moves_no_centre() -> None:
    u = inertia.analyse(two_boxes(), Estimate(10, 0.5)).uncertainty
    assert u.inputs == {"density": 0.5}
    assert (u.volume, u.mass) == (0.0, pytest.approx(1.0))
    np.testing.assert_allclose(u.center_of_mass, 0, atol=1e-15)
    tensor = inertia.mass_properties(two_boxes(), 10).inertia
    np.testing.assert_allclose(u.inertia, 0.05 * np.abs(tensor), atol=1e-14)


def test_densities_with_names_are_independent_of_each_other() -> None:
    u = inertia.analyse(two_boxes(), {"steel": Estimate(8, 0.3), "lead": Estimate(11, 0.4)}).uncertainty
    assert u.mass == pytest.approx(0.5)
    # x = (0·8 + 3·11)/19: ∂x/∂ρ₁ = −x/19, ∂x/∂ρ₂ = (3 − x)/19.
    x = 33 / 19
    assert u.center_of_mass[0] == pytest.approx(math.hypot(0.3 * x, 0.4 * (3 - x)) / 19)
    # I_yy = (m₁ + m₂)/6 + μ 9 with μ = m₁ m₂/(m₁ + m₂), ∂μ/∂m₁ = (m₂/(m₁ + m₂))².
    along = [0.3 * (1 / 6 + 9 * (11 / 19) ** 2), 0.4 * (1 / 6 + 9 * (8 / 19) ** 2)]
    assert u.inertia[1, 1] == pytest.approx(math.hypot(*along))
    assert u.of("density of steel")[1] == pytest.approx(0.3)


def test_a_mass_as_weighed_is_the_only_thing_uncertain_of_it() -> None:
    analysis = inertia.analyse(two_boxes(), mass=Estimate(1.2, 0.006), scale=Estimate(1, 0.01))
    u, tensor = analysis.uncertainty, analysis.properties.inertia
    assert u.mass == pytest.approx(0.006)
    assert u.volume == pytest.approx(3 * 0.01 * 2)
    np.testing.assert_allclose(u.inertia, np.abs(tensor) * math.hypot(0.005, 2 * 0.01), atol=1e-15)
    np.testing.assert_allclose(u.center_of_mass, [0.01 * 1.5, 0, 0], atol=1e-15)


@pytest.mark.parametrize(("shell", "power"), [(None, 3), (0.5, 2)])
def test_a_scale_is_common_to_all_coordinates(shell: float | None, power: int) -> None:
    analysis = inertia.analyse(two_boxes(), 10.0, shell=shell, scale=Estimate(1, 0.001))
    u, properties = analysis.uncertainty, analysis.properties
    assert u.volume == pytest.approx(power * 0.001 * properties.volume)
    np.testing.assert_allclose(u.inertia, (power + 2) * 0.001 * np.abs(properties.inertia), atol=1e-12)
    assert np.allclose(u.covariance, np.outer(u.of(), u.of()) * np.sign(u.covariance))


def test_a_thickness_is_uncertain_as_it_is_written() -> None:
    analysis = inertia.analyse(two_boxes(), 10.0, shell=Estimate(0.5, 0.01))
    assert analysis.uncertainty.inputs == {"thickness": pytest.approx(0.01)}
    assert analysis.uncertainty.mass == pytest.approx(0.02 * analysis.properties.mass)


def test_what_is_certain_has_no_uncertainty() -> None:
    assert inertia.analyse(two_boxes(), Estimate(10.0)).uncertainty is None


def test_refusals_say_what_to_give_instead() -> None:
    part = two_boxes()
    for sigma in (0, True, "0.1"):
        with pytest.raises(UsageError, match=r"sigma is .* it must be positive and finite"):
            inertia.analyse(part, sigma=sigma)
    for scale in (1.02, "1", True):
        with pytest.raises(UsageError, match="1 with an uncertainty"):
            inertia.analyse(part, scale=scale)
    with pytest.raises(UsageError, match="no input is uncertain"):
        inertia.analyse(part, coverage=2)
    made = replace(part, chord=np.full(part.triangles.count, 0.01))
    with pytest.raises(UsageError, match="made from its true shape"):
        inertia.analyse(made, sigma=0.01)
    assert inertia.analyse(made, Estimate(10, 1)).uncertainty.mass == pytest.approx(2)


def cross(vertices: Float, faces: np.ndarray, middle: int) -> Float:
    """Return the moments (10,) at unit density of the union of two solids, by manifold3d and rational arithmetic."""
    from manifold3d import Manifold, Mesh64

    def solid(some: np.ndarray) -> Manifold:
        used, index = np.unique(some, return_inverse=True)
        return Manifold(Mesh64(vertices[used], index.reshape(-1, 3).astype(np.uint64)))

    mesh = (solid(faces[:middle]) + solid(faces[middle:])).to_mesh64()
    m = moments(np.asarray(mesh.vert_properties)[np.asarray(mesh.tri_verts)])
    return np.array([float(k) for k in (m.volume, *m.center_of_mass, *(m.inertia[i][j] for i, j in PAIRS))])


def test_noise_of_bodies_that_are_united_is_that_of_what_is_not_hidden() -> None:
    (a, faces_a), (b, faces_b) = sphere((0, 0, 0), 1.0, 1), sphere((0.9, 0.3, 0.2), 0.8, 1)
    vertices = np.concatenate([np.asarray(a) * [1.0, 1.3, 0.8], b])
    faces = np.concatenate([np.asarray(faces_a), np.asarray(faces_b) + len(a)])
    part = Part.from_arrays(vertices, faces)
    u = inertia.analyse(part, 1.0, union=True, sigma=0.01).uncertainty
    h, jacobian = 1e-6, []
    for k in range(vertices.size):
        low, high = vertices.copy(), vertices.copy()
        low.flat[k] -= h
        high.flat[k] += h
        jacobian.append((cross(high, faces, len(faces_a)) - cross(low, faces, len(faces_a))) / (2 * h))
    rates = np.array(jacobian)
    gradient = inertia.gradient(part, 1.0, union=True)
    np.testing.assert_array_equal(gradient.vertices, vertices)
    np.testing.assert_allclose(gradient.volume.ravel(), rates[:, 0], atol=1e-8)
    np.testing.assert_allclose(u.of()[[0, *range(2, 11)]], 0.01 * np.sqrt((rates**2).sum(axis=0)), rtol=1e-5)
    assert u.bias is None


def test_regions_that_are_united_each_by_itself_keep_their_densities() -> None:
    one = joined(cube((0, 0, 0)), cube((0.5, 0, 0)))
    mesh = joined((one.vertices, one.faces), cube((4, 0, 0)))
    regions = Regions(("a", "b"), np.repeat(np.arange(2, dtype=np.int32), [24, 12]))
    part = Part(mesh, length_unit("m"), "option", regions=regions)
    u = inertia.analyse(part, {"a": 2.0, "b": 3.0}, union=True, sigma=0.01).uncertainty
    alone = [
        inertia.analyse(Part(each, length_unit("m"), "option"), rho, union=True, sigma=0.01).uncertainty.mass
        for each, rho in ((one, 2.0), (joined(cube()), 3.0))
    ]
    assert u.mass == pytest.approx(math.hypot(*alone))


@pytest.mark.parametrize("size", [1e-30, 1e30])
def test_what_leaves_float64_is_refused(size: float) -> None:
    vertices, faces = ellipsoid(0)
    part = Part.from_arrays(vertices * size, faces)
    with pytest.raises(GeometryError, match="covariances leave float64"):
        inertia.analyse(part, Estimate(1, 0.1))


@pytest.mark.parametrize(
    "inputs",
    [{"sigma": 1e160}, {"sigma": 1e300}, {"density": Estimate(10.0, 1e200)}, {"scale": Estimate(1, 1e160)}],
    ids=str,
)
def test_uncertainties_beyond_float64_are_said_to_be_so(inputs: dict) -> None:
    with (
        np.errstate(over="raise"),
        pytest.raises(UsageError, match=r"uncertainties of the inputs lead .* above 1.8e308"),
    ):
        inertia.analyse(two_boxes(), **inputs)


def test_an_input_that_is_not_uncertain_contributes_nothing_that_can_be_asked_for() -> None:
    u = inertia.analyse(two_boxes(), Estimate(10, 1)).uncertainty
    with pytest.raises(UsageError, match=r"no input 'vertices' is uncertain: use one of 'density'"):
        u.of("vertices")


def test_the_results_themselves_do_not_change() -> None:
    part = inertia.read(path("t_handle.stl"), unit="mm")
    plain = inertia.analyse(part, 7850.0).properties
    beside = inertia.analyse(part, Estimate(7850, 50), sigma=0.02, scale=Estimate(1, 0.001)).properties
    assert plain.inertia.tolist() == beside.inertia.tolist()
    assert plain.error == beside.error


def test_a_true_shape_has_uncertain_density_and_scale_but_no_noise(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    file = tmp_path / "torus.step"
    file.write_text(step_torus(30, 10))
    part = inertia.read(file)
    analysis = inertia.analyse(part, Estimate(7850, 50), scale=Estimate(1, 0.001))
    u, volume = analysis.uncertainty, 2 * math.pi**2 * 30 * 10**2 * 1e-9
    assert u.volume == pytest.approx(0.003 * volume)
    assert u.mass == pytest.approx(volume * math.hypot(50, 0.003 * 7850))
    assert u.principal_moments[2] / analysis.principal.moments[2] == pytest.approx(math.hypot(50 / 7850, 0.005))
    for options in ({}, {"tessellated": True}):
        with pytest.raises(UsageError, match="made from its true shape"):
            inertia.analyse(part, sigma=0.01, **options)
    assert inertia.gradient(part).vertices.shape[1] == 3  # of its triangles
