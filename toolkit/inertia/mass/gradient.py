"""Derivatives of volume, mass, centre of mass, tensor and principal axes with respect to every vertex coordinate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from inertia.arrays import Float, Int, Orientation
from inertia.errors import require_kind
from inertia.mass.analyse import analyse
from inertia.mass.integrand import matrix_of, principal_rates
from inertia.mass.principal import Principal
from inertia.mesh.part import Part
from inertia.records import dataclass


@dataclass(frozen=True, eq=False)
class Gradient:
    """Derivatives with respect to the coordinates of n vertices; SI, part axes; the last axis is that coordinate's.

    Attributes
    ----------
    vertices : (n, 3) the distinct vertices, as stored, in the part's unit
    rows : the row of each vertex: (m, 3) of the corners of an STL file's triangles, (k,) of the vertices or nodes that
        the part numbers; those with the same coordinates share one, and move together
    volume : (n, 3) m³/m
    mass : (n, 3) kg/m
    center_of_mass : (n, 3, 3) m/m, of each component
    inertia : (n, 3, 3, 3) kg m²/m, of each element of the tensor about the centre of mass
    principal_moments : (n, 3, 3) kg m²/m, of each moment; in the axes of `Principal` where some are equal
    principal_axes : (n, 3, 3) rad/m, of the angles by which the axes turn about axis 1, 2 and 3; nan about an axis
        at right angles to two whose moments are equal
    """

    vertices: Float
    rows: Int
    responses: Float
    """(n, 3, 11), the last axis volume, mass, centre of mass and tensor, the latter in the order of `ELEMENTS`."""
    principal: Principal

    @property
    def volume(self) -> Float:
        """See the class."""
        return self.responses[:, :, 0]

    @property
    def mass(self) -> Float:
        """See the class."""
        return self.responses[:, :, 1]

    @property
    def center_of_mass(self) -> Float:
        """See the class."""
        return np.swapaxes(self.responses[:, :, 2:5], 1, 2)

    @property
    def inertia(self) -> Float:
        """See the class."""
        return np.moveaxis(matrix_of(self.responses[:, :, 5:]), 1, 3)

    @property
    def principal_moments(self) -> Float:
        """See the class."""
        return np.swapaxes(self.responses[:, :, 5:] @ principal_rates(self.principal)[:3].T, 1, 2)

    @property
    def principal_axes(self) -> Float:
        """See the class."""
        return np.swapaxes(self.responses[:, :, 5:] @ principal_rates(self.principal)[3:].T, 1, 2)


def gradient(
    part: Part,
    density: float | Mapping[str, float] | None = None,
    *,
    material: str | Mapping[str, str] | None = None,
    mass: float | None = None,
    shell: float | None = None,
    wire: float | None = None,
    orientation: Orientation = "stored",
    union: bool = False,
) -> Gradient:
    """Differentiate the mass properties of a part with respect to the coordinates of its vertices.

    The derivatives are closed forms, evaluated in float64 by one pass over triangles, cells or lines. Of a part that
    has a true shape (STEP) they are those of its triangles.

    Parameters
    ----------
    part, density, material, mass, shell, wire, orientation, union : as of `mass_properties`; of a union the vertices
        are those of the part that is united

    Raises
    ------
    GeometryError, UsageError : as of `mass_properties`

    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> part = Part.from_arrays(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> change = gradient(part, 6.0)
    >>> change.mass[1].tolist()  # moved out along x, a corner adds to the mass; moved along the others, nothing
    [1.0, 0.0, 0.0]
    >>> change.center_of_mass[1].round(12).tolist()
    [[0.25, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.25]]
    """
    require_kind(part, Part, "part", "inertia.read(path)")
    if part.shape is not None:
        part = replace(part, shape=None)
    analysis = analyse(
        part, density, material=material, mass=mass, shell=shell, wire=wire, orientation=orientation, union=union
    )
    integrand = analysis.integrand
    (vertices, rows), weighing = integrand.rows, integrand.weighing
    responses = np.empty((len(vertices), 3, 11))
    for first, volume, moments in integrand.blocks():
        some = integrand.responses(volume, np.swapaxes(moments, 1, 2))
        responses[first : first + len(volume)] = some @ weighing.T if integrand.weighed else some
    return Gradient(vertices, rows, responses, analysis.principal)
