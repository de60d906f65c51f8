"""Bodies of a surface whose shells are soundly nested: that none meet, and each is wound as its depth asks, is shown.

The shells stream by four times at most, triangle by triangle, whatever their number, and only those whose boxes meet
are looked at further:

1. Each gets its box, and its volume, and each run of triangles one after another its box: where few runs come near the
   rays of the second step, their triangles alone are looked at.
2. A ray goes upwards from a place on each that lies in the box of another, and what it crosses is added up: for each
   shell that is crossed its random 64-bit number, as often as it is crossed from inside. The sum names the region that
   the place is in. Just inside a shell it is the sum of this shell, plus or minus its number; so that what a shell is
   next inside is found among those (two of n shells agree by chance with a probability of n²/2⁶⁴ at most).
3. Where a shell lies in another, triangles of the outer one that reach into its box, and whose planes do not pass the
   sphere around it, may meet it.
4. Between shells in one region whose boxes share space, a plane is looked for that holds them apart, or those of their
   triangles that reach into the other's box.
5. Triangles between which none is found, and those of the third step, are compared with each other where they are in
   common cells of space; shells whose triangles may meet are suspects, which `inertia.mesh.check` looks at.

Shells that meet neither those next inside them nor others in their region meet none at all: a connected set that does
not meet a surface lies in one part of the space around it, and so does all that the set encloses.
"""

from __future__ import annotations

import math
import os
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int
from inertia.mesh.geometry.boxes import CELLS
from inertia.mesh.geometry.closure import Closure
from inertia.mesh.geometry.common_cells import MOSTLY, Groups
from inertia.mesh.geometry.edge_fans import layered
from inertia.mesh.geometry.edges import duplicates
from inertia.mesh.geometry.enclosed import FINELY, MEASURE, NOISE, RUN, STORED, Measured, chunks, in_runs, measured
from inertia.mesh.geometry.faces import merge_equal_vertices
from inertia.mesh.geometry.halfedges import half_edges
from inertia.mesh.geometry.touching import FIND, touching_groups
from inertia.mesh.surface import Triangles
from inertia.native import Kernel, address
from inertia.once import once

_MODULE, _PARTING = "inertia.mesh.geometry.shell_kernel", "inertia.mesh.geometry.parting_kernel"
_PLACES = Kernel(_MODULE, "curve_places", "pi" + "dddi" + "ppp")
_SORT = Kernel(_MODULE, "sort_places", "pppii")
_MEET = Kernel(_MODULE, "meet_boxes", "ppppi" + "ppppppp")
_ASK = Kernel(_MODULE, "ask_runs", "pippp" + "ppip" + "i" + "ddddd" + "ppip")
_CAST = Kernel(_MODULE, "cast_rays", "pippi" + "pi" + "ppppp" + "ppip" + "i" + "ddddd" + "pp")
_COPY = Kernel(_PARTING, "copy_shells", "pippi" + "ipipp" + "pppi")
_NEAR = Kernel(_PARTING, "near_children", "pippi" + "pi" + "ppppp" + "pppipi" + "ppp", fused=True)
_PART = Kernel(_PARTING, "part_shells", "pippp" + "ippppi" + "pppi" + "ppppi", fused=True)
_KERNELS = MEASURE, FINELY, _PLACES, _SORT, _MEET, _ASK, _CAST, _NEAR, _COPY, _PART, FIND
_COUNTS = 6, 1 << 11  # as the kernels have them
_FEW = 1 << 12  # shells that numpy sorts in less time than it takes to clear the counts
_MEETS, _INSIDE, _NEARBY, _WHOLE = 1, 2, 8, 16
_BOTH = 3  # of a triangle that may meet others in its region, 1, and shells next inside its own, 2
LOOKS, ANYWAY = 64, 1 << 18  # how often the triangles of a shell are looked at; how many of them in any case
_CLEAR = 2e-10  # of another shell, over the size of the part: what is nearer is not asked by rays
_LEAST_BITS = 3  # so that differences of places are below the kernel's FAR
_IN_RANGE = 100  # powers of two, of sizes whose products are far from the ends of float64
_SPARSE, _SOME = 0.25, 1 << 18  # of triangles, those that are copied to be looked at by themselves; in any case
_LARGE = 1 << 12  # triangles of a shell, of which spheres and boxes around it tell few apart
_SAMPLE, _MANY = 1 << 8, 0.4  # triangles looked at first; the share of them above which all are taken
_POINTS = 2  # in a cell of those by which they are looked up, about


class Nesting(NamedTuple):
    """How the shells of a surface lie in one another, each wound as its depth asks.

    Attributes
    ----------
    parent : (n,), the shell that each is next inside; −1 is none
    depth : (n,), how many shells are around it
    suspects : those that may meet one next inside them, or another beside them, and those of whose material some may
        lie on other material around an edge of more than two triangles; no others meet any, but at such edges
    """

    parent: Int
    depth: Int
    suspects: Int

    @property
    def bodies(self) -> int:
        """How many bodies there are: shells at even depths, with those next inside them, their cavities."""
        return int((self.depth % 2 == 0).sum())


def sound_bodies(triangles: Triangles, closure: Closure, *, streamed: bool = False) -> int | None:
    """Return how many bodies a surface bounds whose shells are soundly nested; None where that is not shown.

    For the arguments see `nesting_of`.
    """
    nesting = sound_nesting(triangles, closure, streamed=streamed)
    return None if nesting is None else nesting.bodies


def sound_nesting(triangles: Triangles, closure: Closure, *, streamed: bool = False) -> Nesting | None:
    """Return the nesting of shells that are soundly nested; None where that is not shown. See `nesting_of`."""
    nesting = nesting_of(triangles, closure, streamed=streamed)
    return None if nesting is None or len(nesting.suspects) else nesting


def nesting_of(triangles: Triangles, closure: Closure, *, streamed: bool = False) -> Nesting | None:
    """Return how shells are nested, where all are wound as their depth asks and few may meet; None otherwise.

    Parameters
    ----------
    triangles : of a closed surface with finite coordinates
    streamed : whether to do without what would hold triangles in memory
    """
    return once(("nesting", streamed), closure, lambda: _nesting(triangles, closure, streamed))


def _nesting(triangles: Triangles, closure: Closure, streamed: bool) -> Nesting | None:
    count = closure.components
    if not count or not all(kernel.worthwhile(triangles.count) for kernel in _KERNELS):
        return None
    if closure.crowded and not len(closure.at_crowded):
        return None
    few = not streamed and count > 1 and triangles.count >= _LARGE * count
    pieces = measured(triangles, closure.labels, count, few=few)
    table = pieces.table
    box, boxes = np.empty((2, 3)), np.empty((count, 6), np.float32)
    places, bits = np.empty(count, np.uint64), max(count.bit_length(), _LEAST_BITS)
    of_places = float(CELLS), NOISE, STORED, bits, address(box), address(boxes), address(places)
    if _PLACES.function(address(table), count, *of_places):
        return None
    size = float((box[1] - box[0]).max())
    if abs(math.frexp(size)[1]) > _IN_RANGE:
        return None
    if count < _FEW:
        places.sort()
    else:
        room, counts = np.empty_like(places), np.zeros(_COUNTS, np.int64)
        _SORT.function(address(places), address(room), address(counts), count, bits)
    order = (places & np.uint64((1 << bits) - 1)).astype(np.int64)
    places >>= np.uint64(bits)
    volume = table[:, 6]
    parent, radii, depth = np.full(count, -1), np.zeros(count), np.zeros(count, np.int64)
    tree = _Boxes.of(table, boxes, order, places, np.zeros(count, np.int64))
    if not tree.flags.any():
        suspects = _layered(triangles, closure, parent, depth) if (volume > 0).all() else None
        return None if suspects is None else Nesting(parent, depth, suspects)
    inner = (tree.flags & _INSIDE).any()
    if streamed and not inner:
        return None
    signs = np.where(volume > 0, 1, -1)
    if inner:
        nest = _nest(triangles, closure, pieces, tree, signs, size, streamed)
        if nest is None:
            return None
        parent, depth, radii = nest
    if ((depth % 2 == 0) != (signs > 0)).any():
        return None
    if inner:
        ranked = np.argsort(parent[order], kind="stable")
        tree = _Boxes.of(table, boxes, order[ranked], places[ranked], parent[order[ranked]])
    suspects = _suspects(triangles, closure, pieces, tree, parent, radii, streamed)
    more = None if suspects is None else _layered(triangles, closure, parent, depth)
    return None if suspects is None or more is None else Nesting(parent, depth, np.union1d(suspects, more))


def _layered(triangles: Triangles, closure: Closure, parent: Int, depth: Int) -> Int | None:
    """Return the shells some of whose material may lie on other material at edges; None where triangles are copies."""
    which = closure.at_crowded
    if len(which) == 0:
        return which
    shell = closure.labels[which].astype(np.int64)
    vertices, faces = merge_equal_vertices(triangles.select(which))
    if len(duplicates(faces)[0]):
        return None
    edges, body = half_edges(faces), np.where(depth[shell] % 2 == 1, parent[shell], shell)
    may = layered(vertices, faces, edges, body, np.zeros(len(faces), bool))
    return np.unique(shell[may[edges.edge].reshape(-1, 3).any(axis=1)])


class _Boxes(NamedTuple):
    """The boxes of shells, those in order with enclosing ones, and what they do to others of their family.

    Attributes
    ----------
    order : (n,), the shells family by family, along a space-filling curve in each
    flags : (n,), what the box of each does to others
    boxes, nodes : as `meet_boxes` leaves them
    zones : around what each that meets others has in common with their boxes
    spots : around the places on those shells whose boxes lie in that of each that holds others
    """

    order: Int
    flags: NDArray[np.uint8]
    boxes: NDArray[np.float32]
    nodes: NDArray[np.int32]
    zones: Float
    spots: Float

    @classmethod
    def of(
        cls, table: Float, single: NDArray[np.float32], order: Int, places: NDArray[np.uint64], family: Int
    ) -> _Boxes:
        """Enclose the boxes of shells; `places` along the curve, and families, are those of the shells in order."""
        count = len(order)
        boxes, nodes = np.empty((2 * count, 6), np.float32), np.empty((2 * count, 2), np.int32)
        stack, flags, (zones, spots) = np.empty((512, 2), np.int64), np.zeros(count, np.uint8), np.empty((2, count, 6))
        tables = map(address, (family, boxes, nodes, stack, flags, zones, spots))
        _MEET.function(*map(address, (table, single, order, places)), count, *tables)
        return cls(order, flags, boxes, nodes, zones, spots)


def _nest(
    triangles: Triangles,
    closure: Closure,
    pieces: Measured,
    tree: _Boxes,
    signs: Int,
    size: float,
    streamed: bool,
) -> tuple[Int, Int, Float] | None:
    """Return what shell each is next inside (−1 is none), how many are around it, and the squares of their radii."""
    table = pieces.table
    count = len(table)
    inner = np.flatnonzero(tree.flags & _INSIDE)
    points = table[inner, 8:11]
    corner, extent = points[:, :2].min(axis=0), np.ptp(points[:, :2], axis=0)
    across = max(int(np.sqrt(len(inner) / _POINTS)), 1)
    steps = np.divide(across, extent, out=np.zeros(2), where=extent > 0)
    cell = np.minimum(((points[:, :2] - corner) * steps).astype(np.int64), across - 1)
    cell = cell[:, 1] * across + cell[:, 0]
    ranked = np.argsort(cell, kind="stable")
    whose, points = inner[ranked], points[ranked]
    cells = np.searchsorted(cell[ranked], np.arange(across * across + 1))
    numbers = np.frombuffer(os.urandom(8 * count), np.int64).copy()
    sums, depth, radii = np.zeros(count, np.int64), np.zeros(count, np.int64), np.zeros(count)
    grid = *corner.tolist(), *steps.tolist(), _CLEAR * size
    of_points = address(points), address(whose), len(whose), address(cells), across, *grid
    runs, asked = len(pieces.shell), np.empty(len(pieces.shell), np.uint8)
    of_runs = address(pieces.boxes), address(pieces.shell), runs, address(asked)
    _ASK.function(address(table), count, *map(address, (tree.flags, tree.spots, radii)), *of_points, *of_runs)
    own, labels = triangles, closure.labels
    if RUN * np.count_nonzero(asked) < (_SOME if streamed else _SPARSE * triangles.count):
        which = in_runs(asked, RUN, triangles.count)
        own, labels = triangles.select(which), labels[which]
    of_shells = [address(each) for each in (tree.flags, tree.spots, signs, numbers, radii)]
    for _, *chunk in chunks(own, labels):
        if _CAST.function(*chunk, address(table), count, *of_shells, *of_points, address(sums), address(depth)):
            return None
    regions = sums + signs * numbers  # just inside each, modulo 2^64
    ranked = np.argsort(regions)
    at = np.minimum(np.searchsorted(regions[ranked], sums), count - 1)
    parent = np.where(sums == 0, -1, ranked[at])
    if (regions[parent] != sums)[parent >= 0].any() or (depth[parent] + 1 != depth)[parent >= 0].any():
        return None
    return parent, depth, radii


def _suspects(
    triangles: Triangles,
    closure: Closure,
    pieces: Measured,
    tree: _Boxes,
    parent: Int,
    radii: Float,
    streamed: bool,
) -> Int | None:
    """Return the shells that may meet one next inside them or another in their region; None where these are many."""
    table, boxes = pieces.table, pieces.few if len(pieces.few) else None
    count, order, none = len(table), tree.order, np.empty(0, np.int64)
    near = np.zeros(triangles.count, np.uint8)
    if (parent >= 0).any():
        near = _near_children(triangles, closure, table, tree, parent, radii, streamed)
    if not (tree.flags & (_MEETS | _NEARBY)).any():
        return none
    if streamed:
        return None
    meeting, within = _unparted(triangles, closure, table, tree, parent)
    nearby = (tree.flags & _NEARBY) != 0
    if nearby.any():
        within |= np.append(nearby, False).astype(np.uint8).take(closure.labels)  # the last is that of those in none
        meeting |= nearby
    # Each region is a family of its own: the shell around it, as far as it is near, and what meets there in it.
    base = np.arange(1, count + 1) * (count + 1)
    place = np.empty(count, np.int64)
    place[order] = np.arange(1, count + 1) + (parent[order] + 1) * (count + 1)
    shells = np.unique(parent[nearby])
    keys = np.concatenate([place[meeting], base[shells]])
    ranked = np.argsort(keys)
    keys, whose = keys[ranked], np.concatenate([np.flatnonzero(meeting), shells])[ranked]
    own, labels, role = triangles, closure.labels, within | near << np.uint8(1)
    if (role == _BOTH).any():
        both = np.flatnonzero(within), np.flatnonzero(near)
        which, role = np.concatenate(both), np.repeat(np.array([1, 2], np.uint8), [len(each) for each in both])
        own, labels, boxes = triangles.select(which), labels[which], None
    elif np.count_nonzero(role) < MOSTLY * triangles.count:
        which = np.flatnonzero(role)
        own, labels, role, boxes = triangles.select(which), labels[which], role[which], None
    # What is not asked for is a family of its own.
    numbers = np.full((3, count + 1), len(keys))
    numbers[1, 1:], numbers[2, 1:] = np.searchsorted(keys, place), np.searchsorted(keys, base)
    family = np.append(keys // (count + 1), count + 1)
    pairs = touching_groups(own, Groups(labels, role, numbers), family, boxes=boxes, stop=True)
    return None if pairs is None else np.unique(whose[pairs])


def _near_children(
    triangles: Triangles, closure: Closure, table: Float, tree: _Boxes, parent: Int, radii: Float, streamed: bool
) -> NDArray[np.uint8]:
    """Say which triangles may meet a shell next inside their own, and flag these; where most may, all are taken."""
    labels = closure.labels
    ranges = np.searchsorted(parent[tree.order], np.arange(len(table))[:, None] + (0, 1))
    of_shells = address(table), len(table), *map(address, (radii, tree.boxes, tree.nodes, tree.order, ranges))

    def asked(
        some: Triangles, of: NDArray[np.int32], flags: NDArray[np.uint8], near: NDArray[np.uint8], copies: _Copies
    ) -> NDArray[np.uint8]:
        room, again = np.empty(512, np.int64), int(copies is not none)
        patience = np.where(copies.ends > copies.starts, LOOKS * (copies.ends - copies.starts) + ANYWAY, 0)
        for which, *chunk in chunks(some, of):
            of_result = near[which].ctypes.data, address(flags), address(room)
            _NEAR.function(*chunk, *of_shells, *copies.places, address(patience), again, *of_result)
        return near

    none = _Copies.of(np.zeros(len(table), np.int64))
    few = np.arange(0, triangles.count, triangles.count // _SAMPLE + 1)
    if triangles.count >= _LARGE * len(table):
        sample = asked(triangles.select(few), labels[few], tree.flags.copy(), np.zeros(len(few), np.uint8), none)
        if sample.mean() >= _MANY:
            tree.flags[parent >= 0] |= _NEARBY
            holds = np.append(ranges[:, 0] < ranges[:, 1], False).astype(np.uint8)  # the last is of those in none
            return holds.take(labels)
    near = asked(triangles, labels, tree.flags, np.zeros(triangles.count, np.uint8), none)
    small = ((tree.flags & _NEARBY) != 0) & (table[:, 11] <= _LARGE)
    if streamed or not small.any():
        return near
    copies = _Copies.of(np.where(small, table[:, 11], 0).astype(np.int64))
    copies.fill(triangles, labels, table, np.where(small, _MEETS, 0).astype(np.uint8), table[:, :6].copy())
    tree.flags[:] &= ~np.uint8(_NEARBY)
    return asked(triangles, labels, tree.flags, near, copies)


class _Copies(NamedTuple):
    """Room for the triangles of some shells, shell by shell, as float32.

    Attributes
    ----------
    starts, ends : (m,), where those of each shell are
    numbers : (k,), which they are
    points : (3, 3 k), their corners about the middle of the box of their shell
    """

    starts: Int
    ends: Int
    numbers: Int
    points: NDArray[np.float32]

    @classmethod
    def of(cls, counts: Int) -> _Copies:
        """Return room for so many triangles (m,) of each shell."""
        starts, slots = np.cumsum(counts) - counts, max(int(counts.sum()), 1)  # of no room there is no address
        return cls(starts, starts.copy(), np.empty(slots, np.int64), np.empty((3, 3 * slots), np.float32))

    @property
    def slots(self) -> int:
        """How many triangles there is room for."""
        return len(self.numbers)

    @property
    def places(self) -> tuple[int, int, int, int]:
        """What kernels take of where which points are."""
        return address(self.starts), address(self.ends), address(self.points), self.slots

    def fill(
        self, triangles: Triangles, labels: NDArray[np.int32], table: Float, flags: NDArray[np.uint8], zones: Float
    ) -> None:
        """Copy the triangles in the zones of shells that are flagged as meeting others."""
        of_copies = *map(address, (flags, zones, self.ends, self.numbers, self.points)), self.slots
        for part, *chunk in chunks(triangles, labels):
            _COPY.function(*chunk, part.start, address(table), len(table), *of_copies)


def _unparted(
    triangles: Triangles, closure: Closure, table: Float, tree: _Boxes, parent: Int
) -> tuple[Bool, NDArray[np.uint8]]:
    """Return the shells that may meet others in their region, and which triangles they may do it with."""
    count = len(table)
    counts = np.where(tree.flags & _MEETS, table[:, 11], 0).astype(np.int64)
    flags, within = np.zeros(count, np.uint8), np.zeros(triangles.count, np.uint8)
    if not counts.any():
        return flags != 0, within
    copies = _Copies.of(counts)
    copies.fill(triangles, closure.labels, table, tree.flags, tree.zones)
    starts, ends, numbers, points = copies
    last, most = 2 * count - len(np.unique(parent)), int((ends - starts).max())
    if not most:
        return flags != 0, within
    spare, which = np.empty((6, 3 * most), np.float32), np.empty((2, most), np.int64)
    patience, work, stack = LOOKS * counts + ANYWAY, np.empty((8, 3)), np.empty((512, 2), np.int64)
    of_tree = address(tree.order), address(tree.boxes), address(tree.nodes), last
    of_points = address(starts), address(ends), address(numbers), address(points), copies.slots
    room = address(patience), address(spare), address(which), most, address(work), address(stack)
    _PART.function(address(table), count, *of_tree, *of_points, *room, address(flags), address(within), triangles.count)
    whole = (flags & _WHOLE) != 0
    if whole.any():
        within |= whole[closure.labels] & (closure.labels >= 0)
    return (flags & _MEETS) != 0, within
