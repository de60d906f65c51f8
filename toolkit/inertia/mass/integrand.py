"""`Integrand`: what carries the mass of an analysis, and the derivatives of its moments with respect to its vertices.

While the vertices of a closed surface move by d, linear over each triangle, d/dt ∫ f dV = ∮ f d·n dA. With N twice the
vector area of a triangle p, q, r, its corner p and u = p + q + r + p, each triangle adds to the derivatives by p

    ∂V/∂p = N/6,   ∂∫xᵢ/∂p = N uᵢ/24,   ∂∫xᵢxⱼ/∂p = N (uᵢ uⱼ + 2 pᵢ pⱼ + qᵢ qⱼ + rᵢ rⱼ)/120,

closed forms without truncation. Cells and wires take the derivative of each term of the quadrature that is exact for
their maps; the area of a shell has ∂A/∂p = ½ n × (r − q). All moments are taken about the centre of mass, so that its
derivative is that of ∫x dm over the mass, and that of the tensor needs no Steiner term.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int
from inertia.errors import GeometryError
from inertia.mass.integration import Group
from inertia.mass.moments import PAIRS
from inertia.mass.principal import Principal
from inertia.mass.properties import MassProperties
from inertia.mesh.geometry.edges import first_equal
from inertia.mesh.part import Cells, Part
from inertia.mesh.surface import Facets
from inertia.records import dataclass

ELEMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""The axes of the six elements of a tensor, in the order of `responses`: xx, yy, zz, xy, xz, yz."""

_CORNERS = 1 << 15  # taken together
_CELLS = 512
_MIX = np.array([0x9E3779B97F4A7C15, 0xD6E8FEB86659FD93, 0xA0761D6478BD642F], np.uint64)


@dataclass(frozen=True, eq=False)
class Integrand:
    """What carries the mass of an analysis: elements, their densities, and the mass properties that these make.

    Attributes
    ----------
    part : as integrated
    model : "solid", "shell" or "wire"
    factor : volume, m³, of a unit of the integral (unit³ of a solid, unit² of a shell, the unit of a wire)
    groups : elements of one density each
    weights : kg/m³, of each group
    turned : which triangles count with their winding reversed, if some do
    properties : the mass properties
    weighed : whether the mass was given, and the densities are proportions
    origin : of a union the part that was united, whose vertices are those that move, and which of its triangles each
        triangle lies in
    """

    part: Part
    model: Literal["solid", "shell", "wire"]
    factor: Fraction
    groups: tuple[Group, ...]
    weights: tuple[Fraction, ...]
    turned: Bool | None
    properties: MassProperties
    weighed: bool
    origin: tuple[Part, Int] | None = None

    @property
    def dimension(self) -> int:
        """How many of the dimensions of space the elements fill."""
        return {"solid": 3, "shell": 2, "wire": 1}[self.model]

    @cached_property
    def center(self) -> list[Fraction]:
        """The centre of mass in the part's unit, to twice the digits of a float64."""
        high, low = self.properties.center_of_mass_pair()[0].tolist()
        return [(Fraction(a) + Fraction(b)) / self.part.unit.metres for a, b in zip(high, low, strict=True)]

    @cached_property
    def rows(self) -> tuple[Float, Int]:
        """The distinct vertices (n, 3), and the row of each: (m, 3) of the corners of an STL file's triangles, or (k,).

        Vertices of the same coordinates are one: what moves one of them moves all.
        """
        geometry = self.part.geometry if self.origin is None else self.origin[0].geometry
        if isinstance(geometry, Facets):
            points: NDArray[np.floating] = geometry.corners_f4().reshape(-1, 3)
            first, row = _distinct(points)
            return points[first].astype(np.float64) + 0.0, row.reshape(-1, 3)
        points = geometry.points if isinstance(geometry, Cells) else geometry.vertices
        first, row = _distinct(points)
        return points[first].astype(np.float64) + 0.0, row

    def blocks(self) -> Iterator[tuple[int, Float, Float]]:
        """Yield the first row of some vertices, ∂(volume)/∂x (c, 3) m², and ∂(moments of mass)/∂x (c, 10, 3).

        The moments, about the centre of mass, are m, ∫x dm and ∫x xᵀ dm, the last in the order of `ELEMENTS`; lengths
        are in metres, the coordinates too.
        """
        vertices, rows = self.rows
        center = np.array([float(k) for k in self.center])
        rest = np.array([float(k - Fraction(c)) for k, c in zip(self.center, center.tolist(), strict=True)])
        local = (vertices - center) - rest
        exponent = int(np.frexp(np.abs(local).max(initial=0.0))[1])
        metres, size = self.part.unit.metres, Fraction(2) ** exponent
        local = np.ldexp(local, -exponent)
        powers = (-1, *(0,) * 3, *(1,) * 6)
        try:
            scale = np.array([float(self.factor * metres**k * size ** (self.dimension + k)) for k in powers])
        except OverflowError:
            raise GeometryError(f"{self.part.name}: a derivative is above 1.8e308 and leaves float64") from None
        if self.origin is not None:
            pieces = np.ldexp((self.part.triangles.corners() - center) - rest, -exponent)
            found = self._of_union(local, rows, pieces)
        elif self.model == "solid" and not isinstance(self.part.geometry, Cells):
            found = self._of_triangles(local, rows, _solid_rates)
        elif self.model == "shell":
            found = self._of_triangles(local, rows, _shell_rates)
        else:
            found = self._of_cells(local, rows)
        for first, volume, moments in found:
            yield first, scale[0] * volume, scale[:, None] * moments

    def _density(self, count: int) -> Float:
        """Return the density of each element, kg/m³; 0 of those in no group."""
        density = np.zeros(count)
        for group, weight in zip(self.groups, self.weights, strict=True):
            density[slice(None) if group.members is None else group.members] = float(weight)
        return density

    def _of_triangles(
        self, local: Float, rows: Int, rates: Callable[[Float, Float, Float], Float]
    ) -> Iterator[tuple[int, Float, Float]]:
        faces = rows if rows.ndim == 2 else rows[self.part.triangles.faces]  # type: ignore[union-attr]
        density = self._density(len(faces))
        sign = None if self.turned is None else np.where(self.turned, -1.0, 1.0)
        places, around = np.ascontiguousarray(local.T), np.ascontiguousarray(faces.T)
        flat = faces.ravel()
        order = np.argsort(flat, kind="stable")
        start = np.concatenate([[0], np.cumsum(np.bincount(flat, minlength=len(local)))])
        row = 0
        while row < len(local):
            stop = max(row + 1, int(np.searchsorted(start, start[row] + _CORNERS, side="right")) - 1)
            triangle, corner = np.divmod(order[start[row] : start[stop]], 3)
            p, q, r = (places[:, around[(corner + k) % 3, triangle]] for k in range(3))
            change = rates(p, q, r)
            if sign is not None:
                change *= sign[triangle]
            used = np.flatnonzero(start[row + 1 : stop + 1] > start[row:stop])
            starts = start[row:stop][used] - start[row]
            volume, moments = np.zeros((stop - row, 3)), np.zeros((stop - row, 10, 3))
            if len(used):
                volume[used] = np.add.reduceat(change[0], starts, axis=1).T
                moments[used] = np.moveaxis(np.add.reduceat(change * density[triangle], starts, axis=2), 2, 0)
            yield row, volume, moments
            row = stop

    def _of_union(self, local: Float, rows: Int, pieces: Float) -> Iterator[tuple[int, Float, Float]]:
        """Yield all at once: the corners of a piece (k, 3, 3) move with its triangle, by their barycentric coordinates.

        What they do beyond that moves them along the triangle, which changes nothing.
        """
        assert self.origin is not None
        part, origins = self.origin
        faces = rows if rows.ndim == 2 else rows[part.triangles.faces]  # type: ignore[union-attr]
        density = self._density(len(pieces))
        volume, moments = np.zeros_like(local), np.zeros((len(local), 10, 3))
        for start in range(0, len(pieces), _CORNERS):
            corners, nodes = pieces[start : start + _CORNERS], faces[origins[start : start + _CORNERS]]
            shares = _barycentric(corners, local[nodes])
            columns = [np.ascontiguousarray(corners[:, k].T) for k in range(3)]
            change = np.zeros((len(corners), 3, 10, 3))
            for k in range(3):
                rates = np.moveaxis(_solid_rates(columns[k], columns[k - 2], columns[k - 1]), 2, 0)
                change += shares[:, k, :, None, None] * rates[:, None]
            _scatter(nodes, change, density[start : start + len(corners)], volume, moments)
        yield 0, volume, moments

    def _of_cells(self, local: Float, rows: Int) -> Iterator[tuple[int, Float, Float]]:
        from inertia.mesh.geometry.cell_shapes import numbered_blocks, volume_blocks

        cells = self.part.geometry
        assert isinstance(cells, Cells)
        wires = self.model == "wire"
        density = self._density(cells.count)
        volume, moments = np.zeros_like(local), np.zeros((len(local), 10, 3))
        for number, block in numbered_blocks(cells) if wires else volume_blocks(cells):
            if wires and not block.kind.startswith("line"):
                continue
            for begin in range(0, len(block.nodes), _CELLS):
                nodes = rows[block.nodes[begin : begin + _CELLS]]
                change = _cell_rates(block.kind, local[nodes])  # (k, n, 10, 3)
                weight = density[number + begin : number + begin + len(nodes)]
                _scatter(nodes, change, weight, volume, moments)
        yield 0, volume, moments

    def responses(self, volume: Float, moments: Float) -> Float:
        """Return the changes (…, 11) of volume, mass, centre of mass and tensor that follow from those of moments.

        Parameters
        ----------
        volume : (…,) m³
        moments : (…, 10) of mass about the centre of mass, as in `blocks`, before `weighing`
        """
        result = np.empty((*volume.shape, 11))
        result[..., 0], result[..., 1] = volume, moments[..., 0]
        result[..., 2:5] = moments[..., 1:4] / self.properties.mass
        second = moments[..., 4:]
        result[..., 5:8] = second[..., :3].sum(axis=-1, keepdims=True) - second[..., :3]
        result[..., 8:] = -second[..., 3:]
        return result

    @property
    def weighing(self) -> Float:
        """What the total mass that was given makes of `responses`, (11, 11): it stays, the tensor in proportion."""
        matrix = np.eye(11)
        if self.weighed:
            matrix[5:, 1] = -six_of(self.properties.inertia) / self.properties.mass
            matrix[1, 1] = 0.0
        return matrix


def six_of(tensor: Float) -> Float:
    """Return the six elements (…, 6) of symmetric tensors (…, 3, 3)."""
    return np.stack([tensor[..., i, j] for i, j in ELEMENTS], axis=-1)


def matrix_of(elements: Float) -> Float:
    """Return symmetric tensors (…, 3, 3) from their six elements (…, 6)."""
    result = np.empty((*elements.shape[:-1], 3, 3))
    for k, (i, j) in enumerate(ELEMENTS):
        result[..., i, j] = result[..., j, i] = elements[..., k]
    return result


def principal_elements(axes: Float) -> Float:
    """Return the matrix (6, 6) from the six elements of a tensor to those in its axes: 11, 22, 33, 23, 31, 12."""
    e = axes
    return np.array([[e[a, i] * e[b, j] + (a != b) * e[b, i] * e[a, j] for a, b in ELEMENTS] for i, j in PAIRS])


def principal_rates(principal: Principal) -> Float:
    """Return what a change of the six elements of a tensor does to its principal moments and axes, (6, 6).

    The first three rows give δIₖ = eₖ·δI eₖ, the others the angles about axis 1, 2, 3 by which the axes turn:
    δθₖ = eᵢ·δI eⱼ/(Iᵢ − Iⱼ) with i, j, k in cyclic order; nan where Iᵢ and Iⱼ are equal.
    """
    rates = principal_elements(principal.axes)
    for row, (i, j) in enumerate(PAIRS[3:], 3):
        same = any(i in group and j in group for group in principal.equal)
        rates[row] *= np.nan if same else 1.0 / (principal.moments[i] - principal.moments[j])
    return rates


def _distinct(points: NDArray[np.floating]) -> tuple[Int, Int]:
    """Return the first of each distinct points, ascending, and for each point which of these it equals.

    Points are sorted by a hash of their bits; where two share one, by the coordinates.
    """
    whole = np.ascontiguousarray(points) + points.dtype.type(0)
    words = whole.view(np.uint32 if whole.dtype.itemsize == 4 else np.uint64).astype(np.uint64)
    keys = np.zeros(len(words), np.uint64)
    for column, factor in zip(words.T, _MIX, strict=True):
        keys = (keys ^ (keys >> np.uint64(29)) ^ column) * factor
    _, first, row = np.unique(keys, return_index=True, return_inverse=True)
    if (whole[first][row] != whole).any():
        _, first, row = np.unique(
            first_equal(whole.astype(np.float64).view(np.int64)), return_index=True, return_inverse=True
        )
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return first[order], rank[row]


def _scatter(nodes: Int, change: Float, density: Float, volume: Float, moments: Float) -> None:
    """Add what elements of these densities (k,) change by their nodes (k, n), (k, n, 10, 3), up for all nodes."""
    order = np.argsort(nodes.ravel(), kind="stable")
    some, starts = np.unique(nodes.ravel()[order], return_index=True)
    volume[some] += np.add.reduceat(change[:, :, 0].reshape(-1, 3)[order], starts)
    heavy = (change * density[:, None, None, None]).reshape(-1, 10, 3)
    moments[some] += np.add.reduceat(heavy[order], starts)


def _barycentric(points: Float, triangles: Float) -> Float:
    """Return the barycentric coordinates (k, n, 3) of points (k, n, 3) in triangles (k, 3, 3) that they lie in."""
    a = triangles[:, :1]
    u, v, w = triangles[:, 1:2] - a, triangles[:, 2:] - a, points - a
    normal = np.cross(u, v)
    square = (normal * normal).sum(axis=2)
    second, third = ((np.cross(*pair) * normal).sum(axis=2) / square for pair in ((w, v), (u, w)))
    return np.stack([1.0 - second - third, second, third], axis=2)


def _cross(a: Float, b: Float) -> Float:
    """Return the vector products of columns (3, k)."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _solid_rates(p: Float, q: Float, r: Float) -> Float:
    """Return what each triangle (p, q, r) (3, k) adds to the derivatives of the moments by p, (10, 3, k)."""
    normal = _cross(q - p, r - p)
    u = p + q + r + p
    second = [u[i] * u[j] + 2.0 * p[i] * p[j] + q[i] * q[j] + r[i] * r[j] for i, j in ELEMENTS]
    weights = np.stack([np.full_like(u[0], 1.0 / 6.0), *(u / 24.0), *(k / 120.0 for k in second)])
    result: Float = weights[:, None] * normal
    return result


def _shell_rates(p: Float, q: Float, r: Float) -> Float:
    """Return the same where the triangles themselves carry the mass; nothing for a triangle of no area."""
    normal = _cross(q - p, r - p)
    size = np.sqrt((normal * normal).sum(axis=0))
    growth = 0.5 * _cross(np.divide(normal, size, out=np.zeros_like(normal), where=size > 0), r - q)
    s, twelfth = p + q + r, size / 24.0
    second = [(s[i] * s[j] + p[i] * p[j] + q[i] * q[j] + r[i] * r[j]) / 12.0 for i, j in ELEMENTS]
    result: Float = np.stack([np.ones_like(s[0]), *(s / 3.0), *second])[:, None] * growth
    for i in range(3):
        result[1 + i, i] += 4.0 * twelfth
    for k, (i, j) in enumerate(ELEMENTS, 4):
        result[k, i] += twelfth * (s[j] + p[j])
        result[k, j] += twelfth * (s[i] + p[i])
    return result


def _cell_rates(kind: str, nodes: Float) -> Float:
    """Return the derivatives of the moments of cells or lines by each of their nodes (k, n, 3): (k, n, 10, 3).

    With D the determinant of the map (the length of the tangent of a line), ∂∫f = Σ w (f ∂D + D ∂f).
    """
    from inertia.mass.cells.shape_functions import table

    shape = table(kind)
    cells, count = nodes.shape[:2]
    result = np.zeros((cells, count, 10, 3))
    total = np.zeros(cells)
    for point, weight in enumerate(shape.weights.tolist()):
        slopes = shape.slopes[:, min(point, shape.slopes.shape[1] - 1)]  # (d, n)
        jacobian = np.einsum("dn,knx->dkx", slopes, nodes)
        if len(slopes) == 1:
            measure = np.sqrt((jacobian[0] ** 2).sum(axis=1))
            cofactors = np.divide(jacobian, measure[:, None], out=np.zeros_like(jacobian), where=measure[:, None] > 0)
        else:
            a, b, c = jacobian
            cofactors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)])
            measure = (a * cofactors[0]).sum(axis=1)
        total += weight * measure
        x = np.einsum("n,knx->kx", shape.values[point], nodes)
        f = np.column_stack([np.ones(cells), x, *(x[:, i] * x[:, j] for i, j in ELEMENTS)])
        moved = np.zeros((cells, 10, 3))
        for i in range(3):
            moved[:, 1 + i, i] = measure
        for k, (i, j) in enumerate(ELEMENTS, 4):
            moved[:, k, i] += measure * x[:, j]
            moved[:, k, j] += measure * x[:, i]
        growth = np.einsum("dn,dkx->knx", slopes, cofactors)
        result += weight * (
            growth[:, :, None] * f[:, None, :, None] + shape.values[point][:, None, None] * moved[:, None]
        )
    return result * np.where(total < 0, -1.0, 1.0)[:, None, None, None]
