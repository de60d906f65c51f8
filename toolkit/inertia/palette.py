"""The colours that plots, pages and recordings share, told apart by the colour-blind, on light and on dark.

`COLORS` have a contrast of at least 3 : 1 to white and to the near-black of Rerun's dark theme, and any two of them
differ by at least 11 (CIEDE2000) for normal eyes and as protanopes, deuteranopes and tritanopes see them. The bright
ones are for a dark ground alone.

References
----------
M. Okabe, K. Ito, Color Universal Design, 2008: all but `VIOLET`, `PLUM` and `GREY`.
"""

from __future__ import annotations

VERMILLION, GREEN, BLUE = "#D55E00", "#009E73", "#0072B2"
VIOLET, PLUM, GREY = "#AA77FF", "#BB2288", "#666655"
COLORS = (VERMILLION, GREEN, BLUE, VIOLET, PLUM, GREY)
"""Of series in their order, and of axes 1, 2, 3."""

ORANGE, SKY, YELLOW, PINK, WHITE = "#E69F00", "#56B4E9", "#F0E442", "#CC79A7", "#FFFFFF"
BRIGHT = (ORANGE, SKY, YELLOW, PINK, WHITE)
"""For dark ground, where at least 5 : 1; too faint on white."""
DARK = "#0D0D0D"
"""The ground of Rerun's dark theme, and of its views in space whatever the theme."""


def rgb(color: str) -> tuple[int, int, int]:
    """Return red, green and blue, 0 to 255.

    >>> rgb(VERMILLION)
    (213, 94, 0)
    """
    red, green, blue = bytes.fromhex(color.removeprefix("#"))
    return red, green, blue
