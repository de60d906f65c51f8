"""Least-squares cylinders through points: one axis, a radius for each cylinder on it.

The points are the *vertices* of a mesh: a mesh inscribes its facets in the true cylinder, so that their middles lie
too deep, while their corners lie on it.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float, Int
from inertia.records import dataclass

_STEPS = 50
_SETTLED = 1e-11  # of the size, and rad
_SINGULAR = 1e-9


@dataclass(frozen=True, eq=False)
class AxisFit:
    """An axis and the cylinders about it, in the unit of the points.

    Attributes
    ----------
    point : (3,) on the axis, nearest to the mean of the points
    direction : (3,) unit
    radii : (c,)
    residuals : (n,) distance from the axis less the radius
    covariance : (4, 4) of (x, y of the point; tilt in x, y) across the axis, from the scatter of the residuals
    frame : (3, 2) the unit vectors x and y
    """

    point: Float
    direction: Float
    radii: Float
    residuals: Float
    covariance: Float
    frame: Float

    @property
    def rms(self) -> float:
        """Root mean square of the residuals."""
        return float(np.sqrt(np.mean(self.residuals**2)))

    def offset(self, point: Float) -> float:
        """Return the distance of a point (3,) from the axis."""
        return float(np.linalg.norm(np.cross(point - self.point, self.direction)))

    def uncertainty(self, point: Float) -> float:
        """Return the standard deviation of the axis at the height of a point (3,)."""
        lever = float((point - self.point) @ self.direction)
        map_to = np.hstack([np.eye(2), lever * np.eye(2)])
        return float(np.sqrt(max(0.0, np.trace(map_to @ self.covariance @ map_to.T))))


def across(direction: Float) -> Float:
    """Return two unit vectors (3, 2), perpendicular to a direction and to each other."""
    helper = np.zeros(3)
    helper[np.argmin(np.abs(direction))] = 1.0
    x = np.cross(direction, helper)
    x /= np.linalg.norm(x)
    frame: Float = np.column_stack([x, np.cross(direction, x)])
    return frame


def circle(points: Float) -> tuple[Float, float] | None:
    """Return centre (2,) and radius of the circle with least Σ (|p − c|² − r²)² through points (n, 2).

    None where they lie on a line. Kåsa, I. (1976), IEEE Trans. Instrum. Meas. 25(1), 8-14.
    """
    mean = points.mean(axis=0)
    local = points - mean
    size = float(np.abs(local).max())
    if size == 0:
        return None
    local = local / size
    matrix = np.column_stack([2.0 * local, np.ones(len(local))])
    solution, _, rank, _ = np.linalg.lstsq(matrix, (local**2).sum(axis=1), rcond=_SINGULAR)
    if rank < 3:
        return None
    center = solution[:2]
    return mean + size * center, size * float(np.sqrt(solution[2] + center @ center))


def fit_axis(points: Float, member: Int, direction: Float, start: Float) -> AxisFit | None:
    """Fit one axis to the points of several coaxial cylinders by Gauss-Newton: least Σ (dᵢ − r_member(i))².

    Parameters
    ----------
    points : (n, 3)
    member : (n,) number of each point's cylinder, 0 to c − 1
    direction : (3,) unit, near the axis
    start : (3,) a point near the axis

    None where the points do not tell an axis, or where the steps do not settle.
    """
    count = int(member.max()) + 1
    if len(points) < 4 + count:
        return None
    middle = points.mean(axis=0)
    local = points - middle
    size = float(np.abs(local).max())
    local = local / size
    origin = (start - middle) / size
    one_hot = (member[:, None] == np.arange(count)).astype(np.float64)
    share = one_hot.sum(axis=0)
    for _ in range(_STEPS):
        frame = across(direction)
        origin = origin - direction * (origin @ direction)
        height = local @ direction
        flat = (local - origin) @ frame
        distance = np.linalg.norm(flat, axis=1)
        if not distance.all():
            return None
        outward = flat / distance[:, None]
        radii = (one_hot.T @ distance) / share
        residual = distance - radii[member]
        jacobian = np.hstack([-outward, -outward * height[:, None]])
        jacobian -= one_hot @ ((one_hot.T @ jacobian) / share[:, None])  # the radii follow
        step, _, rank, _ = np.linalg.lstsq(jacobian, -residual, rcond=_SINGULAR)
        if rank < 4:
            return None
        origin = origin + frame @ step[:2]
        direction = direction + frame @ step[2:]
        direction /= np.linalg.norm(direction)
        if np.abs(step).max() < _SETTLED:
            break
    else:
        return None
    freedom = max(1, len(points) - 4 - count)
    variance = float(residual @ residual) / freedom
    covariance = variance * np.linalg.inv(jacobian.T @ jacobian)
    scale = np.array([size, size, 1.0, 1.0])
    origin = origin - direction * (origin @ direction)
    return AxisFit(
        middle + size * origin, direction, size * radii, size * residual, covariance * np.outer(scale, scale), frame
    )
