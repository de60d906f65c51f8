"""The check of a mesh of cells, and which of them hang together by their faces."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inertia.errors import GeometryError
from inertia.mesh.check import check
from inertia.mesh.checks.cells import CellTopology
from inertia.mesh.checks.findings import Report
from inertia.mesh.part import CellBlock, Cells, Part, Source
from inertia.units import length_unit

RING = [(0, 0), (1, 0), (1, 1), (0, 1)]


def cells(points: np.ndarray, **blocks: list) -> Cells:
    return Cells(np.array(points, float), tuple(CellBlock(kind, np.array(nodes)) for kind, nodes in blocks.items()))


def checked(mesh: Cells) -> Report:
    return check(Part(mesh, length_unit("mm"), "option", Source("bracket.msh", "gmsh")))


def codes(report: Report) -> list[str]:
    return [finding.code for finding in report.findings]


def grid(*steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the points and hexahedra of a block of cubes."""
    index = np.stack(np.meshgrid(*map(np.arange, steps), indexing="ij"), axis=-1).reshape(-1, 3)
    around = [(x, y, z) for z in (0, 1) for x, y in RING]
    shape = tuple(n + 1 for n in steps)
    nodes = np.stack([np.ravel_multi_index((index + corner).T, shape) for corner in around], axis=1)
    return np.stack(np.unravel_index(np.arange(np.prod(shape)), shape), axis=1).astype(float), nodes


# A cube, a pyramid on it, a tetrahedron on that, a wedge beside the cube: each shares a face with another.
MIXED_POINTS = [
    *((x, y, z) for z in (0, 1) for x, y in RING),
    (0.5, 0.5, 2),
    (0.5, -1, 2),
    (2, 0.5, 0),
    (2, 0.5, 1),
]
MIXED = {
    "hexahedron": [[0, 1, 2, 3, 4, 5, 6, 7]],
    "pyramid": [[4, 5, 6, 7, 8]],
    "tetra": [[4, 5, 8, 9]],
    "wedge": [[1, 10, 2, 5, 11, 6]],
}


def test_a_block_of_hexahedra_is_one_sound_body() -> None:
    points, nodes = grid(3, 4, 5)
    report = checked(cells(points, hexahedron=nodes))
    assert (report.triangles, report.vertices, report.bodies) == (60, 120, 1)
    assert (report.closed, report.consistent, report.outward) == (True, True, None)
    assert (report.fit, report.findings, report.shells, report.loops) == (True, (), (), ())


def test_cells_of_all_kinds_hang_together_by_triangles_and_quadrilaterals() -> None:
    assert CellTopology(cells(MIXED_POINTS, **MIXED)).bodies.tolist() == [0, 0, 0, 0]
    without_pyramid = {kind: nodes for kind, nodes in MIXED.items() if kind != "pyramid"}
    assert CellTopology(cells(MIXED_POINTS, **without_pyramid)).bodies.tolist() == [0, 1, 0]


@pytest.mark.parametrize(("kind", "more"), [("tetra10", 6), ("hexahedron20", 12), ("wedge15", 9), ("pyramid13", 8)])
def test_only_the_corners_of_second_order_cells_count(kind: str, more: int) -> None:
    base = kind.rstrip("0123456789")
    (nodes,) = MIXED[base]
    points = np.vstack([MIXED_POINTS, np.random.default_rng(0).random((2 * more, 3))])
    first, second = (nodes + list(range(12 + k * more, 12 + (k + 1) * more)) for k in range(2))
    report = checked(cells(points, **{kind: [first, second]}))
    assert codes(report)[0] == "duplicate_cell"
    assert report.findings[0].faces == (1,)


def test_bodies_are_numbered_as_they_appear_and_wires_have_none() -> None:
    points, nodes = grid(5, 1, 1)
    mesh = cells(points, line=[[0, 1]], hexahedron=nodes[[4, 0, 1, 3]], vertex=[[2]])
    assert CellTopology(mesh).bodies.tolist() == [-1, 0, 1, 1, 0, -1]
    report = checked(mesh)
    assert (report.bodies, report.findings[0].code, report.findings[0].faces) == (2, "several_bodies", (1, 2))


def test_a_mesh_of_wires_has_no_body() -> None:
    report = checked(cells(np.eye(3), line=[[0, 1], [1, 2]]))
    assert (report.bodies, report.closed, report.faults()[0].code) == (0, False, "zero_volume")


def test_cells_that_touch_at_an_edge_are_apart() -> None:
    points, nodes = grid(2, 2, 1)
    assert CellTopology(cells(points, hexahedron=nodes[[0, 3]])).bodies.tolist() == [0, 1]


def test_nodes_with_equal_coordinates_are_one() -> None:
    points, nodes = grid(2, 1, 1)
    split = points[nodes].reshape(-1, 3)
    split[8:] = np.where(split[8:] == 0, -0.0, split[8:])
    mesh = cells(split, hexahedron=np.arange(16).reshape(2, 8))
    report = checked(mesh)
    assert (report.vertices, report.bodies) == (12, 1)


def test_a_collapsed_cell_is_joined_by_the_face_that_is_left() -> None:
    points, nodes = grid(1, 1, 1)
    (a, b, c, d, e, f, g, h) = nodes[0].tolist()
    wedge, collapsed = [a, b, c, e, f, g], [a, c, d, d, e, g, h, h]
    assert CellTopology(cells(points, wedge=[wedge], hexahedron=[collapsed])).bodies.tolist() == [0, 0]
    on_top = [e, g, h, 8]
    mesh = cells(np.vstack([points, [0, 1, 2]]), hexahedron=[collapsed], tetra=[on_top])
    assert CellTopology(mesh).bodies.tolist() == [0, 0]
    assert checked(mesh).fit


@settings(deadline=None, max_examples=50)
@given(st.integers(1, 12), st.data())
def test_a_row_of_cubes_falls_apart_where_cubes_are_missing(count: int, data: st.DataObject) -> None:
    present = sorted(data.draw(st.sets(st.integers(0, count - 1), min_size=1)))
    order = data.draw(st.permutations(present))
    points, nodes = grid(count, 1, 1)
    run = {k: k - i for i, k in enumerate(present)}  # constant along a run of neighbours
    first: dict[int, int] = {}
    expected = [first.setdefault(run[k], len(first)) for k in order]
    assert CellTopology(cells(points, hexahedron=nodes[order])).bodies.tolist() == expected


def test_a_cell_stored_again_is_an_error_with_its_place() -> None:
    points, nodes = grid(3, 1, 1)
    turned = nodes[1][[1, 2, 3, 0, 5, 6, 7, 4]]
    report = checked(cells(points, hexahedron=[*nodes, turned]))
    (finding, *_) = report.findings
    assert (finding.code, finding.count, finding.faces, finding.place) == ("duplicate_cell", 1, (3,), (1.5, 0.5, 0.5))
    assert "cell 3 around (1.5, 0.5, 0.5)" in finding.message
    with pytest.raises(GeometryError, match=r"^bracket\.msh: 1 cell stored again"):
        report.require_fit()


def test_three_cells_on_one_face_overlap() -> None:
    points = np.vstack([np.eye(3), [[0, 0, 0], [1, 1, 1], [2, 1, 1]]])
    report = checked(cells(points, tetra=[[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]]))
    (finding,) = report.findings
    assert (finding.code, finding.severity, finding.count, finding.faces) == (
        "overlapping_cells",
        "error",
        1,
        (0, 1, 2),
    )
    assert finding.place == pytest.approx((1 / 3, 1 / 3, 1 / 3))


@pytest.mark.parametrize("node", [-1, 12, 10**15])
def test_a_node_that_does_not_exist(node: int) -> None:
    points, nodes = grid(2, 1, 1)
    report = checked(cells(points, line=[[0, 1]], hexahedron=[nodes[0], [*nodes[1][:7], node]]))
    (finding,) = report.findings
    assert (finding.code, finding.faces, report.fit) == ("node_out_of_range", (2,), False)
    assert f"cell 2 with node {node} where the nodes are 0 to 11" in finding.message


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e76])
def test_a_node_that_is_no_usable_number(value: float) -> None:
    points, nodes = grid(1, 1, 1)
    points = np.vstack([points, [[value, 0, 0]]])
    assert codes(checked(cells(points, hexahedron=nodes))) == ["unused_vertices"]
    points[5, 1] = value
    (finding,) = checked(cells(points, hexahedron=nodes)).findings
    assert (finding.code, finding.severity, finding.count) == ("non_finite", "error", 1)
    assert "node 5" in finding.message


def test_no_cells() -> None:
    for mesh in (cells(np.eye(3)), cells(np.eye(3), tetra=np.empty((0, 4), int))):
        report = checked(mesh)
        assert (codes(report), report.fit, report.bodies) == (["empty"], False, 0)


def test_unused_nodes_are_a_note() -> None:
    points, nodes = grid(1, 1, 1)
    report = checked(cells(np.vstack([points, [[9, 9, 9]]]), hexahedron=nodes))
    assert (codes(report), report.fit, report.vertices) == (["unused_vertices"], True, 8)
