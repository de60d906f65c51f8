"""Parts that share space, or lie nearer to each other than they may: where, how much, and what mass counts twice."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.assembly.bodies import Body, mapped, triangles_of
from inertia.assembly.fields import PartFields
from inertia.assembly.sheets import thickened
from inertia.assembly.tree import Node, PartTree
from inertia.errors import GeometryError
from inertia.mesh.checks.cells import CellTopology
from inertia.mesh.columns.common_volume import common_volume
from inertia.mesh.geometry.boxes import BoxTree, overlapping
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
_NO_ROOM = "its walls are too thick for the curvature or the folds of its surface, or that is one-sided"
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
    or half a percent where a round shape is given without a mesh. A sheet is the solid that `sheets.thickened` makes of
    it, a mesh of cells its outside. Parts without a surface are left out: see `unexamined`.

    Parameters
    ----------
    clearance : m, the least distance between parts; 0 does not ask for one

    Raises `GeometryError` where a pair has too many triangles, or no clearance can be had of a part.
    """
    parts = list(tree.surfaces(_solid_triangles))
    if len(parts) < 2:
        return ()
    half = clearance / 2
    boxes = np.array([[corners.min(axis=(0, 1)) - half, corners.max(axis=(0, 1)) + half] for _, corners in parts])
    solids = _Solids(parts)
    found = []
    counts: dict[str, int] = {}
    numbers = []
    for node, _ in parts:
        counts[node.label] = counts.get(node.label, 0) + 1
        numbers.append(counts[node.label])
    for i, j, _ in overlapping(BoxTree(boxes[:, 0], boxes[:, 1]), touching=clearance > 0):
        for a, b in sorted(zip(i.tolist(), j.tolist(), strict=True)):
            volume, gap = _shared(parts[a], parts[b], solids.common(a, b)), None
            if not volume and clearance:
                gap = solids.gap(a, b, clearance)
            if not volume and gap is None:
                continue
            one, other = (_called(parts[k][0].label, numbers[k], counts) for k in (a, b))
            low, high = np.maximum(boxes[a, 0], boxes[b, 0]), np.minimum(boxes[a, 1], boxes[b, 1])
            densities = [_density(parts[k][0]) for k in (a, b)]
            found.append(Interference(one, other, volume, volume * min(densities), (low + high) / 2, gap or 0.0))
    return tuple(sorted(found, key=lambda each: (-each.volume, each.gap, each.first, each.second)))


class _Solids:
    """Parts as solids of manifold3d, some of them kept."""

    def __init__(self, parts: Sequence[tuple[Node, Float]]) -> None:
        self._parts = parts
        self._exponent = max(exponent_of(corners.reshape(-1, 3)) for _, corners in parts)
        self._solid = lru_cache(_KEPT)(self._made)

    def _made(self, number: int) -> Any:
        corners = self._parts[number][1]
        loose = Surface(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
        vertices, faces = merge_equal_vertices(loose)
        try:
            return solid(vertices, faces[~repeated_corners(faces)], self._exponent)
        except GeometryError:
            return None

    def common(self, a: int, b: int) -> float | None:
        """Return the volume, m³, that two parts share; None where manifold3d does not take one of them."""
        one, other = self._solid(a), self._solid(b)
        if one is None or other is None:
            return None
        return float(np.ldexp((one ^ other).volume(), 3 * self._exponent))

    def gap(self, a: int, b: int, clearance: float) -> float | None:
        """Return how near, m, two parts are that share nothing; None where that is the clearance or more."""
        for number in (a, b):
            if self._solid(number) is None:
                raise GeometryError(
                    f"the clearance of {self._parts[number][0].label} cannot be had: manifold3d does not take its "
                    "surface, as where more than two triangles have an edge; leave the clearance out, or mend that"
                )
        near = self._solid(a).min_gap(self._solid(b), np.ldexp(clearance, -self._exponent))
        gap = float(np.ldexp(near, self._exponent))
        return gap if gap < clearance else None


def _shared(a: tuple[Node, Float], b: tuple[Node, Float], common: float | None) -> float:
    """Return the volume that two parts share, 0 where they are in contact only.

    `common` is the volume where it is known to far fewer digits than those of contact.
    """
    least = min(_volume(a[0]), _volume(b[0])) * (_ROUND_SHARE if _is_round(a[0]) or _is_round(b[0]) else _SHARE)
    if common is not None and least and not least / _NEAR < common < least * _NEAR:
        volume, rounding = common, 0.0
    else:
        result = common_volume(a[1], b[1])
        if result is None:
            raise GeometryError(
                f"{a[0].label} and {b[0].label} have too many triangles where they are near each other: simplify one"
            )
        volume, rounding = result
    return volume if volume > least + rounding else 0.0


@checking_once()
def unexamined(tree: PartTree) -> dict[str, str]:
    """Return the parts that have an extent and that `interferences` leaves out, by name, and why."""
    reasons = {}
    for node in tree.root.leaves:
        if node.fields is None or node.body is None or node.fields.shape == "point":
            continue
        if node.body.part is None and node.fields.shape is None:
            reasons[node.label] = _NO_SURFACE
        elif _solid_triangles(node.fields, node.body, node.unit) is None:
            reasons[node.label] = _NO_ROOM
    return reasons


def _solid_triangles(fields: PartFields, body: Body, unit: Unit) -> Float | None:
    """Return the triangles (m, 3, 3) m of a part as a solid, in its own axes; None where they are not known."""
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
    sheet = once(("sheet", thickness), part, lambda: thickened(part.triangles.corners() * metres, thickness))
    return None if sheet is None else mapped(fields, sheet)


def _is_round(node: Node) -> bool:
    """Say whether the triangles of a part lie within its surface."""
    curved = node.body is not None and node.body.part is not None and isinstance(node.body.part.geometry, Cells)
    return curved or (node.fields is not None and node.fields.shape in _ROUND)


def _called(label: str, number: int, counts: dict[str, int]) -> str:
    return f"{label} {number}" if counts[label] > 1 else label


def _volume(node: Node) -> float:
    return 0.0 if node.body is None else float(node.body.volume)


def _density(node: Node) -> float:
    if node.body is None or not node.body.volume:
        return 0.0
    return float(node.body.moments.zeroth / node.body.volume)
