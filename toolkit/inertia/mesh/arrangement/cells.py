"""Division of a triangle by segments into convex cells: a binary space partition in its plane, in integers.

A segment cuts only those cells whose interior it enters, each along the whole of its line. (H. Fuchs, Z. M. Kedem and
B. F. Naylor, "On visible surface generation by a priori tree structures", Computer Graphics 14 (1980) 124.) Segments
come in an order that looks random, so that the tree is shallow.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf

from inertia.mesh.arrangement.integers import Line, Point, meet, scaled, side
from inertia.records import dataclass

_CLEAR = 1e-12  # of a coordinate: far more than it is rounded by
_SPREAD, _MODULUS = 2_654_435_761, 1 << 32  # multiplicative hashing (D. E. Knuth)


@dataclass(frozen=True)
class Segment:
    """A piece of a line in a triangle's plane; `name` tells lines in space apart, as far as it is known."""

    line: Line
    name: tuple[int, int]
    start: Point
    end: Point


@dataclass(frozen=True)
class Cell:
    """A convex polygon, counter-clockwise as it is seen.

    Attributes
    ----------
    corners : points
    lines : for each corner, which line (its number in `Division.lines`) the edge from there runs along
    inner : for each corner, on which side of that line the cell lies: 1 or −1
    """

    corners: list[Point]
    lines: list[int]
    inner: list[int]

    def points(self, exponent: int) -> list[tuple[float, float]]:
        """Return the corners times 2**exponent, rounded."""
        return [(scaled(x, w, exponent), scaled(y, w, exponent)) for x, y, w in self.corners]

    def area(self, exponent: int) -> float:
        """Return twice the area, rounded, of the cell times 2**exponent."""
        (a, b), *rest = self.points(exponent)
        return sum((p - a) * (s - b) - (r - a) * (q - b) for (p, q), (r, s) in pairwise(rest))

    def contains(self, point: Point, lines: Sequence[Line]) -> bool:
        """Say whether a point lies inside, and not on the boundary."""
        return all(way * side(lines[line], point) > 0 for line, way in zip(self.lines, self.inner, strict=True))


@dataclass(frozen=True)
class Division:
    """The cells of a triangle.

    Attributes
    ----------
    cells : convex
    lines, names : what bounds them; the first three are the triangle's edges
    group : for each cell a number, the same for cells that no segment keeps apart, as far as that is clear
    """

    cells: list[Cell]
    lines: list[Line]
    names: list[tuple[int, int]]
    group: list[int]


class _Node:
    """A cell, or a line with what lies on its positive and on its negative side."""

    __slots__ = ("above", "below", "cell", "label", "line")

    def __init__(self, cell: Cell) -> None:
        self.cell: Cell | None = cell
        self.line: Line = (0, 0, 0)
        self.label = -1
        self.above = self.below = self


def divide(
    corners: Sequence[Point],
    lines: Sequence[Line],
    names: Sequence[tuple[int, int]],
    segments: Sequence[Segment],
    exponent: int,
) -> Division:
    """Divide a triangle by segments.

    Parameters
    ----------
    corners : of the triangle, counter-clockwise
    lines, names : of its edges, the triangle being on their positive sides
    segments : in an order that depends on nothing but the geometry
    exponent : coordinates times 2**exponent are float64 numbers
    """
    division = Division([], list(lines), list(names), [])
    covered: list[list[tuple[Point, Point]]] = [[], [], []]
    root = _Node(Cell(list(corners), [0, 1, 2], [1, 1, 1]))
    crossings: dict[tuple[int, int], Point] = {}
    for number in sorted(range(len(segments)), key=lambda k: (k + 1) * _SPREAD % _MODULUS):
        segment = segments[number]
        label = len(division.lines)
        division.lines.append(segment.line)
        division.names.append(segment.name)
        covered.append([(segment.start, segment.end)])
        todo = [(root, segment.start, segment.end)]
        while todo:
            node, start, end = todo.pop()
            if node.cell is not None:
                _split(node, node.cell, label, division.lines, crossings)
                continue
            at_start, at_end = side(node.line, start), side(node.line, end)
            if at_start == 0 and at_end == 0:  # these cells are apart along this very line
                covered[node.label].append((start, end))
                continue
            if at_start >= 0 and at_end >= 0:
                todo.append((node.above, start, end))
            elif at_start <= 0 and at_end <= 0:
                todo.append((node.below, start, end))
            else:
                between = meet(segment.line, node.line)
                above, below = (start, end) if at_start > 0 else (end, start)
                todo += [(node.above, above, between), (node.below, below, between)]
    leaves = [root]
    while leaves:
        node = leaves.pop()
        if node.cell is None:
            leaves += [node.below, node.above]
        else:
            division.cells.append(node.cell)
    division.group.extend(_groups(division, covered, exponent))
    return division


def _groups(division: Division, covered: Sequence[Sequence[tuple[Point, Point]]], exponent: int) -> list[int]:
    """Return a number for each cell, the same for neighbours between which a line goes on beyond its segments."""
    root = list(range(len(division.cells)))

    def find(number: int) -> int:
        while root[number] != number:
            root[number] = number = root[root[number]]
        return number

    edges: list[tuple[list[_Interval], list[_Interval]]] = [([], []) for _ in division.lines]
    for number, cell in enumerate(division.cells):
        for k, (label, inner) in enumerate(zip(cell.lines, cell.inner, strict=True)):
            if label > 2:
                a, b = cell.corners[k], cell.corners[(k + 1) % len(cell.corners)]
                edges[label][inner > 0].append((*_along(division.lines[label], a, b, exponent), number))
    for label, (below, above) in enumerate(edges):
        if not (below and above):
            continue
        margin = _CLEAR * max(abs(end) for low, high, _ in below for end in (low, high))
        gaps = _gaps([_along(division.lines[label], *ends, exponent) for ends in covered[label]], margin)
        below.sort()
        above.sort()
        i = j = 0
        while i < len(below) and j < len(above):
            low, high = max(below[i][0], above[j][0]), min(below[i][1], above[j][1])
            if any(min(high, stop) - max(low, start) > margin for start, stop in gaps):
                root[find(below[i][2])] = find(above[j][2])
            if below[i][1] < above[j][1]:
                i += 1
            else:
                j += 1
    return [find(number) for number in range(len(root))]


_Interval = tuple[float, float, int]


def _along(line: Line, a: Point, b: Point, exponent: int) -> tuple[float, float]:
    """Return where on a line two points lie, in order, by the coordinate that changes most."""
    k = 0 if abs(line[1]) >= abs(line[0]) else 1
    p, q = scaled(a[k], a[2], exponent), scaled(b[k], b[2], exponent)
    return (p, q) if p < q else (q, p)


def _gaps(intervals: list[tuple[float, float]], margin: float) -> list[tuple[float, float]]:
    """Return what intervals leave free, grown by a margin."""
    gaps = []
    reached = -inf
    for start, stop in sorted(intervals):
        if start - margin > reached:
            gaps.append((reached, start - margin))
        reached = max(reached, stop + margin)
    return [*gaps, (reached, inf)]


def _split(node: _Node, cell: Cell, label: int, lines: Sequence[Line], crossings: dict[tuple[int, int], Point]) -> None:
    """Cut a cell along a line, if that enters it."""
    line = lines[label]
    sides = [side(line, corner) for corner in cell.corners]
    if min(sides) >= 0 or max(sides) <= 0:
        return
    above, below = Cell([], [], []), Cell([], [], [])
    for k, (corner, edge, way) in enumerate(zip(cell.corners, cell.lines, cell.inner, strict=True)):
        here, there = sides[k], sides[(k + 1) % len(sides)]
        if here > 0 or (here == 0 and there > 0):
            _append(above, corner, edge, way)
        if here < 0 or (here == 0 and there < 0):
            _append(below, corner, edge, way)
        if here == 0:
            _append(*((below, corner, label, -1) if there > 0 else (above, corner, label, 1)))
        elif here * there < 0:
            pair = (edge, label)
            if (crossing := crossings.get(pair)) is None:
                crossing = crossings[pair] = meet(lines[edge], line)
            leaving, entering, inner = (above, below, 1) if here > 0 else (below, above, -1)
            _append(leaving, crossing, label, inner)
            _append(entering, crossing, edge, way)
    node.cell, node.line, node.label, node.above, node.below = None, line, label, _Node(above), _Node(below)


def _append(cell: Cell, corner: Point, line: int, inner: int) -> None:
    cell.corners.append(corner)
    cell.lines.append(line)
    cell.inner.append(inner)
