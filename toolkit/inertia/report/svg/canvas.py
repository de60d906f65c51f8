"""`Canvas`: an SVG picture in millimetres, built as a tree, so that it is well-formed and its text is escaped.

Colours and line styles are classes of the report's style sheet; they differ in stroke, not in colour alone.
"""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement, tostring

from markupsafe import Markup

Point = tuple[float, float]

_TEXT = 0.56  # mean width of a character, of the text's height
_STRONG = 0.74  # of a letter of a heading, at most, of the text's height, in the widest of the fonts
_CAPITAL = 0.88  # likewise, and of signs such as + and ±
_WIDE = 1.11  # likewise, of the widest, and of letters that are not Latin
_LEADING = 1.2  # from line to line of a heading, of the text's height


class Canvas:
    """A picture of a width and a height in mm, with x to the right and y down."""

    def __init__(self, width: float, height: float, title: str) -> None:
        self._root = Element(
            "svg",
            {"viewBox": f"0 0 {_mm(width)} {_mm(height)}", "style": f"width:{_mm(width)}mm", "role": "img"},
        )
        SubElement(self._root, "title").text = title
        self._width, self._height = width, height

    def markup(self) -> Markup:
        """Return the picture, to be put into a page as it is."""
        return Markup(tostring(self._root, encoding="unicode"))

    def line(self, start: Point, end: Point, style: str) -> None:
        """Draw a line."""
        ends = {"x1": _mm(start[0]), "y1": _mm(start[1]), "x2": _mm(end[0]), "y2": _mm(end[1])}
        SubElement(self._root, "line", {**ends, "class": style})

    def circle(self, center: Point, radius: float, style: str) -> None:
        """Draw a circle."""
        place = {"cx": _mm(center[0]), "cy": _mm(center[1]), "r": _mm(radius)}
        SubElement(self._root, "circle", {**place, "class": style})

    def rectangle(self, corner: Point, width: float, height: float, style: str) -> None:
        """Draw a rectangle from its upper left corner."""
        place = {"x": _mm(corner[0]), "y": _mm(corner[1]), "width": _mm(width), "height": _mm(height)}
        SubElement(self._root, "rect", {**place, "class": style})

    def polygon(self, points: Iterable[Point], style: str) -> None:
        """Draw a closed polygon."""
        SubElement(self._root, "polygon", {"points": _points(points), "class": style})

    def path(self, loops: Iterable[Iterable[Point]], style: str) -> None:
        """Draw closed loops as one area, in which every second one is a hole."""
        way = "".join("M" + "L".join(f"{_mm(x)} {_mm(y)}" for x, y in loop) + "Z" for loop in loops)
        if way:
            SubElement(self._root, "path", {"d": way, "fill-rule": "evenodd", "class": style})

    def polyline(self, points: Iterable[Point], style: str) -> None:
        """Draw an open polyline."""
        SubElement(self._root, "polyline", {"points": _points(points), "class": style})

    def text(self, place: Point, text: str, *, size: float = 2.6, anchor: str = "middle", style: str = "") -> None:
        """Write text; `place` is on its baseline, `anchor` is "start", "middle" or "end"."""
        attributes = {"x": _mm(place[0]), "y": _mm(place[1]), "font-size": _mm(size), "text-anchor": anchor}
        if style:
            attributes["class"] = style
        SubElement(self._root, "text", attributes).text = text

    def heading(self, text: str, y: float, *, size: float) -> None:
        """Write a heading in the middle, its last line at `y`: the picture grows upwards by what further lines take."""
        lines = _wrapped(text, self._width / size)
        above = _LEADING * size * (len(lines) - 1)
        self._root.set("viewBox", f"0 {_mm(-above)} {_mm(self._width)} {_mm(self._height + above)}")
        for k, line in enumerate(lines):
            self.text((0.5 * self._width, y - above + _LEADING * size * k), line, size=size, style="strong")

    def arrow(self, start: Point, end: Point, style: str, head: float = 2.2) -> None:
        """Draw an arrow; a short one keeps its head, which then is smaller."""
        length = math.dist(start, end)
        if length == 0:
            return
        size = min(head, 0.7 * length)
        along = ((end[0] - start[0]) / length, (end[1] - start[1]) / length)
        neck = (end[0] - size * along[0], end[1] - size * along[1])
        wide = 0.35 * size
        self.line(start, neck, style)
        left = (neck[0] - wide * along[1], neck[1] + wide * along[0])
        right = (neck[0] + wide * along[1], neck[1] - wide * along[0])
        self.polygon([end, left, right], f"{style} head")


def rectangular(magnitude: float, angle: float) -> complex:
    """Return the vector of a magnitude at an angle in degrees."""
    return cmath.rect(magnitude, math.radians(angle))


def text_width(text: str, size: float) -> float:
    """Return about how wide a text is, mm."""
    return _TEXT * size * len(text)


def heading_width(text: str, size: float) -> float:
    """Return how wide a text in bold is at most, mm.

    >>> round(heading_width("plane W", 1.0), 2)
    5.55
    """
    return size * sum(map(_strong, text.strip()))


def _strong(letter: str) -> float:
    if letter in "MWmw%@" or ord(letter) > ord("ɏ"):
        return _WIDE
    return _CAPITAL if letter.isupper() or letter in "&+<=>^~#±×÷" else _STRONG


def _wrapped(text: str, room: float) -> list[str]:
    """Return lines of a text in bold that are no wider than so many heights; a word that is wider is cut."""
    lines = [""]
    for word in re.split(r"(?<=\s)|(?<=\w-)", text):
        if heading_width(word, 1.0) <= room < heading_width(lines[-1] + word, 1.0):
            lines.append("")
        for letter in word:
            if lines[-1] and heading_width(lines[-1] + letter, 1.0) > room:
                lines.append("")
            lines[-1] += letter
    return [line.strip() for line in lines]


def levels(places: Iterable[float], widths: Iterable[float]) -> list[int]:
    """Return the level of each label, centred at its place, so that none lies upon another; places ascend.

    >>> levels([0.0, 3.0, 20.0], [5.0, 5.0, 5.0])
    [0, 1, 0]
    """
    ends: list[float] = []
    level_of = []
    for place, width in zip(places, widths, strict=True):
        start, end = place - 0.5 * width, place + 0.5 * width
        level = next((k for k, last in enumerate(ends) if start >= last), len(ends))
        ends[level : level + 1] = [end]
        level_of.append(level)
    return level_of


def _points(points: Iterable[Point]) -> str:
    return " ".join(f"{_mm(x)},{_mm(y)}" for x, y in points)


def _mm(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".")
