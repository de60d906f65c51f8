"""Curves on ellipsoids as seen from far away: what is in front is drawn full, what the body of it hides, faint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.records import dataclass

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK, FAINT, SURFACE = "#222222", "#9aa5b1", "#eef2f7"
_GRID = 121  # points of a circle
_HIDDEN = 0.45  # opacity of what is behind


@dataclass(frozen=True, eq=False)
class Projection:
    """An ellipsoid about the origin, seen from a direction.

    Attributes
    ----------
    semi_axes : (3,)
    toward : (3,) unit vector to the eye
    up : (3,) what is shown upright
    """

    semi_axes: Float
    toward: Float
    up: Float

    def at(self, points: Float) -> Float:
        """Return places (…, 2) in the drawing of points (…, 3)."""
        right = np.cross(self.up, self.toward)
        right /= np.linalg.norm(right)
        return np.stack([points @ right, points @ np.cross(self.toward, right)], axis=-1)

    def in_front(self, points: Float) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """Return whether points (n, 3) of the surface face the eye."""
        return np.asarray((points / self.semi_axes**2) @ self.toward >= 0)

    def draw_surface(self, axes: Axes) -> None:
        """Draw the outline, filled, and where the coordinate planes cut the surface."""
        turn = np.linspace(0.0, 2.0 * np.pi, _GRID)
        normal = self.toward / self.semi_axes
        first = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
        first /= np.linalg.norm(first)
        second = np.cross(normal / np.linalg.norm(normal), first)
        edge = self.semi_axes * (np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * second)
        axes.fill(*self.at(edge).T, facecolor=SURFACE, edgecolor=FAINT, linewidth=1.0, zorder=0)
        for k in range(3):
            circle = np.roll(np.stack([np.zeros(_GRID), np.cos(turn), np.sin(turn)], axis=-1), k, axis=1)
            self.draw(axes, circle * self.semi_axes, color=FAINT, linewidth=0.8, zorder=1)

    def draw(self, axes: Axes, curve: Float, label: str | None = None, **how: Any) -> None:
        """Draw a curve (n, 3) on the surface."""
        front, places = self.in_front(curve), self.at(curve)
        # A piece begins and ends at a point that is drawn on both sides.
        reach = front.copy()
        reach[1:] |= front[:-1]
        reach[:-1] |= front[1:]
        order = how.pop("zorder", 3)
        if not front.all():
            hidden = {"alpha": 0.15} if how.get("linestyle") == "none" else {"linestyle": ":", "alpha": _HIDDEN}
            axes.plot(*places.T, **{**how, **hidden}, zorder=order)
        axes.plot(*np.where(reach[:, None], places, np.nan).T, label=label, zorder=order + 1, **how)

    def draw_axes(self, axes: Axes, names: Sequence[str]) -> None:
        """Draw the halves of the coordinate axes that come towards the eye, from the surface on, and their names."""
        shadow = self.at(np.diag(self.semi_axes)).T  # of the surface: all sums of these that lie on a unit sphere
        size = float(np.linalg.norm(shadow, axis=1).max())
        for k, name in enumerate(names):
            way = self.at(np.eye(3)[k] * (1.0 if self.toward[k] >= 0 else -1.0))
            foot = self.semi_axes[k] * way
            way = way / (np.hypot(*way) or 1.0)
            outline = 1.0 / np.sqrt(way @ np.linalg.solve(shadow @ shadow.T, way))
            tip = (outline + 0.12 * size) * way
            axes.annotate(
                "", tuple(tip), tuple(foot), arrowprops={"arrowstyle": "->", "color": INK, "linewidth": 1.2}, zorder=8
            )
            across = "left" if way[0] > 0.2 else "right" if way[0] < -0.2 else "center"
            level = "bottom" if way[1] > 0.2 else "top" if way[1] < -0.2 else "center"
            axes.update_datalim([tip + 0.1 * size * way])  # texts do not count
            x, y = tip + 0.02 * size * way
            axes.text(x, y, name, ha=across, va=level, color=INK, fontsize=11, zorder=9)
