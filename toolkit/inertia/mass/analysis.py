"""`Analysis`: everything that a report on one part states."""

from __future__ import annotations

from dataclasses import field
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from inertia.arrays import Float
from inertia.errors import (
    GeometryError,
)
from inertia.mass.density import DensityFrom
from inertia.mass.integrand import ELEMENTS, Integrand
from inertia.mass.integration import TrueShape
from inertia.mass.principal import Principal
from inertia.mass.properties import ErrorBound, MassProperties
from inertia.mesh.checks.findings import Finding
from inertia.mesh.part import Part
from inertia.records import dataclass

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from inertia.mass.uncertainty import StandardUncertainty
    from inertia.mesh.unite import Union  # slow to import, and seldom needed

Accuracy = float | Literal["exact"] | None


@dataclass(frozen=True)
class BodyShare:
    """What one body or region contributes: density kg/m³, volume m³, mass kg, centre of mass (3,) m."""

    name: str
    density: float
    volume: float
    mass: float
    center_of_mass: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Analysis:
    """Everything that a report on one part states; SI units.

    Attributes
    ----------
    part : the part analysed
    model : "solid", "shell" (of `thickness`) or "wire" (of `section`)
    density : kg/m³; the mean where several were given
    density_from : who said so
    triangles, cells : number of elements
    closed : whether the surface bounds a solid
    bodies : number of separate bodies
    area : surface area, m²
    extents : (2, 3) smallest and largest coordinates, m
    properties : `MassProperties`
    tessellation : bounds on what the triangles left out or added, if a chord tolerance was given or reading chose one
    repair : bounds on what the fillings of holes are off by, where repair filled some
    accuracy : what was asked for: a relative figure, "exact" or None
    class_tolerance : relative tolerance within which principal moments count as equal
    principal : `Principal`, at that tolerance
    shares : one entry a body or region, where there are several densities
    about : (point in the part's unit, tensor about it), if asked for
    about_bound : relative bound of that tensor (Frobenius norm)
    doubts : what leaves some of the volume in doubt, as findings of the check; it is in all bounds
    notes : what was decided on the way, in sentences
    crossings_examined : whether triangles of the solid that cross one another were looked for (there are none, then)
    union : what was united, where that was asked for
    shape : the solids of the true shape, where they were integrated in place of triangles
    integrand : the elements and densities behind the properties
    uncertainty : standard uncertainties of the properties, where an input was given with its own
    allowed_faults : the relative bound up to which faults were allowed for, where that was asked for
    refusal : what is said of the part without that, if it is refused
    """

    part: Part
    model: Literal["solid", "shell", "wire"]
    density: float
    density_from: DensityFrom
    triangles: int
    cells: int
    closed: bool
    bodies: int
    area: float
    extents: Float
    properties: MassProperties
    tessellation: ErrorBound | None
    repair: ErrorBound | None
    accuracy: Accuracy
    class_tolerance: float
    shares: tuple[BodyShare, ...]
    about: tuple[tuple[float, ...], Float] | None
    about_bound: float | None
    notes: tuple[str, ...]
    crossings_examined: bool
    doubts: tuple[Finding, ...] = ()
    union: Union | None = None
    shape: TrueShape | None = None
    integrand: Integrand = field(repr=False, kw_only=True)
    uncertainty: StandardUncertainty | None = None
    allowed_faults: float | None = None
    refusal: GeometryError | None = None

    @cached_property
    def principal(self) -> Principal:
        """Principal moments and axes, those within `class_tolerance` of each other counting as equal."""
        return self.properties.principal_within(self.class_tolerance)

    @property
    def about_uncertainty(self) -> Float | None:
        """Standard uncertainties (3, 3) kg m² of the tensor about the point; None where either was not asked for."""
        if self.about is None or self.uncertainty is None:
            return None
        return self.uncertainty.about([Fraction(k) * self.part.unit.metres for k in self.about[0]])

    def plot(self, ax: Axes | None = None) -> Figure:
        """Draw the part, in m, and in it the ellipsoid of the same mass and moments, and return the figure.

        Raises `UsageError` where matplotlib is not installed.
        """
        from inertia.mesh.drawing import draw_part
        from inertia.plotting import draw_ellipsoid, figure_of

        def draw(axes: Axes) -> None:
            draw_part(axes, self.part, float(self.part.unit.metres), opacity=0.35)
            of = self.properties
            draw_ellipsoid(axes, of.center_of_mass, of.equivalent_ellipsoid, self.principal.axes)

        return figure_of(draw, ax, f"{Path(self.part.name).name}: {self.properties.mass:.6g} kg")

    def _repr_html_(self) -> str:
        """Return a small table and a sketch of the equivalent ellipsoid, as a notebook shows them."""
        from inertia.notebook import ellipsoid_svg, html_of

        unit, density = self.part.unit.name, f"{self.density:g} kg/m³"
        rows = [
            ("Part", f"{self.part.name}, in {unit}{', assumed' if self.part.unit_from == 'assumed' else ''}"),
            ("Density", f"{density}{', assumed' if self.density_from == 'assumed' else ''}"),
            ("Mesh", f"{self.triangles or self.cells} {'triangles' if self.triangles else 'cells'}, {self.model}"),
            *self.properties.rows(),
            *self._about_rows(),
            *(() if self.uncertainty is None else self.uncertainty.rows()),
            *(("Doubt", str(doubt.message)) for doubt in self.doubts),
            *(("Note", note) for note in self.notes),
        ]
        return html_of(rows, ellipsoid_svg(self.properties.equivalent_ellipsoid, self.principal.axes))

    def _about_rows(self) -> list[tuple[str, str]]:
        if self.about is None:
            return []
        point, tensor = self.about
        where = f"{', '.join(f'{k:g}' for k in point)} {self.part.unit.name}"
        rows = [(f"About {where}", f"{_elements(tensor, '.10g')} kg m² (xx, yy, zz, xy, xz, yz)")]
        if (u := self.about_uncertainty) is not None:
            rows.append(("u about it", f"{_elements(u, '.2g')} kg m²"))
        return rows


def _elements(tensor: Float, form: str) -> str:
    return ", ".join(f"{tensor[i, j]:{form}}" for i, j in ELEMENTS)
