"""Error of an unbalance from facets in place of curved surfaces, as a vector sum over the facets.

Between a facet and the cylinder or cone that it stands for lies a layer: nothing at the vertices, which are on it, and
as thick as the surface is far, across the cone's axis, at every other point. Its moments

    ∫ w t dA    (t along the direction that the facet faces, w = x + i y; and w z for the couple)

are integrated over each triangle, and their sum over the triangles is the error: what a full turn has on one side it
has on the other. It counts whole, as one mode. What that leaves out is of higher order in the angle θ that a facet
spans: θ²/64 of each layer, added up as vectors, too, θ⁴/64 by size, and slivers where two surfaces meet.

Where cones meet along an angle as small as that between facets, a profile may be curved: the sag of each along its
generators is a mode of its own. Facets on no cylinder or cone have no such sum: their layers count by their size.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.facet_surfaces import Cone, FacetMesh, recognise
from inertia.mesh.geometry.faces import components, merge_equal_vertices
from inertia.mesh.part import Part
from inertia.records import dataclass

_CURVED = math.radians(35.0)  # of edges between facets of no known surface: a circle has eleven and more
_ALIKE = 3.0  # lengths of neighbours along a curved profile, at most
_LEVEL = 0.1  # of its length: an edge that climbs no more goes round the cone
_SAFETY = 1.25  # of the sag of a profile
_UNKNOWN = 2.0  # of the sag of facets of no known surface: two curvatures add up
_SIGMAS = 12.0  # six, of vertices of which two and two are rounded alike
_CHUNK = 1 << 15
# Seven points in a triangle, exact to the fifth degree: J. Radon (1948), Monatsh. Math. 52, 286-300.
_A, _B = (6.0 - math.sqrt(15.0)) / 21.0, (6.0 + math.sqrt(15.0)) / 21.0
_POINTS = np.array([[1 / 3, 1 / 3, 1 / 3], *(np.roll([1.0 - 2.0 * x, x, x], k) for x in (_A, _B) for k in range(3))])
_WEIGHTS = np.array([9 / 40, *[(155.0 - math.sqrt(15.0)) / 1200.0] * 3, *[(155.0 + math.sqrt(15.0)) / 1200.0] * 3])

Mode = tuple[complex, complex, float, float]
"""Changes of U, kg m, D, kg m², the mass, kg, and its first moment, kg m: see `inertia.balancing.bounds`."""


@dataclass(frozen=True, eq=False)
class FacetLayers:
    """The layers between the facets of a part and the surfaces that they stand for.

    Attributes
    ----------
    part : a surface of triangles
    """

    part: Part

    @cached_property
    def mesh(self) -> FacetMesh:
        """The part welded, m, in its own axes."""
        vertices, faces = merge_equal_vertices(self.part.triangles)
        return FacetMesh.of(vertices * float(self.part.unit.metres), faces)

    @cached_property
    def _recognised(self) -> tuple[list[Cone], Int]:
        return recognise(self.mesh)

    @property
    def cones(self) -> tuple[Cone, ...]:
        """The cylinders and cones."""
        return tuple(self._recognised[0])

    @property
    def label(self) -> Int:
        """The number of the cone of each triangle, −1 for none, (m,)."""
        return self._recognised[1]

    @property
    def recognised(self) -> float:
        """Share of the area of curved facets that lies on cylinders and cones."""
        known = float(self.mesh.areas[self.label >= 0].sum())
        unknown = float(self.mesh.areas[self.unknown_sag > 0].sum())
        return known / (known + unknown) if known + unknown else 1.0

    @property
    def sag(self) -> float:
        """The largest distance between a facet and its surface that the mesh shows, m."""
        return float(max(self._thickest, np.abs(self.profile_sag).max(initial=0.0), self.unknown_sag.max(initial=0.0)))

    @cached_property
    def _thickest(self) -> float:
        mesh, worst = self.mesh, 0.0
        for side in (0, 1):
            edges = np.flatnonzero(self.label[mesh.pairs[:, side]] >= 0)
            middle = mesh.vertices[mesh.ends[edges]].mean(axis=1)
            thick, _ = self._layers(mesh.pairs[edges, side], middle[:, np.newaxis])
            worst = max(worst, float(np.abs(thick).max(initial=0.0)))
        return worst

    def _layers(self, triangles: Int, points: Float) -> tuple[Float, Float]:
        """Return how thick the layers of some triangles (k,) are at points (k, p, 3) on them, and directions (k, 3)."""
        number = self.label[triangles]
        point, direction, radius, slope = (k[number] for k in self._table)
        facing = self.mesh.normals[triangles]
        facing = facing - np.einsum("ij,ij->i", facing, direction)[:, np.newaxis] * direction
        facing = facing / np.linalg.norm(facing, axis=1)[:, np.newaxis]
        local = points - point[:, np.newaxis]
        height = np.einsum("kpi,ki->kp", local, direction)
        along = np.einsum("kpi,ki->kp", local, facing)
        square = np.einsum("kpi,kpi->kp", local, local) - height**2 - along**2
        reach = np.sqrt(np.maximum(0.0, (radius[:, np.newaxis] + slope[:, np.newaxis] * height) ** 2 - square))
        thick: Float = np.where(along >= 0, 1.0, -1.0) * reach - along
        return thick, facing

    @cached_property
    def _table(self) -> tuple[Float, Float, Float, Float]:
        point = np.array([k.point for k in self.cones]).reshape(-1, 3)
        direction = np.array([k.direction for k in self.cones]).reshape(-1, 3)
        return point, direction, np.array([k.radius for k in self.cones]), np.array([k.slope for k in self.cones])

    @cached_property
    def unknown_sag(self) -> Float:
        """The sag of each triangle that may stand for a curved surface other than a cone, estimated, (m,) m.

        Facets of width w that turn by θ at their common edge, their corners on a cylinder, leave (w/2) tan(θ/4).
        """
        mesh = self.mesh
        hinge = ~mesh.flat & (mesh.turn < _CURVED) & (self.label[mesh.pairs] < 0).all(axis=1)
        group = components(np.column_stack([mesh.pairs[hinge | mesh.flat]]), len(mesh.faces))
        planes = np.unique(
            np.column_stack([group[mesh.pairs[hinge]].ravel(), mesh.plane[mesh.pairs[hinge]].ravel()]), axis=0
        )
        count = np.bincount(planes[:, 0], minlength=len(mesh.faces)) if len(planes) else np.zeros(len(mesh.faces))
        hinge &= count[group[mesh.pairs[:, 0]]] >= 3  # two planes that meet are two planes
        sag = np.zeros(len(mesh.faces))
        if hinge.any():
            each = _UNKNOWN * self._hinge_sag(hinge)
            for side in (0, 1):
                np.maximum.at(sag, mesh.plane[mesh.pairs[hinge, side]], each)
        return sag[mesh.plane]

    def _hinge_sag(self, hinge: Bool) -> Float:
        mesh = self.mesh
        length = np.linalg.norm(mesh.vertices[mesh.ends[hinge, 1]] - mesh.vertices[mesh.ends[hinge, 0]], axis=1)
        width = 2.0 * mesh.areas[mesh.pairs[hinge]].min(axis=1) / np.maximum(length, np.finfo(float).tiny)
        sag: Float = 0.5 * width * np.tan(0.25 * mesh.turn[hinge])
        return sag

    @cached_property
    def profile_sag(self) -> Float:
        """The sag of each cone along its generators, if what it is part of is curved, (c,) m; negative for a hollow."""
        mesh, count = self.mesh, len(self.cones)
        sag = np.zeros(count)
        pairs = self.label[mesh.pairs]
        beside = (pairs >= 0).all(axis=1) & (pairs[:, 0] != pairs[:, 1]) & (mesh.turn < _CURVED) & ~mesh.flat
        if not beside.any():
            return sag
        length = self._lengths
        for side in (0, 1):  # what runs along a generator is no edge of a profile
            edges = np.flatnonzero(beside)
            beside[edges] = self._climbs(edges, side) <= _LEVEL * length[pairs[edges, side]]
        one, other = pairs[beside].T
        shorter, longer = np.minimum(length[one], length[other]), np.maximum(length[one], length[other])
        each = 0.5 * _SAFETY * shorter * np.tan(0.25 * mesh.turn[beside]) * mesh.convex[beside]
        each = np.where(longer <= _ALIKE * shorter, each, 0.0)
        for number in (one, other):
            for index in np.flatnonzero(each):
                if abs(each[index]) > abs(sag[number[index]]):
                    sag[number[index]] = each[index]
        return sag

    @cached_property
    def _lengths(self) -> Float:
        """How long each cone is along its generators, (c,) m."""
        height = self._heights
        low, high = np.full(len(self.cones), np.inf), np.full(len(self.cones), -np.inf)
        known = self.label >= 0
        np.minimum.at(low, self.label[known], height[known].min(axis=1))
        np.maximum.at(high, self.label[known], height[known].max(axis=1))
        lengths: Float = (high - low) * np.sqrt(1.0 + self._table[3] ** 2)
        return lengths

    @cached_property
    def _heights(self) -> Float:
        """How high the corners of each triangle are along the axis of its cone, (m, 3) m; 0 where it has none."""
        heights = np.zeros(self.mesh.faces.shape)
        known = self.label >= 0
        if known.any():
            point, direction = (k[self.label[known]][:, np.newaxis] for k in self._table[:2])
            corners = self.mesh.vertices[self.mesh.faces[known]]
            heights[known] = ((corners - point) * direction).sum(axis=2)
        return heights

    def modes(self, density: float, shaft: Shaft, z: float) -> tuple[Mode, ...]:
        """Return what the layers on cones can do to unbalance and mass, couple and first moment about the plane z.

        Parameters
        ----------
        density : kg/m³
        shaft : in part axes
        z : m, along the shaft
        """
        if not self.cones:
            return ()
        mesh = self.mesh
        known = np.flatnonzero(self.label >= 0)
        layers, higher, remainder = np.zeros(4, complex), np.zeros(4, complex), self._slivers(shaft, z)
        for start in range(0, len(known), _CHUNK):
            triangles = known[start : start + _CHUNK]
            points = np.einsum("pc,kci->kpi", _POINTS, mesh.vertices[mesh.faces[triangles]])
            thick, facing = self._layers(triangles, points)
            middles = shaft.to_shaft(points + 0.5 * thick[..., np.newaxis] * facing[:, np.newaxis])
            w = middles[..., 0] + 1j * middles[..., 1]
            area = mesh.areas[triangles] * np.einsum("ij,ij->i", mesh.normals[triangles], facing)
            volume, along = thick * _WEIGHTS * area[:, np.newaxis], middles[..., 2] - z
            each = np.stack([(volume * k).sum(axis=1) for k in (w, w * along, np.ones_like(along), along)])
            square = self._spans[triangles] ** 2
            layers += each.sum(axis=1)
            higher += (each * square).sum(axis=1)
            remainder += (np.abs(each) * square**2).sum(axis=1) / 64.0
        points = shaft.to_shaft(mesh.vertices) - [0.0, 0.0, z]
        listed = [layers, higher / 64.0, *np.diag(remainder)]
        listed += self._profiles(points)
        listed += self._rounding(points)
        return tuple(
            (complex(density * u), complex(density * d), float(density * m.real), float(density * s.real))
            for u, d, m, s in listed
            if u or d or m or s
        )

    def _slivers(self, shaft: Shaft, z: float) -> Float:
        """Return what may lie between the layers of two surfaces that meet, neither across the other's axis, (4,)."""
        mesh, total = self.mesh, np.zeros(4)
        sides = self.label[mesh.pairs]
        border = np.flatnonzero((sides[:, 0] != sides[:, 1]) & ~mesh.flat)
        ends = mesh.vertices[mesh.ends[border]]
        length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        middle = shaft.to_shaft(ends.mean(axis=1))
        arm = np.hypot(middle[:, 0], middle[:, 1])
        thick = np.zeros((2, len(border)))
        facing = np.zeros((2, len(border), 3))
        for side in (0, 1):
            known = sides[border, side] >= 0
            one, way = self._layers(mesh.pairs[border[known], side], ends[known].mean(axis=1)[:, np.newaxis])
            thick[side, known], facing[side, known] = np.abs(one[:, 0]), way
        for side in (0, 1):
            across = np.abs(np.einsum("ij,ij->i", facing[side], mesh.normals[mesh.pairs[border, 1 - side]]))
            askew = np.where(
                thick[1 - side] > 0, np.linalg.norm(np.cross(facing[side], facing[1 - side]), axis=1), across
            )
            sliver = thick[side] * np.maximum(thick[side], thick[1 - side]) * length * askew
            away = np.abs(middle[:, 2] - z)
            total += [float((sliver * k).sum()) for k in (arm, arm * away, np.ones_like(away), away)]
        return total

    @cached_property
    def _spans(self) -> Float:
        """The angle that each triangle spans about the axis of its cone, (m,) rad; 0 where it has none."""
        spans = np.zeros(len(self.mesh.faces))
        known = np.flatnonzero(self.label >= 0)
        if len(known):
            point, direction = (k[self.label[known]][:, np.newaxis] for k in self._table[:2])
            local = self.mesh.vertices[self.mesh.faces[known]] - point
            local = local - (local * direction).sum(axis=2, keepdims=True) * direction
            size = np.linalg.norm(local, axis=2)
            for k in range(3):
                j = (k + 1) % 3
                sine = np.linalg.norm(np.cross(local[:, k], local[:, j]), axis=1)
                angle = np.arctan2(sine, (local[:, k] * local[:, j]).sum(axis=1))
                off_axis = np.minimum(size[:, k], size[:, j]) > 1e-6 * size.max(axis=1)  # none from the tip of a cone
                spans[known] = np.maximum(spans[known], np.where(off_axis, angle, 0.0))
        return spans

    def _moments(self, points: Float, edges: Int, side: int, thickness: Float) -> Float:
        """Return ∫ 4 λₐ λ_b t f dA over a triangle at each edge for f = w, w z, 1 and z, (4, k)."""
        mesh = self.mesh
        a, b = mesh.ends[edges].T
        c = mesh.opposite[edges, side]
        w, z = points[:, 0] + 1j * points[:, 1], points[:, 2]
        layer = thickness * mesh.areas[mesh.pairs[edges, side]]
        first, along = (layer * (2.0 * (x[a] + x[b]) + x[c]) / 15.0 for x in (w, z))
        second = 6.0 * (w[a] * z[a] + w[b] * z[b]) + 4.0 * (w[a] * z[b] + w[b] * z[a])
        second += 2.0 * ((w[a] + w[b]) * z[c] + w[c] * (z[a] + z[b] + z[c]))
        return np.stack([first, layer * second / 90.0, layer / 3.0, along])

    def _profiles(self, points: Float) -> list[Float]:
        """Return what the sag of each cone along its generators does."""
        mesh, sag = self.mesh, self.profile_sag
        if not sag.any():
            return []
        length = self._lengths
        total = np.zeros((4, len(self.cones)), complex)
        for side in (0, 1):
            number = self.label[mesh.pairs[:, side]]
            edges = np.flatnonzero((number >= 0) & (sag[number] != 0))
            number = number[edges]
            share = np.minimum(1.0, self._climbs(edges, side) / length[number]) ** 2
            moments = self._moments(points, edges, side, sag[number] * share)
            for k in range(4):
                np.add.at(total[k], number, moments[k])
        return [k for k in total.T if k.any()]

    def _climbs(self, edges: Int, side: int) -> Float:
        """Return how far edges go along the generators of the cones on one side of them, (k,) m."""
        number = self.label[self.mesh.pairs[edges, side]]
        step = np.diff(self.mesh.vertices[self.mesh.ends[edges]], axis=1)[:, 0]
        height = np.abs(np.einsum("ij,ij->i", step, self._table[1][number]))
        climbs: Float = height * np.sqrt(1.0 + self._table[3][number] ** 2)
        return climbs

    def _rounding(self, points: Float) -> list[Float]:
        """Return what the rounding of coordinates does, which differs from vertex to vertex."""
        mesh = self.mesh
        each = [k.rms for k in self.cones]
        rms = np.array([*each, max(each)])[self.label]
        weight = np.bincount(mesh.faces.ravel(), np.repeat(mesh.areas * rms / 3.0, 3), len(points))
        arm, along = np.hypot(points[:, 0], points[:, 1]), points[:, 2]
        each_moves = (weight * k for k in (arm, arm * along, np.ones_like(arm), along))
        return [*np.diag([_SIGMAS * float(np.linalg.norm(k)) for k in each_moves])]
