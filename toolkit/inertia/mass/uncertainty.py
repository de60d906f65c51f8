"""Standard uncertainties of mass properties by the law of propagation (GUM), from those of vertices, density, scale.

JCGM 100:2008 (GUM), 5.1.2 and 5.2.2: to first order the covariance of the results is Σ Jᵢ u²(xᵢ) Jᵢᵀ over inputs xᵢ
that are independent of each other, Jᵢ the derivatives with respect to xᵢ. Independent are the coordinates of different
vertices, the densities with names of their own, the mass as weighed, the thickness and the scale; a density and a scale
are common to all that they are of.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.errors import UNIT, GeometryError, UsageError
from inertia.estimate import uncertainty_of
from inertia.mass.density import Densities
from inertia.mass.integrand import (
    Integrand,
    matrix_of,
    principal_elements,
    principal_rates,
    six_of,
)
from inertia.mass.principal import Principal
from inertia.mass.properties import MassProperties
from inertia.mass.tensor import exact_point, point_inertia
from inertia.mesh.part import Cells
from inertia.records import dataclass

_ORDER = (0, 1, 2, 5, 4, 3)  # of `ELEMENTS` among the second moments of `inertia.mass.moments`
_APART = 2.0  # standard uncertainties of the difference of two moments, below which they may be equal
_SHOWN = 0.1  # of u: what second order adds, above which it is said
_CHUNK = 1 << 16
_LEAST = 1e-120  # of volume, mass and tensor: less, squared and a small part of that, leaves float64

_INPUTS = {"vertices": "m a coordinate", "mass": "kg", "thickness": "m", "section": "m²", "scale": "(relative)"}


@dataclass(frozen=True, eq=False)
class StandardUncertainty:
    """Standard uncertainties u of mass properties; SI, part axes.

    Attributes
    ----------
    inputs : u of each uncertain input: "vertices" (m, of each coordinate), "density" or "density of NAME" (kg/m³),
        "mass" (kg), "thickness" (m), "section" (m²), "scale" (relative)
    components : what each input contributes to `covariance`
    properties : what is uncertain
    principal : its principal moments and axes, those counting as equal that differ by less than 2 u of their difference
    bias : (3, 3) kg m², by how much noise of the vertices makes a tensor that is computed too large on average, to
        second order; None where it is not known
    remarks : what first order leaves out, in sentences, where it shows
    coverage : the factor k of the expanded uncertainties U = k u that were asked for; None without
    """

    inputs: Mapping[str, float]
    components: Mapping[str, Float]
    properties: MassProperties
    principal: Principal
    bias: Float | None
    remarks: tuple[str, ...] = ()
    coverage: float | None = None

    @cached_property
    def covariance(self) -> Float:
        """Covariance (11, 11) of volume, mass, x, y, z of the centre of mass, xx, yy, zz, xy, xz, yz of the tensor."""
        return sum(self.components.values(), np.zeros((11, 11)))

    def of(self, component: str | None = None) -> Float:
        """Return u of the eleven quantities of `covariance`, or what one input contributes."""
        if component is not None and component not in self.components:
            raise UsageError(f"no input {component!r} is uncertain: use one of {', '.join(map(repr, self.components))}")
        return _root((self.covariance if component is None else self.components[component]).diagonal())

    @property
    def stated(self) -> list[str]:
        """Each uncertain input with its u and unit, as a sentence lists them."""
        return [f"{name} {u:.2g} {_INPUTS.get(name, 'kg/m³')}" for name, u in self.inputs.items()]

    def rows(self) -> list[tuple[str, str]]:
        """Return what a notebook shows, as labels and texts."""

        def figures(k: float) -> str:
            center, moments = (
                ", ".join(f"{k * u:.2g}" for u in each) for each in (self.center_of_mass, self.principal_moments)
            )
            return f"mass {k * self.mass:.2g} kg, centre of mass {center} m, moments {moments} kg m²"

        stated = ("Uncertain", f"{', '.join(self.stated)} (standard uncertainties u, GUM)")
        expanded = [(f"U, k = {self.coverage:g}", figures(self.coverage))] if self.coverage else []
        return [stated, ("u", figures(1.0)), *expanded]

    @property
    def volume(self) -> float:
        """u of the volume, m³."""
        return float(self.of()[0])

    @property
    def mass(self) -> float:
        """u of the mass, kg."""
        return float(self.of()[1])

    @property
    def center_of_mass(self) -> Float:
        """u of its components, (3,) m."""
        return self.of()[2:5]

    @property
    def inertia(self) -> Float:
        """u of the tensor's elements, (3, 3) kg m²."""
        return matrix_of(self.of()[5:])

    def about(self, point: ArrayLike | Sequence[Fraction]) -> Float:
        """Return u of the tensor's elements about `point` (3,) m, (3, 3) kg m²: Steiner's theorem with all covariances.

        δI_P = δI + δm (b² − b bᵀ) + m (2 b·δG − δG bᵀ − b δGᵀ), b = G − P.
        """
        mass, center = self.properties.mass, self.properties.center_of_mass
        b = center - np.array([float(k) for k in exact_point(point, "point")])
        rates = np.zeros((6, 11))
        rates[:, 5:] = np.eye(6)
        rates[:, 1] = six_of(point_inertia(1.0, b))
        for axis, e in enumerate(np.eye(3)):
            rates[:, 2 + axis] = mass * six_of(2.0 * b[axis] * np.eye(3) - np.outer(e, b) - np.outer(b, e))
        return matrix_of(_root(np.einsum("ik,kl,il->i", rates, self.covariance, rates)))

    @property
    def principal_moments(self) -> Float:
        """u of the principal moments, (3,) kg m²; of moments that count as equal, the root mean square of theirs.

        The mean square of how far d equal moments come apart is E|δI|²/d over their subspace, whatever its axes.
        """
        elements = principal_elements(self.principal.axes)
        covariance = elements @ self.covariance[5:, 5:] @ elements.T
        squares = covariance.diagonal().copy()
        for group in self.principal.equal:
            across = [row for row, pair in enumerate(((1, 2), (2, 0), (0, 1)), 3) if set(pair) <= set(group)]
            shared = (covariance.diagonal()[list(group)].sum() + 2 * covariance.diagonal()[across].sum()) / len(group)
            squares[list(group)] = shared
        return _root(squares[:3])

    @property
    def principal_axes(self) -> Float:
        """Root mean square angle between each axis and the true one, (3,) rad; nan where moments may be equal."""
        rates = principal_rates(self.principal)[3:]
        turns = np.einsum("ki,ij,kj->k", rates, self.covariance[5:, 5:], rates)
        return _root(np.array([turns[k - 2] + turns[k - 1] for k in range(3)]))


def standard_uncertainty(
    integrand: Integrand,
    principal: Principal,
    stated: Densities,
    *,
    sigma: float = 0.0,
    scale: float = 0.0,
    thickness: float = 0.0,
    coverage: float | None = None,
) -> StandardUncertainty:
    """Propagate the uncertainties of the inputs of an analysis to its results.

    Parameters
    ----------
    integrand : elements and densities
    principal : of the same body
    stated : densities and mass, those that are an `Estimate` uncertain
    sigma : standard deviation of each coordinate of each vertex, in the part's unit; vertices in one place are one
    scale : u of a factor that is common to all coordinates, about the file's origin
    thickness : relative u of a shell's thickness, or of a wire's cross-section
    coverage : k

    Raises `GeometryError` where the part is so large or so small that covariances leave float64, `UsageError` where the
    uncertainties of the inputs are so large.
    """
    properties = integrand.properties
    sizes = properties.volume, properties.mass, float(np.abs(properties.inertia).max())
    if min(k for k in sizes if k) < _LEAST or max(sizes) > 1 / _LEAST:
        raise GeometryError(
            f"{integrand.part.name}: volume, mass or tensor is beyond 1e±120 in SI units, so that covariances leave "
            "float64: give the coordinates in another unit with ",
            UNIT,
        )
    try:
        with np.errstate(over="raise"):
            return _propagated(integrand, principal, stated, sigma, scale, thickness, coverage)
    except (FloatingPointError, OverflowError):
        raise UsageError(
            "the standard uncertainties of the inputs lead to variances above 1.8e308: check their sizes and units"
        ) from None


def _propagated(
    integrand: Integrand,
    principal: Principal,
    stated: Densities,
    sigma: float,
    scale: float,
    thickness: float,
    coverage: float | None,
) -> StandardUncertainty:
    """Return what `standard_uncertainty` does, whose parameters these are."""
    properties, metres = integrand.properties, float(integrand.part.unit.metres)
    weighing, tensor = integrand.weighing, six_of(properties.inertia)
    inputs: dict[str, float] = {}
    responses: dict[str, Float] = {}
    components: dict[str, Float] = {}
    if sigma:
        inputs["vertices"] = sigma * metres
        components["vertices"] = (sigma * metres) ** 2 * _vertex_covariance(integrand)
    for name in dict.fromkeys(_named(stated, group.name) for group in integrand.groups):
        if u := uncertainty_of(stated.of(name)):
            label = f"density of {name}" if name else "density"
            inputs[label], responses[label] = u, u * _density_response(integrand, stated, name)
    if stated.mass is not None and (u := uncertainty_of(stated.mass)):
        inputs["mass"] = u
        components["mass"] = _square(u * np.concatenate([[0.0, 1.0], np.zeros(3), tensor / properties.mass]))
    d = integrand.dimension
    if thickness:
        label = "thickness" if integrand.model == "shell" else "section"
        inputs[label] = thickness * float(integrand.factor / integrand.part.unit.metres**d)
        whole = np.concatenate([[properties.volume, properties.mass], np.zeros(3), tensor])
        responses[label] = thickness * whole
    if scale:
        inputs["scale"] = scale
        grown = [d * properties.volume, d * properties.mass], properties.center_of_mass, (d + 2) * tensor
        responses["scale"] = scale * np.concatenate(grown)
    raw = components.get("vertices")
    components |= {name: _square(response) for name, response in responses.items()}
    if integrand.weighed:
        components = {name: one if name == "mass" else weighing @ one @ weighing.T for name, one in components.items()}
    covariance = sum(components.values(), np.zeros((11, 11)))
    bias, remarks = None, []
    if raw is not None:
        bias = _tensor_bias(integrand, raw, sigma * metres)
        remarks = list(_second_order(integrand, raw, bias, sigma * metres))
    principal = replace(principal, equal=_may_be_equal(principal, covariance[5:, 5:]))
    return StandardUncertainty(inputs, components, properties, principal, bias, tuple(remarks), coverage)


def _root(variance: Float) -> Float:
    """Return standard deviations; rounding makes no variance negative."""
    root: Float = np.sqrt(np.maximum(variance, 0.0))
    return root


def _square(response: Float) -> Float:
    square: Float = np.multiply.outer(response, response)
    return square


def _named(stated: Densities, name: str) -> str:
    """Return the name under which the density of a group is stated: "" for the rest."""
    return name if name in stated.named else ""


def _vertex_covariance(integrand: Integrand) -> Float:
    """Return Σ J Jᵀ over the coordinates of all vertices, (11, 11), before the mass that was given."""
    covariance = np.zeros((11, 11))
    for _, volume, moments in integrand.blocks():
        response = integrand.responses(volume, np.swapaxes(moments, 1, 2)).reshape(-1, 11)
        covariance += np.einsum("vi,vj->ij", response, response)
    return covariance


def _density_response(integrand: Integrand, stated: Densities, name: str) -> Float:
    """Return the change of the eleven quantities for one kg/m³ of the density stated under a name."""
    metres = integrand.part.unit.metres
    com = [metres * k for k in integrand.center]
    total = np.zeros(10)
    for group, weight in zip(integrand.groups, integrand.weights, strict=True):
        if _named(stated, group.name) == name:
            share = weight / Fraction(stated.of(group.name))  # not 1 where the mass was weighed
            m = group.moments.in_unit(metres).scaled(integrand.factor * share).about(com)
            total += [float(k) for k in (m.zeroth, *m.first, *(m.second[k] for k in _ORDER))]
    return integrand.responses(np.zeros(()), total)


def _may_be_equal(principal: Principal, covariance: Float) -> tuple[tuple[int, ...], ...]:
    """Return the groups of moments that are equal, or nearer to each other than 2 u of their difference."""
    rows = principal_elements(principal.axes)[:3]
    equal = []
    for k in range(2):
        difference = rows[k + 1] - rows[k]
        u = math.sqrt(max(float(difference @ covariance @ difference), 0.0))
        together = any(k in group and k + 1 in group for group in principal.equal)
        equal.append(together or bool(principal.moments[k + 1] - principal.moments[k] <= _APART * u))
    low, high = equal
    if low and high:
        return ((0, 1, 2),)
    return ((0, 1),) if low else ((1, 2),) if high else ()


def _straight(integrand: Integrand) -> bool:
    geometry = integrand.part.geometry
    if integrand.origin is not None:
        return False
    if isinstance(geometry, Cells):
        return integrand.model == "solid" and all(
            block.kind in ("tetra", "triangle", "quad", "line", "vertex") for block in geometry.blocks
        )
    return integrand.model == "solid"


def _tensor_bias(integrand: Integrand, covariance: Float, sigma: float) -> Float | None:
    """Return E δI to second order, where the elements are tetrahedra or solids bounded by triangles, not united.

    Each is a cubic or higher polynomial of independent vertices: ½ σ² Σ ∇² is 0 for volume and first moments and
    ½ σ² m δᵢⱼ for ∫xᵢxⱼ dm, whatever the mesh; that the centre of mass moves along takes m cov(G) away again. Of a mass
    that was given, I M/m₀ is off by the variance of the computed mass m₀ and its covariance with the tensor too.
    """
    if not _straight(integrand):
        return None
    properties = integrand.properties
    mass, tensor = properties.mass, properties.inertia
    moved = covariance[2:5, 2:5]
    bias: Float = mass * (sigma * sigma * np.eye(3) - (np.trace(moved) * np.eye(3) - moved))
    if integrand.weighed:
        bias = bias + tensor * covariance[1, 1] / mass**2 - matrix_of(covariance[5:, 1]) / mass
    return bias


def _second_order(integrand: Integrand, raw: Float, bias: Float | None, sigma: float) -> list[str]:
    """Return what first order leaves out, where it is more than a tenth of u.

    The terms of second order of the volume are the products of neighbours' moves: they add at most σ⁴ Σ e²/12 over the
    edges e of all triangles to its variance. The area of a triangle grows by σ² Σ e²/(8 A) on average.
    """
    remarks: list[str] = []
    covariance = integrand.weighing @ raw @ integrand.weighing.T
    if bias is not None:
        norm, u = float(np.linalg.norm(bias)), float(np.linalg.norm(matrix_of(_root(covariance.diagonal()[5:]))))
        if norm > _SHOWN * u:
            remarks.append(
                f"noise of that size makes a computed tensor larger by {norm:.2g} kg m² on average, {norm / u:.2g} of "
                "its standard uncertainty from the vertices (second order): that is not in u"
            )
    if integrand.model == "wire" or isinstance(integrand.part.geometry, Cells):
        return remarks
    part = integrand.part if integrand.origin is None else integrand.origin[0]
    triangles, metres = part.triangles, float(integrand.part.unit.metres)
    edges = growth = 0.0
    for start in range(0, triangles.count, _CHUNK):
        corners = triangles.corners(start, min(start + _CHUNK, triangles.count)) * metres
        sides = np.roll(corners, -1, axis=1) - corners
        squares = (sides * sides).sum(axis=(1, 2))
        area = 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
        edges += float(squares.sum())
        growth += float(np.divide(squares, 8 * area, out=np.zeros_like(area), where=area > 0).sum())
    if integrand.model == "shell":
        metre_squared = growth * sigma * sigma
        thickness = float(integrand.factor / integrand.part.unit.metres**2)
        u = math.sqrt(max(raw[0, 0], 0.0))
        if metre_squared * thickness > _SHOWN * u:
            remarks.append(
                f"noise of that size makes a computed area larger by {metre_squared:.2g} m² on average (second order), "
                "and all that is in proportion to it: that is not in u"
            )
        return remarks
    more = math.sqrt(1.0 + sigma**4 * edges / 12.0 / raw[0, 0]) - 1.0 if raw[0, 0] > 0 else math.inf
    if more > 0.5 * _SHOWN:
        remarks.append(
            "the noise is not small beside the edges of the triangles: terms of second order add up to "
            f"{100 * more:.2g} % to the standard uncertainty of the volume, and the like to others: that is not in u"
        )
    return remarks
