"""Signs of Jacobian determinants over whole cells, against dense sampling of the textbook's shape functions."""

import numpy as np
import pytest
from tests.mass.cells.test_moments import SOLIDS, one_kind
from tests.mass.cells.textbook_cells import reference, shape_functions

import inertia
from inertia.mesh.geometry.cell_maps import TANGLED, covering, jacobians
from inertia.mesh.part import Part

SAMPLED = [kind for kind in SOLIDS if kind != "hexahedron24"]
"""Kinds whose textbook functions take arrays."""


def textbook_map(kind: str, nodes: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return where points (k, 3) of the unit cube go, (k, 3)."""
    return np.stack(np.broadcast_arrays(*shape_functions(kind, *at.T)), axis=1) @ nodes


def sampled(kind: str, nodes: np.ndarray, count: int, seed: int = 0) -> np.ndarray:
    """Return determinants at random points of the unit cube, on its faces and along its edges."""
    rng = np.random.default_rng(seed)
    at, h = rng.random((count, 3)), 1e-5
    at[: count // 2] = np.where(rng.random((count // 2, 3)) < 0.5, np.round(at[: count // 2]), at[: count // 2])
    at = np.clip(at, 10 * h, 1 - 10 * h)
    slopes = [
        (textbook_map(kind, nodes, at + step) - textbook_map(kind, nodes, at - step)) / (2 * h)
        for step in h * np.eye(3)
    ]
    collapse = np.linalg.det(sampled_slopes(kind, at, h))
    return np.einsum("ki,ki->k", slopes[0], np.cross(slopes[1], slopes[2])) / collapse


def sampled_slopes(kind: str, at: np.ndarray, h: float) -> np.ndarray:
    nodes = reference(kind)
    columns = [
        (textbook_map(kind, nodes, at + step) - textbook_map(kind, nodes, at - step)) / (2 * h)
        for step in h * np.eye(3)
    ]
    return np.stack(columns, axis=2)


@pytest.mark.parametrize("kind", [kind for kind in SAMPLED if kind != "tetra"])
def test_signs_are_those_of_dense_samples(kind: str) -> None:
    states = set()
    for seed in range(24):
        rng = np.random.default_rng(seed)
        nodes = reference(kind)
        nodes = nodes + rng.normal(size=nodes.shape) * rng.choice([0.03, 0.1, 0.2, 0.6])
        nodes = nodes * [1, 1, rng.choice([1, -1])]
        result = jacobians(one_kind(kind, nodes))
        values = sampled(kind, nodes, 2000, seed)
        most = np.abs(values).max()
        if result.sign[0] == TANGLED:
            if result.share[0] > 0.05:
                assert values.min() < 0 < values.max()
        else:
            assert (result.sign[0] * values).min() > -1e-7 * most
        states.add(int(result.sign[0]))
    assert states == {-1, 1, TANGLED}


@pytest.mark.parametrize(
    ("kind", "seed"),
    [("tetra10", 279), ("hexahedron20", 22), ("hexahedron27", 106), ("wedge15", 43),
     ("wedge18", 323), ("pyramid14", 80)],
)  # fmt: skip
def test_a_fold_between_the_points_of_quadrature_is_refused_by_number(kind: str, seed: int) -> None:
    """Determinants at the Gauss points and corners are positive, all of them; elsewhere they are not."""
    rng = np.random.default_rng(seed)
    nodes = reference(kind)
    nodes = nodes + rng.normal(size=nodes.shape) * rng.choice([0.1, 0.2, 0.3, 0.5]) * 0.4
    values = sampled(kind, nodes, 20_000)
    assert values.min() < 0 < values.max()
    part = Part(one_kind(kind, reference(kind) + np.array([9, 0, 0]), nodes))
    report = inertia.check(part)
    (fault,) = report.faults()
    assert (fault.code, fault.faces) == ("tangled_cell", (1,))
    with pytest.raises(inertia.GeometryError, match=rf"cell 1 \({kind}, nodes .*\) is tangled: its Jacobian determ"):
        inertia.analyse(part)


def test_a_middle_node_at_a_quarter_of_its_edge_is_answered() -> None:
    """The elements of fracture mechanics have a determinant that falls to zero at a corner."""
    nodes = reference("tetra10")
    nodes[[4, 6, 7]] = nodes[[1, 2, 3]] / 4
    assert inertia.check(Part(one_kind("tetra10", nodes))).fit
    nodes = reference("tetra10")
    nodes[4] = [0.2499, 0, 0]
    assert not inertia.check(Part(one_kind("tetra10", nodes))).fit


@pytest.mark.parametrize("kind", SAMPLED)
def test_a_cell_covers_what_its_map_comes_to_and_nothing_beside(kind: str) -> None:
    rng = np.random.default_rng(1)
    nodes = reference(kind)
    nodes = nodes + 0.01 * rng.normal(size=nodes.shape)
    within = textbook_map(kind, nodes, 0.02 + 0.96 * rng.random((200, 3)))
    pairs = np.column_stack([np.arange(200), np.zeros(200, np.int64)])
    assert covering(one_kind(kind, nodes), within, pairs).all()
    rim = np.concatenate([np.round(rng.random((100, 3))), rng.random((100, 3))])
    rim[np.arange(200), rng.integers(0, 3, 200)] = rng.integers(0, 2, 200)
    middle, outer = nodes.mean(axis=0), textbook_map(kind, nodes, rim)
    assert not covering(one_kind(kind, nodes), outer + 0.1 * (outer - middle), pairs).any()
