"""`Report` on a part and the `Finding`s in it, the evidence that they rest on, and how counts and places are worded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Literal

import numpy as np

from inertia.arrays import Float, Int, Orientation
from inertia.errors import CHECK, UNION, GeometryError, Remedy, Sentence, Word
from inertia.mesh.doubt import Doubt
from inertia.mesh.geometry.edges import Loop, Place
from inertia.mesh.geometry.shells import Shell
from inertia.mesh.part import Source
from inertia.records import dataclass

Severity = Literal["error", "warning", "note"]

_LISTED = 10
_HOWEVER_TURNED = ", however its shells are turned: move the bodies apart, or use "


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong with a part, or worth knowing of it.

    Attributes
    ----------
    code : what kind of finding it is
    severity : "error" (no honest volume can be had), "warning" (look at it) or "note"
    message : one sentence: what, how much, where, and the remedy
    count : how many there are
    faces : numbers of the first ten triangles (or cells) concerned
    place : where the first or largest is, in file units
    turnable : True where turning shells to their absolute orientation removes it
    separable : True where integrating each body by itself removes it
    statement : the sentence without the remedy
    doubt : the volume that is in doubt for it, where it leaves an answer
    """

    code: str
    severity: Severity
    message: str
    count: int
    faces: tuple[int, ...] = ()
    place: Place | None = None
    turnable: bool = False
    separable: bool = False
    statement: str = ""
    doubt: Doubt | None = None

    @property
    def remedies(self) -> tuple[Remedy, ...]:
        """What to ask for instead, where that is an argument or a verb."""
        return Sentence(self.message).remedies


@dataclass(frozen=True)
class Report:
    """The state of a part.

    Attributes
    ----------
    source : where the part came from
    triangles : number of triangles (cells, for a mesh of cells)
    vertices : number of different vertices that they use; 0 where a coordinate is not usable, and nothing else was
        examined: what follows is False, None, 0 or empty then
    closed : every edge is used an even number of times
    consistent : every edge is used both ways equally often, as far as that number allows
    outward : True where every shell is wound as its depth asks, False where every one is wound against it,
        None where the surface does not bound a volume, or some are and some are not
    bodies : number of bodies; of separate pieces, where the surface does not bound a volume
    shells : of a surface that bounds a volume
    loops : rims of the holes, the longest first
    findings : errors first, the most important first
    crossings_examined : whether triangles of one shell that cross each other were looked for
    """

    source: Source
    triangles: int
    vertices: int
    closed: bool
    consistent: bool
    outward: bool | None
    bodies: int
    shells: tuple[Shell, ...]
    loops: tuple[Loop, ...]
    findings: tuple[Finding, ...]
    crossings_examined: bool = False

    @property
    def fit(self) -> bool:
        """Whether the volume as stored is an honest one: there is no error."""
        return not self.faults()

    @property
    def state(self) -> tuple[str, ...]:
        """How many elements, vertices and bodies there are, and how they are wound, in words."""
        if self.vertices == 0:  # there are none, or a coordinate is not usable
            return counted(self.triangles, "element"), *(("nothing else examined",) if self.triangles else ())
        facing = {True: ("facing outward",), False: ("facing inward",), None: ()}[self.outward]
        return (
            counted(self.triangles, "element"),
            counted(self.vertices, "vertex", "vertices"),
            "closed" if self.closed else "open",
            "consistently wound" if self.consistent else "wound inconsistently",
            *facing,
            counted(self.bodies, "body", "bodies"),
            "crossings examined" if self.crossings_examined else "crossings not examined",
        )

    def _repr_html_(self) -> str:
        """Return a small table with what was found, as a notebook shows it."""
        from inertia.notebook import html_of

        faults = counted(len(self.faults()), "fault")
        rows = [
            ("Check", self.source.path or "part"),
            ("Verdict", "fit for integration" if self.fit else f"not fit for integration: {faults}"),
            ("Mesh", ", ".join(self.state)),
        ]
        return html_of([*rows, *((each.severity.capitalize(), str(each.message)) for each in self.findings)])

    @property
    def doubts(self) -> tuple[Finding, ...]:
        """What leaves an answer, but some of its volume in doubt."""
        return tuple(f for f in self.findings if f.doubt is not None)

    def faults(self, orientation: Orientation = "stored") -> tuple[Finding, ...]:
        """Return the errors; `"absolute"` leaves out those that turning the shells removes."""
        forgiven = orientation == "absolute"
        return tuple(f for f in self.findings if f.severity == "error" and not (forgiven and f.turnable))

    def require_fit(self, orientation: Orientation = "stored", *, turned: bool = False) -> None:
        """Raise `GeometryError` with the most important fault, if there is one; where shells are `turned`, say so."""
        faults = self.faults(orientation)
        if faults:
            others = len(faults) - 1
            more = (" (", CHECK, f" lists {counted(others, 'more fault')})") if others else ()
            message: tuple[Word, ...] = (faults[0].message,)
            if turned and faults[0].turnable:
                message = (faults[0].statement, _HOWEVER_TURNED, UNION)
            raise GeometryError(*message, *more, places=(self.source.path or "the part",), code=faults[0].code)


@dataclass(frozen=True)
class Evidence:
    """What shows that something is wrong with a part.

    Attributes
    ----------
    count : how many there are
    faces : numbers of the first ten triangles (or cells) concerned
    place : where the first or largest is, in file units
    figures : more that the sentence states, by name
    advice : what to do in this very case, before what the kind advises
    doubt : the volume that is in doubt
    """

    count: int
    faces: tuple[int, ...] = ()
    place: Place | None = None
    figures: Mapping[str, object] = field(default_factory=dict)
    advice: tuple[Word, ...] = ()
    doubt: Doubt | None = None


def listed(which: Int) -> tuple[int, ...]:
    """Return the first ten numbers."""
    return tuple(which[:_LISTED].tolist())


def middle(points: Float) -> Place:
    """Return the mean of points (k, 3)."""
    x, y, z = points.mean(axis=0).tolist()
    return x, y, z


def counted(count: int, noun: str, plural: str | None = None) -> str:
    """Return a count in words.

    >>> counted(1, "body", "bodies"), counted(2, "edge")
    ('1 body', '2 edges')
    """
    return f"{count} {noun if count == 1 else plural or noun + 's'}"


def around(place: Place, box: Float) -> str:
    """Return a place in words, to a ten-thousandth of the size of the part's box (2, 3).

    >>> around((31.00000001, -1e-9, 5.5), np.array([[0, 0, 0], [40, 1, 10]]))
    'around (31.0, 0.0, 5.5)'
    """
    size = float(np.max(box[1] - box[0]))
    digits = 4 - int(np.floor(np.log10(size))) if size > 0 else 16
    return f"around ({', '.join(repr(round(value, digits) + 0.0) for value in place)})"
