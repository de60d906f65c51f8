"""What every plot by matplotlib shares: whether it can be drawn, and a file that is whole or not there."""

from __future__ import annotations

import io
import logging
import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from inertia.errors import UsageError
from inertia.output import require_writable, write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
