"""What every plot by matplotlib shares: whether it can be drawn, and a file that is whole or not there."""

from __future__ import annotations

import io
import logging
import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.errors import UsageError
from inertia.notebook import COLORS, EYE, outline, seen
from inertia.output import require_writable, write_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LINE = "#555555"

SUFFIXES = (".svg", ".png")


def require_plottable(file: str | os.PathLike[str], *, force: bool = False) -> Path:
    """Return the path of a plot that can be written: to be asked before work that takes a while.

    Raises
    ------
    UsageError : the name ends neither in .svg nor .png, the file exists and `force` is not set, or matplotlib is not
        installed
    InertiaError : its folder cannot be written to
    """
    path = require_writable(file, *SUFFIXES, force=force)
    require_matplotlib()
    return path


def require_matplotlib() -> None:
    """Raise `UsageError` where matplotlib is not installed."""
    try:
        with quiet_matplotlib():
            import matplotlib  # noqa: F401
    except ImportError:
        raise UsageError(
            "plotting needs matplotlib: install it by pip install 'inertia[plot]'", code="needs_package"
        ) from None


def write_figure(figure: Callable[[], Figure], file: str | os.PathLike[str], *, force: bool = False) -> None:
    """Draw a figure and write it to a file, SVG or PNG by its name; raises as `require_plottable`."""
    import matplotlib as mpl

    path = require_plottable(file, force=force)
    kind = path.suffix.lower()[1:]
    image = io.BytesIO()
    style = mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "inertia", "font.size": 10.0})
    with quiet_matplotlib(), style, warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # a name in a script that the font lacks
        figure().savefig(image, format=kind, metadata={"Date": None} if kind == "svg" else None)
    write_whole(path, image.getvalue())


@contextmanager
def quiet_matplotlib() -> Iterator[None]:
    """Let matplotlib keep to itself that it has no home for its cache, and that it looks for fonts."""
    logger = logging.getLogger("matplotlib")
    level = logger.level
    logger.setLevel(logging.ERROR)
    try:
        yield
    finally:
        logger.setLevel(level)


def own_figure(**options: Any) -> Figure:
    """Return a figure that shows itself in a notebook, which those made without pyplot do not."""
    from matplotlib.figure import Figure

    figure = Figure(**options)
    setattr(figure, "_repr_png_", partial(_png, figure))  # noqa: B010  # a name that the type does not declare
    return figure


def _png(figure: Figure) -> bytes:
    image = io.BytesIO()
    figure.savefig(image, format="png")
    return image.getvalue()


def figure_of(draw: Callable[[Axes], None], ax: Axes | None, title: str) -> Figure:
    """Draw on axes that are given, or on a figure of its own, and return the figure; pyplot is not touched.

    Raises `UsageError` where matplotlib is not installed.
    """
    require_matplotlib()
    with quiet_matplotlib():
        axes = own_figure(figsize=(6.0, 4.5), layout="constrained").add_subplot() if ax is None else ax
        draw(axes)
        axes.set_title(title, fontsize=10)
        figure = axes.get_figure(root=True)
        assert figure is not None  # axes that are to be drawn on are on a figure
        return figure


def draw_triangles(axes: Axes, corners: Float, *, opacity: float = 1.0) -> None:
    """Draw triangles (n, 3, 3), the nearest last, as lit from the eye."""
    from matplotlib.collections import PolyCollection

    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    toward = EYE / np.linalg.norm(EYE)
    light = 0.45 + 0.5 * np.abs(normals @ toward) / np.where(lengths > 0.0, lengths, 1.0)
    order = np.argsort(corners.mean(axis=1) @ toward)
    colors = np.repeat(light[order, None], 3, axis=1)
    axes.add_collection(PolyCollection(list(seen(corners[order])), facecolors=colors, linewidths=0, alpha=opacity))
    bare(axes)


def draw_lines(axes: Axes, paths: Float, *, opacity: float = 1.0) -> None:
    """Draw lines through k points each, (n, k, 3); single points are dots."""
    from matplotlib.collections import LineCollection

    where = seen(paths)
    if paths.shape[1] == 1:
        axes.plot(where[:, 0, 0], where[:, 0, 1], ".", color=_LINE, alpha=opacity)
    else:
        axes.add_collection(LineCollection(list(where), colors=_LINE, linewidths=1.0, alpha=opacity))
    bare(axes)


def draw_ellipsoid(axes: Axes, center: Float, semi_axes: Float, directions: Float) -> None:
    """Draw the outline of an ellipsoid and its semi-axes, numbered."""
    middle = seen(center)
    axes.plot(*(middle + outline(semi_axes, directions)).T, color=_LINE, linewidth=1.0)
    for number, end, color in zip("123", seen((directions * semi_axes).T), COLORS, strict=True):
        axes.plot(*np.array([middle - end, middle + end]).T, color=color, linewidth=1.5)
        axes.annotate(number, tuple(middle + end), color=color)
    bare(axes)


def bare(axes: Axes) -> None:
    """Take the box and its ticks away, and make the units of both directions equally long."""
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.margins(0.06)
    axes.autoscale_view()
