"""Parts that share space, or lie nearer to each other than they may: where, how much, and what mass counts twice."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from inertia.arrays import Bool, Float
from inertia.assembly.bodies import Body, mapped, triangles_of
from inertia.assembly.fields import PartFields
from inertia.assembly.sheets import MOST_PRISMS, STEP, sides, united
from inertia.assembly.tree import Node, PartTree
from inertia.errors import GeometryError
from inertia.mesh.checks.cells import CellTopology
from inertia.mesh.columns.common_volume import common_volume
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.cell_shapes import KINDS, known_volume_blocks
from inertia.mesh.geometry.faces import merge_equal_vertices, repeated_corners
from inertia.mesh.manifold import exponent_of, solid
from inertia.mesh.part import Cells
from inertia.mesh.surface import Surface
from inertia.once import checking_once, once
from inertia.records import dataclass
from inertia.units import Unit

_SHARE, _ROUND_SHARE = 1e-6, 5e-3
"""Of the smaller part's volume: less is contact; of round shapes, whose facets lie inside them, the second."""
_NEAR = 1.01  # times what counts as contact, within which volumes are those that bound their rounding
_KEPT = 256  # solids
_NO_SURFACE = "only what it weighs is stated"
_FLAT = 1e-6  # of the cube of the sides of a face, its four corners span less
_ROUND = ("sphere", "ellipsoid", "cylinder", "capsule", "tube", "cone")


@dataclass(frozen=True, eq=False)
class Interference:
    """Two parts that share space, or that are too near.

    Attributes
    ----------
    first, second : their names, with the number of the copy where there are several
    volume : m³ that they share; 0 where they are only too near
    mass : kg that counts twice: that volume of the lighter material
    place : (3,) m, the middle of the box that both reach into
    gap : m between them, where they share nothing
    """

    first: str
    second: str
    volume: float
    mass: float
    place: Float
    gap: float


@checking_once()
def interferences(tree: PartTree, clearance: float = 0.0) -> tuple[Interference, ...]:
    """Return the pairs of parts that share space, those that share most first, and then those that are too near.

    Volumes are those of the triangles, by manifold3d, and by `inertia.mesh.columns.common_volume`, which bounds its
    rounding, where that does not take a part or they are near what counts as contact: a millionth of the smaller part,
    or half a percent where a round shape is given without a mesh, and of cells with curved faces. A sheet is the union
    of the prisms of its triangles, a mesh of cells its outside. Parts without a surface are left out, and pairs with
    too many prisms: see `unexamined`.

    Parameters
    ----------
    clearance : m, the least distance between parts; 0 does not ask for one

    Raises `GeometryError` where a pair has too many triangles, or no clearance can be had of a part.
    """
    parts = list(tree.surfaces(_solid_triangles))
    if len(parts) < 2:
        return ()
    solids = _Solids(parts, clearance)
    boxes = solids.boxes
    found = []
    counts: dict[str, int] = {}
    numbers = []
    for node, _ in parts:
        counts[node.label] = counts.get(node.label, 0) + 1
        numbers.append(counts[node.label])
    for a, b in solids.pairs():
        if (crowd := solids.crowd(a, b)) is not None:
            if clearance:
                raise GeometryError(
                    f"the clearance of {parts[crowd[0]][0].label} cannot be had: "
                    f"{_crowded(parts[a + b - crowd[0]][0], crowd[1])}; leave the clearance out"
                )
            continue
        volume, gap = solids.meeting(a, b)
        if not volume and gap is None:
            continue
        one, other = (_called(parts[k][0].label, numbers[k], counts) for k in (a, b))
        low, high = np.maximum(boxes[a, 0], boxes[b, 0]), np.minimum(boxes[a, 1], boxes[b, 1])
        densities = [_density(parts[k][0]) for k in (a, b)]
        found.append(Interference(one, other, volume, volume * min(densities), (low + high) / 2, gap or 0.0))
    return tuple(sorted(found, key=lambda each: (-each.volume, each.gap, each.first, each.second)))


class _Solids:
    """Parts as solids of manifold3d, some of them kept; of a sheet, the prisms that are near another part."""

    def __init__(self, parts: Sequence[tuple[Node, Float]], clearance: float = 0.0) -> None:
        self._parts, self._clearance = parts, clearance
        self.boxes = np.array([_box(corners.reshape(1, -1, 3))[:, 0] for _, corners in parts]).reshape(-1, 2, 3)
        self.boxes += np.array([[-clearance / 2], [clearance / 2]])
        self._exponent = max(exponent_of(corners.reshape(-1, 3)) for _, corners in parts)
        self._solid = lru_cache(_KEPT)(self._made)
        self._prisms = lru_cache(_KEPT)(lambda number: _box(parts[number][1].reshape(-1, 6, 3)))

    def pairs(self) -> Iterator[tuple[int, int]]:
        """Yield the pairs of parts whose boxes overlap, or touch where a clearance is asked for."""
        for i, j, _ in overlapping(BoxTree(self.boxes[:, 0], self.boxes[:, 1]), touching=self._clearance > 0):
            yield from sorted(zip(i.tolist(), j.tolist(), strict=True))

    def crowd(self, a: int, b: int) -> tuple[int, int] | None:
        """Return which of two parts has too many prisms near the other, and how many; None where neither has."""
        for one, other in ((a, b), (b, a)):
            if _is_sheet(self._parts[one][0]) and (count := int(self._near(one, other).sum())) > MOST_PRISMS:
                return one, count
        return None

    def meeting(self, a: int, b: int) -> tuple[float, float | None]:
        """Return the volume, m³, that two parts share, 0 where they are in contact only.

        Second, how near they are, m, where they share nothing and that is less than the clearance.
        """
        one, other = (
            self._united(i, j) if _is_sheet(self._parts[i][0]) else self._solid(i) for i, j in ((a, b), (b, a))
        )
        volume = self._shared((a, one), (b, other))
        if volume or not self._clearance:
            return volume, None
        for number, made in ((a, one), (b, other)):
            if made is None:
                raise GeometryError(
                    f"the clearance of {self._parts[number][0].label} cannot be had: manifold3d does not take its "
                    "surface, as where more than two triangles have an edge; leave the clearance out, or mend that"
                )
        near = one.min_gap(other, np.ldexp(self._clearance, -self._exponent))
        gap = float(np.ldexp(near, self._exponent))
        return 0.0, gap if gap < self._clearance else None

    def _shared(self, a: tuple[int, Any], b: tuple[int, Any]) -> float:
        """Return the volume that two parts share, each with its solid or None; 0 where they are in contact only."""
        nodes = [self._parts[number][0] for number, _ in (a, b)]
        least = min(map(_volume, nodes)) * (_ROUND_SHARE if any(map(_is_round, nodes)) else _SHARE)
        if any(map(_is_sheet, nodes)):  # their corners are moved to the next step
            areas = [made.surface_area() for _, made in (a, b) if made is not None]
            least += float(np.ldexp(2 * STEP * min(areas), 3 * self._exponent))
        if any(made is not None and made.is_empty() for _, made in (a, b)):
            return 0.0
        if a[1] is not None and b[1] is not None and least:
            volume = float(np.ldexp((a[1] ^ b[1]).volume(), 3 * self._exponent))
            if not least / _NEAR < volume < least * _NEAR:  # known to far fewer digits than those of contact
                return volume if volume > least else 0.0
        result = common_volume(self._corners(*a), self._corners(*b))
        if result is None:
            raise GeometryError(
                f"{nodes[0].label} and {nodes[1].label} have too many triangles where they are near each other: "
                "simplify one"
            )
        volume, rounding = result
        return volume if volume > least + rounding else 0.0

    def _corners(self, number: int, made: Any) -> Float:
        node, corners = self._parts[number]
        if not _is_sheet(node):
            return corners
        mesh = made.to_mesh64()
        points = np.ldexp(mesh.vert_properties[:, :3], self._exponent)
        triangles: Float = points[mesh.tri_verts.astype(np.int64)]
        return triangles

    def _near(self, sheet: int, other: int) -> Bool:
        """Say which prisms of a sheet reach into the box around another part, or to within the clearance of it."""
        low, high = self._prisms(sheet)
        least, most = self.boxes[other] + np.array([[-self._clearance / 2], [self._clearance / 2]])
        near: Bool = ((low <= most) & (high >= least)).all(axis=1)
        return near

    def _united(self, sheet: int, other: int) -> Any:
        return united(self._parts[sheet][1].reshape(-1, 2, 3, 3)[self._near(sheet, other)], self._exponent)

    def _made(self, number: int) -> Any:
        corners = self._parts[number][1]
        loose = Surface(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
        vertices, faces = merge_equal_vertices(loose)
        try:
            return solid(vertices, faces[~repeated_corners(faces)], self._exponent)
        except GeometryError:
            return None


def _crowded(other: Node, count: int) -> str:
    return (
        f"{count:,} of its triangles are near {other.label}, more than the {MOST_PRISMS:,} that are united: simplify it"
    )


def _box(points: Float) -> Float:
    """Return the least and the greatest coordinates (2, n, 3) of points (n, k, 3)."""
    return np.array([points.min(axis=1), points.max(axis=1)])


@checking_once()
def unexamined(tree: PartTree) -> dict[str, str]:
    """Return why, by name, parts with an extent are left out by `interferences`, and sheets beside another part."""
    reasons = {}
    for node in tree.root.leaves:
        if node.fields is None or node.body is None or node.fields.shape == "point":
            continue
        if _solid_triangles(node.fields, node.body, node.unit) is None:
            reasons[node.label] = _NO_SURFACE
    parts = list(tree.surfaces(_solid_triangles))
    if any(_is_sheet(node) and len(corners) > 2 * MOST_PRISMS for node, corners in parts):
        solids = _Solids(parts)
        for a, b in solids.pairs():
            if (crowd := solids.crowd(a, b)) is not None:
                reasons[parts[crowd[0]][0].label] = _crowded(parts[a + b - crowd[0]][0], crowd[1])
    return reasons


def _solid_triangles(fields: PartFields, body: Body, unit: Unit) -> Float | None:
    """Return the triangles (m, 3, 3) m of a part as a solid, in its own axes; None where they are not known.

    Of a sheet, the two sides of each prism.
    """
    part = body.part
    if part is None:
        return triangles_of(fields, body, unit)
    metres = float(part.unit.metres)
    if isinstance(part.geometry, Cells):
        outside, _ = CellTopology(part.geometry).boundary
        return mapped(fields, outside.corners() * metres) if outside.count else None
    if fields.shell is None:
        return triangles_of(fields, body, unit)
    thickness = float(fields.shell) * metres
    walls = once(("sheet", thickness), part, lambda: sides(part.triangles.corners() * metres, thickness))
    return mapped(fields, walls.reshape(-1, 3, 3)) if len(walls) else None


def _is_sheet(node: Node) -> bool:
    part = None if node.body is None else node.body.part
    return part is not None and not isinstance(part.geometry, Cells) and getattr(node.fields, "shell", None) is not None


def _is_round(node: Node) -> bool:
    """Say whether the triangles of a part lie within its surface."""
    part = None if node.body is None else node.body.part
    if part is not None and isinstance(part.geometry, Cells):
        cells = part.geometry
        return once("round", part, lambda: not _has_flat_faces(cells))
    return node.fields is not None and node.fields.shape in _ROUND


def _has_flat_faces(cells: Cells) -> bool:
    """Say whether all faces of the volume cells are flat and without nodes between their corners."""
    for _, block in known_volume_blocks(cells):
        kind = KINDS[block.kind]
        if block.nodes.shape[1] > kind.corners:
            return False
        for name, face in kind.faces:
            corners = cells.points[block.nodes[:, face]]
            edges = corners[:, 1:] - corners[:, :1]
            if name == "quad" and (np.abs(np.linalg.det(edges)) > _FLAT * np.abs(edges).max(axis=(1, 2)) ** 3).any():
                return False
    return True


def _called(label: str, number: int, counts: dict[str, int]) -> str:
    return f"{label} {number}" if counts[label] > 1 else label


def _volume(node: Node) -> float:
    return 0.0 if node.body is None else float(node.body.volume)


def _density(node: Node) -> float:
    if node.body is None or not node.body.volume:
        return 0.0
    return float(node.body.moments.zeroth / node.body.volume)
