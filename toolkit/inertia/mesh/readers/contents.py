"""`Contents`: what a reader returns; and what readers share: numbers from text, polygons as fans, names of regions.

A reader is a function from a path to `Contents`. It raises `ReadError` with what is wrong and the remedy; the
path is put in front by `inertia.mesh.read`.
"""

from __future__ import annotations

import contextlib
import io
import re
import warnings
from codecs import BOM_UTF8
from collections.abc import Iterable, Iterator, Sequence
from contextvars import ContextVar
from pathlib import Path, PureWindowsPath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int
from inertia.errors import ReadError
from inertia.mesh.part import Cells, Regions, Rounding
from inertia.mesh.shape import Shape
from inertia.mesh.surface import Facets, Surface
from inertia.mesh.tree import MeshNode
from inertia.mesh.version import refer_to
from inertia.output import note_input
from inertia.records import dataclass
from inertia.units import Unit

UNNAMED = "default"
"""The region of elements that the file puts in none, in a file that names some."""

_AT_ONCE = 1 << 18  # triangles
_BLUR = 2.0**-48  # over its sides, what rounding may turn a triangle by

LINE_LIMIT = 16 * 2**20
"""Bytes in a line of a text file."""

EXPANDED_LIMIT = 100_000_000
"""Triangles that the instances in a scene may make."""

MOST_NODES = 1_000_000
"""Parts and groups that a scene may make, its instances counted."""

_LONE_SIGN = re.compile(rb"[-+](?!\d)")


@dataclass(frozen=True, eq=False)
class Contents:
    """The geometry of a file, the file's own unit (None: it has none), its regions, and notes.

    `chord`, `rounding` and `shape` are those of `Part`; `commented` is the unit that a comment names, and that comment.
    """

    geometry: Facets | Surface | Cells
    unit: Unit | None = None
    regions: Regions | None = None
    notes: tuple[str, ...] = ()
    chord: Float | None = None
    rounding: Rounding | None = None
    shape: Shape | None = None
    commented: tuple[Unit, str] | None = None


@dataclass(frozen=True, eq=False)
class Piece:
    """One instance in a scene: a mesh, placed, its name (None: it has none), and what reading and placing rounded."""

    name: str | None
    vertices: Float
    faces: Int
    rounding: Rounding | None = None


@dataclass(frozen=True, eq=False)
class Layout:
    """The nodes of a scene, and the meshes that they show by name, each once and in its own axes."""

    nodes: list[MeshNode]
    meshes: dict[str, Contents]
    notes: tuple[str, ...] = ()


@contextlib.contextmanager
def quietly(library: str, kind: str) -> Iterator[None]:
    """Keep what a library prints while it reads, and turn whatever it raises (or exits with) into a `ReadError`."""
    printed = io.StringIO()
    try:
        with (
            warnings.catch_warnings(),
            np.errstate(all="ignore"),
            contextlib.redirect_stdout(printed),
            contextlib.redirect_stderr(printed),
        ):
            warnings.simplefilter("ignore")
            yield
    except (ReadError, MemoryError):
        raise
    except ImportError as error:
        raise ReadError(
            f"{library} cannot read it as {kind} without another package ({error}): install it", code="needs_package"
        ) from None
    except (Exception, SystemExit) as error:  # any exception at all may come out of a damaged file
        reason = _reason(error, printed.getvalue())
        raise ReadError(
            f"{library} cannot read it as {kind}{reason and f' ({reason})'}: it is damaged, or of a kind that is not "
            "read; export the mesh again, or as another format"
        ) from None


_NO_NUMBER = re.compile(r"(?s)(?:invalid literal for int|could not convert string to float).*?: '(.*)'")
_NO_OBJECT = re.compile(r"object '(.*)' doesn't exist")
_MISCOUNTED = re.compile(r"reshape array|inhomogeneous|number of columns|got \d+ columns|unmatched data|broadcast")


def _reason(error: BaseException, printed: str) -> str:
    """Return in words what a library that printed and raised this found wrong; "" where it did not say."""
    says = str(error)
    if isinstance(error, SystemExit):
        lines = printed.partition("Error:")[0].strip().splitlines()  # behind it, that the file cannot be read
        says = lines[-1].strip().removeprefix("Warning: ") if lines else ""
    if isinstance(error, KeyError):
        key = str(error.args[0]) if error.args else ""
        return f"{shown(match[1] if (match := _NO_OBJECT.search(key)) else key)} is missing or not known"
    if isinstance(error, IndexError | AttributeError | TypeError | AssertionError | NameError):
        return "something in it is missing or too short"
    if match := _NO_NUMBER.match(says):
        return f"{shown(match[1].removesuffix(chr(92) + 'n'))} stands where a number should"
    if _MISCOUNTED.search(says):
        return "it holds more or fewer numbers than it should"
    return shown(says, 80) if says else ""


_alone: ContextVar[bool] = ContextVar("alone", default=False)


@contextlib.contextmanager
def alone() -> Iterator[None]:
    """Let no file be read beside one in the context: it is a copy of that one only, as out of an archive."""
    before = _alone.set(True)
    try:
        yield
    finally:
        _alone.reset(before)


def beneath(folder: Path, name: str) -> Path:
    """Return the path of a file that a document in `folder` refers to: in that folder or beneath it, links followed.

    A document comes from anywhere, and must not have files read that its author could not: `../../secret`, absolute
    paths, and links that lead out of the folder are refused.
    """
    base = folder.resolve()
    try:
        path = (base / name).resolve()
        outside = not path.is_relative_to(base) or bool(PureWindowsPath(name).drive)
        missing = not outside and not path.is_file()
    except (OSError, RuntimeError, ValueError):  # too long, links in a circle, a zero byte
        outside, missing = False, True
    if outside:
        raise ReadError(
            f"it refers to {shown(name)}, outside its folder, where nothing is read for it: put that file beside it "
            "and export it again",
            code="outside_folder",
        )
    if _alone.get():  # what lies beside the copy is another's
        raise ReadError(
            f"it refers to {shown(name)}, and no other file is read out of an archive, from a URL or beside standard "
            "input: unpack or copy both into one folder",
            code="no_file",
        )
    if missing:
        note_input(base / name)
        raise ReadError(
            f"it needs the file {shown(name)} beside it, which is not there: keep them together", code="no_file"
        )
    refer_to(path, name)
    return path


def text_of(path: Path) -> bytes:
    """Return the bytes of a text file behind its byte order mark, once its lines are of a sensible length."""
    data = path.read_bytes().removeprefix(BOM_UTF8)
    at = 0
    while len(data) - at > LINE_LIMIT:
        end = max(data.rfind(b"\n", at, at + LINE_LIMIT), data.rfind(b"\r", at, at + LINE_LIMIT))
        if end < 0:
            raise ReadError(
                f"the line that begins at byte {at} is longer than {LINE_LIMIT >> 20} MiB, "
                "which no mesh needs: the file is damaged or is not text",
                code="too_large",
            )
        at = end + 1
    return data


def numbers(
    text: bytes, dtype: type[np.float64] | type[np.int64], what: str, rows: Sequence[bytes] = ()
) -> NDArray[Any]:
    """Return the numbers in `text`, separated by white space; `what` names them in the error, or one of `rows`."""
    if not text.strip():
        return np.empty(0, dtype)
    try:
        if dtype is np.int64 and _LONE_SIGN.search(text):  # numpy takes it for a zero
            raise ValueError
        with warnings.catch_warnings():
            # numpy < 2.3 warns, and returns what it could read
            warnings.simplefilter("error", DeprecationWarning)
            return np.fromstring(text, dtype, sep=" ")
    except (ValueError, DeprecationWarning):
        culprit = next((word for word in text.split() if not _is_number(word, dtype)), b"")
        kind = "a number" if dtype is np.float64 else "a whole number"
        row = next((k for k, line in enumerate(rows) if culprit in line.replace(b"/", b" ").split()), None)
        holds = f"{what} hold" if row is None else f"{what} {row} holds"
        raise ReadError(
            f"{holds} {shown(culprit)}, which is not {kind}: export the file again", code="not_a_number"
        ) from None


def _is_number(word: bytes, dtype: type[np.float64] | type[np.int64]) -> bool:
    try:
        (float if dtype is np.float64 else int)(word)
    except ValueError:
        return False
    return b"_" not in word


def shown(value: bytes | str, length: int = 40) -> str:
    """Return text from a file as it may stand in a message: quoted, escaped and cut to `length`."""
    text = value.decode("utf-8", "backslashreplace") if isinstance(value, bytes) else value
    return repr(text if len(text) <= length else text[:length] + "…")


def plural(count: int, what: str) -> str:
    """Return `count` and the noun in the right number: "1 face", "2 faces"."""
    return f"{count} {what}" + ("" if count == 1 else "s")


def was(count: int) -> str:
    """Return the verb for `count` things."""
    return "was" if count == 1 else "were"


def fan(counts: Int, corners: Int) -> tuple[Int, Int]:
    """Split polygons into fans of triangles from their first corner.

    Parameters
    ----------
    counts : (n,) corners of each polygon
    corners : (sum of counts,) vertex indices, polygon after polygon

    Returns
    -------
    (m, 3) faces and (m,) the polygon that each came from
    """
    if (counts < 3).any():
        face = int(np.argmax(counts < 3))
        raise ReadError(f"face {face} has {plural(int(counts[face]), 'corner')}, but a face has at least 3")
    owner = np.repeat(np.arange(len(counts)), counts - 2)
    if len(owner) == len(counts):
        return corners.reshape(-1, 3), owner
    first = (np.cumsum(counts) - counts)[owner]
    step = np.arange(len(owner)) - (np.cumsum(counts - 2) - (counts - 2))[owner]
    return corners[np.stack([first, first + step + 1, first + step + 2], axis=1)], owner


def split_polygons(vertices: Float, counts: Int, corners: Int) -> tuple[Surface, Int, tuple[str, ...]]:
    """Return polygons, given as `fan` takes them, as a checked surface, the polygon of each triangle, and notes."""
    faces, owner = fan(counts, corners)
    if len(faces) > len(counts):
        out = (corners < 0) | (corners >= len(vertices))
        if out.any():  # said of the polygon, as the file counts them
            at = int(np.argmax(out))
            check_indices(corners[at : at + 1, None], len(vertices), "face", int(np.argmax(np.cumsum(counts) > at)))
    faces, notched = around_notches(vertices, faces, owner)
    whole = surface(vertices, faces)
    return whole, owner, (*fan_note(int((counts > 3).sum()), notched), *_unevenness(whole, owner))


def around_notches(vertices: Float, faces: Int, owner: Int) -> tuple[Int, int]:
    """Return the triangles of fans (m, 3), with polygons that their fan leaves split anew, and how many these are.

    Where a corner is reflex, triangles of the fan may fold over each other: their volume is that of the polygon, their
    area is not. Such a polygon is split as it looks along the axis that its normal is nearest to.

    Parameters
    ----------
    owner : (m,), ascending, the polygon of each triangle
    """
    notched, begin = 0, 0
    while begin < len(faces):
        end = int(np.searchsorted(owner, owner[min(begin + _AT_ONCE, len(faces)) - 1], side="right"))
        folded = (
            _folded(vertices[faces[begin:end]], owner[begin:end])
            if owner[end - 1] - owner[begin] < end - begin - 1
            else ()
        )
        for first, last, axis, forward in folded:
            if notched == 0:
                faces = faces.copy()
            rows = slice(begin + first, begin + last)
            corners = np.append(faces[rows][0, :2], faces[rows][:, 2])
            flat = vertices[corners][:, [(axis + 1) % 3, (axis + 2) % 3]]
            anew = _split(flat if forward else flat[:, ::-1])
            if anew.shape == faces[rows].shape:  # else it crosses itself
                faces[rows] = corners[anew]
            notched += 1
        begin = end
    return faces, notched


def _folded(points: Float, owner: Int) -> Iterator[tuple[int, int, int, bool]]:
    """Yield the first triangle and the one behind of each fan that folds over itself, and where its polygon looks."""
    first = np.flatnonzero(np.append(True, owner[1:] != owner[:-1]))
    counts = np.diff(np.append(first, len(owner)))
    with np.errstate(over="ignore", invalid="ignore"):
        one, other = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
        normals = np.cross(one, other)
        whole = np.add.reduceat(normals, first, axis=0)
        each = np.repeat(whole, counts, axis=0)
        along = np.einsum("ij,ij->i", normals, each)
        blur = _BLUR * np.prod([np.linalg.norm(k, axis=1) for k in (one, other, each)], axis=0)
    for k in np.flatnonzero(np.logical_or.reduceat(along < -blur, first) & (counts > 1)).tolist():
        axis = int(np.argmax(np.abs(whole[k])))
        yield int(first[k]), int(first[k] + counts[k]), axis, bool(whole[k, axis] > 0)


def _split(polygon: Float) -> Int:
    """Return the triangles (m, 3) between the corners (n, 2) of a polygon that runs counter-clockwise."""
    from manifold3d import triangulate  # slow to import, and most polygons need none

    return np.asarray(triangulate([np.ascontiguousarray(polygon - polygon[0])]), np.int64)


def _unevenness(whole: Surface, owner: Int) -> tuple[str, ...]:
    """Say by how much the volume depends on the split: each pair of triangles could be that across the other diagonal.

    The two pairs bound a tetrahedron, whose volume is what they differ by.
    """
    pairs = np.flatnonzero(owner[1:] == owner[:-1])
    if not len(pairs):
        return ()
    vertices, faces = whole.vertices, whole.faces
    origin = vertices.mean(axis=0)
    volume = sum(
        float(np.linalg.det(vertices[faces[k : k + _AT_ONCE]] - origin).sum()) for k in range(0, len(faces), _AT_ONCE)
    )
    differs, uneven, first = 0.0, 0, -1
    for k in range(0, len(pairs), _AT_ONCE):
        pair = pairs[k : k + _AT_ONCE]
        sides = vertices[np.column_stack([faces[pair, 1:], faces[pair + 1, 2]])] - vertices[faces[pair, :1]]
        each = np.abs(np.linalg.det(sides))
        far = each > 1e-4 * np.abs(sides).max(axis=(1, 2)) ** 3
        if uneven == 0 and far.any():
            first = int(owner[pair[np.argmax(far)]])
        uneven += len(np.unique(owner[pair[far]]))
        differs += float(each.sum())
    share = differs / abs(volume) if volume else 0.0
    if not (uneven and 1e-4 < share < np.inf):
        return ()
    which = f"face {first} is" if uneven == 1 else f"{uneven} faces, the first being face {first}, are"
    return (
        f"{which} not flat: split along other diagonals the volume would differ by up to about {100 * share:.2g} %, so "
        "export triangles",
    )


def fan_note(split: int, notched: int = 0, how: str = "from the first corner") -> tuple[str, ...]:
    """Return the sentence that says how many polygons were split, if any were, and how many of them otherwise."""
    if not split:
        return ()
    otherwise = f", {notched} of them, which {'is' if notched == 1 else 'are'} not convex, along other diagonals"
    return (
        f"{plural(split, 'face')} with more than three corners {was(split)} split {how}"
        + (otherwise if notched else ""),
    )


def surface(vertices: Float, faces: Int) -> Surface:
    """Return a surface whose indices and coordinates have been checked."""
    if not len(faces):
        raise ReadError(
            "it holds no faces, so there is nothing to weigh: export the part as a surface mesh", code="empty"
        )
    check_indices(faces, len(vertices), "face")
    require_finite(vertices, faces)
    return Surface(vertices, faces)


def require_finite(vertices: Float, faces: Int | None = None) -> None:
    """Raise `ReadError` for a vertex that is not finite, with a face of which it is a corner where these are given."""
    bad = first_bad_point(vertices)
    if bad is not None:
        uses = np.empty(0) if faces is None else np.argwhere(faces == bad)
        where = f" (a corner of face {uses[0][0]})" if len(uses) else ""
        says = f"vertex {bad}{where} is {list(map(float, vertices[bad]))}, not finite: export the mesh again"
        raise ReadError(says, code="non_finite")


def check_indices(nodes: Int, count: int, what: str, first: int = 0) -> None:
    """Raise `ReadError` where an element, counted from `first`, names a vertex that the file does not hold."""
    out = (nodes < 0) | (nodes >= count)
    if out.any():
        row, corner = (int(i) for i in np.argwhere(out)[0])
        extent = f"the vertices are 0 to {count - 1} (counted from 0)" if count else "it has no vertices"
        raise ReadError(
            f"{what} {row + first} names vertex {nodes[row, corner]}, but {extent}: export the mesh again",
            code="node_out_of_range",
        )


def first_bad_point(points: Float) -> int | None:
    """Return the first point with a NaN or infinite coordinate, or None."""
    finite = np.isfinite(points).all(axis=1)
    return None if finite.all() else int(np.argmin(finite))


def label(runs: Iterable[tuple[str | None, int]]) -> Regions | None:
    """Return the regions of elements that come in runs of (name, how many); None where no run has a name."""
    places: dict[str, int] = {}
    index, lengths = [], []
    named = False
    for name, length in runs:
        if length:
            named |= name is not None
            index.append(places.setdefault(UNNAMED if name is None else name, len(places)))
            lengths.append(length)
    if not named:
        return None
    return Regions(tuple(places), np.repeat(np.array(index, np.int32), lengths))


def assemble(pieces: Sequence[Piece]) -> tuple[Surface, Regions | None, Rounding | None]:
    """Return the pieces of a scene as one surface, their names as regions, and what was rounded."""
    if not pieces:
        raise ReadError("it holds no triangle mesh that is part of the scene: export the part as a mesh", code="empty")
    for piece in pieces:
        check_indices(piece.faces, len(piece.vertices), f"{shown(piece.name or 'mesh')}, face")
    first = np.cumsum([0, *(len(piece.vertices) for piece in pieces[:-1])])
    whole = surface(
        np.concatenate([piece.vertices for piece in pieces]),
        np.concatenate([piece.faces + start for piece, start in zip(pieces, first, strict=True)]),
    )
    return whole, label((piece.name, len(piece.faces)) for piece in pieces), _rounding(pieces)


def _rounding(pieces: Sequence[Piece]) -> Rounding | None:
    roundings = [piece.rounding for piece in pieces if piece.rounding is not None]
    if not roundings:
        return None

    def remainder() -> Float:
        parts = []
        for piece in pieces:
            if piece.rounding is None:
                parts.append(np.zeros_like(piece.vertices))
            elif piece.rounding.remainder is not None:
                parts.append(piece.rounding.remainder())
        return np.concatenate(parts)

    known = all(rounding.remainder is not None for rounding in roundings)
    return Rounding(max(rounding.distance for rounding in roundings), remainder if known else None)
