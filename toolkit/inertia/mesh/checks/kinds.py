"""The kinds of findings of `inertia.mesh.check`, in one table: code, severity, evidence, sentence and remedy of each.

A sentence names in braces what the evidence holds: `{count:edge}` is the count with its noun, `{first}` and `{second}`
are the first two triangles (or cells), `{around}` is the place in words, other names are its figures.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from inertia.errors import ABSOLUTE, REPAIR, SHELL, UNION, WELD, Sentence, Word
from inertia.mesh.checks.cells import CellTopology
from inertia.mesh.checks.crossings import (
    contacts,
    crossing_cavities,
    cutters,
    overlap_at_edges,
    overlapping_bodies,
    self_intersections,
)
from inertia.mesh.checks.doubled_cells import shared_space
from inertia.mesh.checks.findings import Evidence, Finding, Severity, counted, listed, middle
from inertia.mesh.checks.surface_topology import SurfaceTopology
from inertia.mesh.doubt import Doubt
from inertia.mesh.geometry.edges import flat
from inertia.mesh.geometry.faces import repeated_corners
from inertia.mesh.geometry.shells import Shell
from inertia.mesh.repairs.weld import closing_distance
from inertia.mesh.surface import Surface, Triangles, usable
from inertia.records import dataclass

Subject = Literal[
    "triangles", "surface", "volume", "shells", "crossings", "contacts", "nodes", "cells", "maps", "sides", "space"
]
"""What is looked at: `Triangles`; `SurfaceTopology`, whole, where it bounds a volume, where that is one, where
crossings are looked for, where there is no fault; `CellTopology`, before and after its nodes are known to be usable,
and then, as long as there is no error, the cells' maps, the sides of faces that they lie on, and the space they share.
"""

_CHUNK = 1 << 16
_NOISE = 1e-13  # volume over the sum of the shells' volumes
_COLLAPSED = 0.1  # share of the edges that a weld which is advised may shrink to points, about


@dataclass(frozen=True)
class Kind:
    """A kind of finding: what shows it, and what is said of it.

    Attributes
    ----------
    subject : what `evidence` is asked about
    code, severity : see `Finding`
    evidence : returns what shows it; None where all is well
    sentence : what, how much, where
    remedy : what to do about it, in words and arguments; () where nothing needs to be done
    separable : whether it is no fault where each body is integrated by itself
    doubtful : the sentence where the evidence is of so little volume that it is only in doubt, and a warning
    """

    subject: Subject
    code: str
    severity: Severity
    evidence: Callable[[Any], Evidence | None]
    sentence: str
    remedy: tuple[Word, ...] = ()
    separable: bool = False
    doubtful: str = ""

    def finding(self, subject: Triangles | SurfaceTopology | CellTopology) -> Finding | None:
        """Return the finding of this kind, if there is evidence of it."""
        known = subject.evidence if isinstance(subject, SurfaceTopology) else {}
        if self.evidence not in known:
            known[self.evidence] = self.evidence(subject)
        evidence = known[self.evidence]
        if evidence is None:
            return None
        if isinstance(subject, SurfaceTopology):
            evidence = subject.as_numbered(evidence)
        figures = {"count": _Count(evidence.count), **evidence.figures}
        figures |= zip(("first", "second"), evidence.faces, strict=False)
        if evidence.place is not None and isinstance(subject, SurfaceTopology | CellTopology):
            figures["around"] = subject.around(evidence.place)
        remedy = (": ", *evidence.advice, *self.remedy) if self.remedy else ()
        statement, severity = self.sentence, self.severity
        if self.doubtful and evidence.doubt is not None:
            statement, severity, remedy = self.doubtful, "warning", ()
        statement = statement.format_map(figures)
        message = Sentence(statement, *remedy)
        turnable = ABSOLUTE in self.remedy
        return Finding(
            self.code,
            severity,
            message,
            evidence.count,
            evidence.faces,
            evidence.place,
            turnable,
            self.separable,
            statement,
            evidence.doubt,
        )


def findings(
    subject: Subject, part: Triangles | SurfaceTopology | CellTopology, *, separate: bool = False
) -> Iterator[Finding]:
    """Yield what there is to say about a subject, in the order of the table; of `separate` bodies, the rest."""
    kinds = (kind for kind in KINDS if kind.subject == subject and not (separate and kind.separable))
    return (finding for kind in kinds if (finding := kind.finding(part)))


class _Count(int):
    """A number that is written with a noun: `{count:edge}`, `{count:vertex|vertices}`."""

    def __format__(self, noun: str) -> str:
        return counted(self, *noun.split("|")) if noun else str(int(self))


def _unusable(triangles: Triangles) -> Evidence | None:
    chunks = range(0, triangles.count, _CHUNK)
    wrong = [~usable(triangles.corners(start, start + _CHUNK)).all(axis=(1, 2)) for start in chunks]
    which = np.flatnonzero(np.concatenate(wrong))
    return Evidence(len(which), listed(which)) if len(which) else None


def _holes(surface: SurfaceTopology) -> Evidence | None:
    if not surface.loops:
        return None
    longest, count = surface.loops[0], len(surface.loops)
    figures = {
        "longest": "the longest " if count > 1 else "",
        "length": longest.length,
        "unit": surface.unit,
        "triangle": longest.triangle,
    }
    triangles = listed(np.array([loop.triangle for loop in surface.loops]))
    return Evidence(count, triangles, longest.place, figures, _crack(surface))


def _crack(surface: SurfaceTopology) -> tuple[Word, ...]:
    if not surface.whole:
        return ()
    edges = surface.edges
    surplus = edges.forward - edges.backward
    distance = closing_distance(surface.triangles, surface.vertices, edges.ends, surplus, _COLLAPSED)
    if distance is None:
        return ()
    return "use ", WELD._replace(value=distance), f" (the least distance, in {surface.unit}, that closes it), "


def _unused(surface: SurfaceTopology) -> Evidence | None:
    if not isinstance(surface.triangles, Surface):
        return None
    used = np.zeros(len(surface.triangles.vertices), bool)
    used[surface.triangles.faces] = True
    unused = np.flatnonzero(~used)
    return Evidence(len(unused), figures={"vertex": unused[0]}) if len(unused) else None


def _no_volume(surface: SurfaceTopology) -> Evidence | None:
    solids = [shell for shell in surface.shells if shell.kind != "sheet"]
    volumes = [shell.signed_volume for shell in solids]
    turned = [(-1) ** shell.depth * abs(shell.signed_volume) for shell in solids]
    # The second sum tells a wall of no thickness from two bodies of which one is inside out.
    if max(abs(sum(volumes)), abs(sum(turned))) > _NOISE * sum(map(abs, volumes)):
        return None
    if len(solids) > 1 and not surface.cancels():
        return None
    return Evidence(surface.count, listed(np.arange(surface.count)), middle(surface.box))


def _sheets(surface: SurfaceTopology) -> Evidence | None:
    slivers = surface.slivers
    sheets = [shell for shell in surface.in_state("sheet") if shell not in slivers]
    return surface.at_shells(sheets) if len(sheets) < len(surface.shells) else None


def _inward(surface: SurfaceTopology) -> Evidence | None:
    if surface.outward is not False:
        return None
    return surface.at_shells(surface.in_state("inverted"), (shell.signed_volume for shell in surface.shells))


def _inverted(surface: SurfaceTopology) -> Evidence | None:
    return surface.at_shells(surface.in_state("inverted")) if surface.outward is not False else None


def _slivers(surface: SurfaceTopology) -> Evidence | None:
    evidence = surface.at_shells(surface.slivers, (abs(shell.signed_volume) for shell in surface.slivers))
    return evidence and replace(evidence, doubt=Doubt.joined(map(_either_way, surface.slivers)))


def _either_way(shell: Shell) -> Doubt:
    """Return what it does to the volume to turn a shell or to leave it out."""
    twice = 2 * abs(shell.signed_volume)
    return Doubt.within(shell.box, twice if shell.signed_volume < 0 else 0.0, twice if shell.signed_volume > 0 else 0.0)


def _doubled_cavities(surface: SurfaceTopology) -> bool:
    """Say whether a cavity lies where material counts twice: then what is around it is no cavity, however turned."""
    return any(shell.kind == "inward" for shell in surface.in_state("overlapping"))


def _several_bodies(surface: SurfaceTopology) -> Evidence | None:
    outer = [surface.shells[body.shells[0]] for body in surface.bodies]
    return surface.at_shells(outer) if len(outer) > 1 else None


def _cavities(surface: SurfaceTopology) -> Evidence | None:
    cavities = [surface.shells[number] for body in surface.bodies for number in body.shells[1:]]
    return surface.at_shells(cavities, (abs(shell.signed_volume) for shell in cavities))


KINDS = (
    Kind(
        "triangles", "empty", "error",
        lambda triangles: None if triangles.count else Evidence(0),
        "there are no triangles",
        ("export the part again",),
    ),
    Kind(
        "triangles", "non_finite", "error",
        _unusable,
        "{count:triangle} with a coordinate that is no usable number (NaN, infinite or beyond 1e75), the first being "
        "triangle {first}",
        ("export the part again",),
    ),
    Kind(
        "surface", "open", "error",
        _holes,
        "open: {count:boundary loop}, {longest}{length:.4g} {unit} {around} at triangle {triangle}",
        ("close the mesh, or use ", SHELL, " or ", REPAIR),
    ),
    Kind(
        "surface", "inconsistent_winding", "error",
        lambda surface: surface.at_edges(surface.edges.inconsistent),
        "inconsistent winding: the two triangles at {count:edge} run the same way, the first being triangles {first} "
        "and {second} {around}",
        ("turn the wrong ones, or use ", REPAIR),
    ),
    Kind(
        "surface", "duplicate_face", "error",
        lambda surface: surface.at_faces(surface.duplicates[0]),
        "{count:triangle} stored again with the same winding, the first being triangle {first} {around}",
        ("remove the copies, or use ", REPAIR),
    ),
    Kind(
        "surface", "non_manifold_edge", "error",
        lambda surface: surface.at_edges(surface.edges.non_manifold & ~surface.edges.balanced),
        "three or more triangles that do not pair up share {count:edge}, the first {around} at triangle {first}",
        ("remove inner walls and fins, or use ", REPAIR),
    ),
    Kind(
        "surface", "duplicate_face", "warning",
        lambda surface: surface.at_faces(surface.duplicates[1]),
        "{count:triangle} stored again with the opposite winding, the first being triangle {first} {around}",
        ("look whether bodies should touch there or a wall has no thickness",),
    ),
    Kind(
        "surface", "non_manifold_edge", "warning",
        lambda surface: surface.at_edges(surface.edges.non_manifold & surface.edges.balanced),
        "four or more triangles share {count:edge}, the first {around} at triangle {first}",
        ("the volume is not affected, but look whether bodies should touch there",),
    ),
    Kind(
        "surface", "degenerate_face", "warning",
        lambda surface: surface.at_faces(np.flatnonzero(repeated_corners(surface.faces))),
        "{count:triangle} with a repeated corner, the first being triangle {first} {around}",
        ("the volume is not affected, and ", REPAIR, " removes them"),
    ),
    Kind(
        "surface", "degenerate_face", "warning",
        lambda surface: surface.at_faces(np.flatnonzero(flat(surface.vertices, surface.faces))),
        "{count:triangle} without area (the corners lie on a line), the first being triangle {first} {around}",
        ("the volume is not affected, and ", REPAIR, " removes them"),
    ),
    Kind(
        "surface", "unused_vertices", "note",
        _unused,
        "{count:vertex|vertices} that no triangle uses, the first being vertex {vertex}",
    ),
    Kind(
        "volume", "zero_volume", "error",
        _no_volume,
        "no volume: the surface {around} folds back on itself everywhere",
        ("use ", SHELL, " (half of it, as both sides count), or export a solid"),
    ),
    Kind(
        "shells", "inward", "error",
        _inward,
        "inside out: every triangle faces inward and the volume is {volume:.4g} {unit}³ {around}",
        ("turn all triangles, or use ", ABSOLUTE),
    ),
    Kind(
        "shells", "overlapping_bodies", "error",
        cutters,
        "overlapping bodies: {at_least}{count:pair} of bodies, one of each facing inward, share space, the first "
        "{around} being those from triangles {first} and {second} on, as a cavity that sticks out does, or a body "
        "stored inside out",
        ("cut or unite them where the part was made, or use ", UNION, " to cut out what faces inward"),
    ),
    Kind(
        "shells", "inverted_body", "error",
        _inverted,
        "{count:shell} inside out beside others that are not, the first {around} from triangle {first} on",
        ("turn its triangles, or use ", ABSOLUTE),
    ),
    Kind(
        "shells", "overlapping_bodies", "error",
        overlap_at_edges,
        "overlapping bodies: material lies on material around {count:edge} that more than two triangles share, the "
        "first {around} at triangle {first}, so that it counts twice",
        ("move the bodies apart, or use ", UNION),
    ),
    Kind(
        "shells", "overlapping_bodies", "error",
        lambda surface: surface.at_shells(surface.in_state("overlapping")) if _doubled_cavities(surface) else None,
        "overlapping bodies: {count:shell} inside another of the same orientation, cavities among them, the first "
        "{around} from triangle {first} on, so that the inside counts twice",
        ("use ", UNION),
        separable=True,
    ),
    Kind(
        "shells", "overlapping_bodies", "error",
        lambda surface: None if _doubled_cavities(surface) else surface.at_shells(surface.in_state("overlapping")),
        "overlapping bodies: {count:shell} inside another of the same orientation, the first {around} from triangle "
        "{first} on, so that the inside counts twice",
        ("use ", UNION, " to count it once, or ", ABSOLUTE, " to make it a cavity"),
        separable=True,
    ),
    Kind(
        "shells", "overlapping_bodies", "error",
        overlapping_bodies,
        "overlapping bodies: {at_least}{count:pair} of bodies share space, the first {around} being those from "
        "triangles {first} and {second} on, so that it counts twice",
        ("move them apart, or use ", UNION),
        separable=True,
    ),
    Kind(
        "shells", "overlapping_bodies", "error",
        crossing_cavities,
        "crossing cavities: {count:pair} of triangles of different shells of one body cross, the first {around} being "
        "triangles {one} and {other}, so that a cavity takes away what is not there",
        ("unite the cavities, close the wall, or use ", UNION),
    ),
    Kind(
        "crossings", "self_intersection", "error",
        self_intersections,
        "self-intersection: {at_least}{count:pair} of triangles cross, the first {around} being triangles {one} and "
        "{other}, so that what is enclosed twice counts twice{doubt}",
        ("use ", UNION),
        doubtful="self-intersection: {count:pair} of triangles cross, the first {around} being triangles {one} and "
        "{other}, but what that encloses more than once {within}: up to {volume:.2g} {unit}³, which is in the bounds",
    ),
    Kind(
        "shells", "zero_volume", "warning",
        _sheets,
        "{count:shell} without volume beside the bodies, the first {around} from triangle {first} on",
        ("remove what adds no mass, or give it a thickness",),
    ),
    Kind(
        "shells", "sliver", "warning",
        _slivers,
        "sliver: {count:shell} of {volume:.2g} {unit}³ in all wound against what is around, the first {around} from "
        "triangle {first} on: counted or not, that is in the bounds",
    ),
    Kind(
        "contacts", "contact", "note",
        lambda surface: None if surface.separate else contacts(surface),
        "contact: {count:pair} of bodies share space no deeper than the contact tolerance ({tolerance:g} of the "
        "smaller body) or of less than {least:g} of the volume, the first {around} being those from triangles {first} "
        "and {second} on, so that up to {volume:.2g} {unit}³ count twice: that is in the bounds",
    ),
    Kind(
        "contacts", "shared_space", "warning",
        lambda surface: contacts(surface) if surface.separate else None,
        "shared space: {count:pair} of bodies share up to {volume:.2g} {unit}³, the first {around} being those from "
        "triangles {first} and {second} on: each is integrated by itself, so that this counts twice and is in the "
        "bounds",
    ),
    Kind("shells", "several_bodies", "note", _several_bodies, "{count} separate bodies"),
    Kind(
        "shells", "cavity", "note",
        _cavities,
        "{count:cavity|cavities} of {volume:.4g} {unit}³ in all, the first {around}",
    ),
    Kind(
        "nodes", "empty", "error",
        lambda mesh: None if mesh.cells.count else Evidence(0),
        "there are no cells",
        ("export the mesh again",),
    ),
    Kind(
        "nodes", "node_out_of_range", "error",
        CellTopology.out_of_range,
        "{count:cell} with a node that does not exist, the first being cell {first} with node {node} where the nodes "
        "are 0 to {last}",
        ("export the mesh again",),
    ),
    Kind(
        "nodes", "non_finite", "error",
        CellTopology.unusable,
        "{count:node} with a coordinate that is no usable number (NaN, infinite or beyond 1e75), the first being node "
        "{node}",
        ("export the mesh again",),
    ),
    Kind(
        "cells", "zero_volume", "error",
        CellTopology.no_volume_cells,
        "it holds lines or points only, which have no volume",
        ("export a solid",),
    ),
    Kind(
        "cells", "duplicate_cell", "error",
        CellTopology.duplicates,
        "{count:cell} stored again, the first being cell {first} {around}, so that the volume counts twice",
        ("remove the copies",),
    ),
    Kind(
        "cells", "duplicate_cell", "warning",
        CellTopology.repeated_lines,
        "{count:line} stored again, the first being cell {first} {around}, so that the length counts twice",
        ("remove the copies",),
    ),
    Kind(
        "cells", "overlapping_cells", "error",
        CellTopology.overlaps,
        "overlapping cells: {count:face} of more than two cells, the first {around} at cell {first}, so that the "
        "volume counts twice",
        ("remove what overlaps",),
    ),
    Kind(
        "maps", "tangled_cell", "error",
        CellTopology.tangled,
        "{cell} is tangled: its Jacobian determinant has both signs, one reaching {share:.2g} of the other, {around} "
        "(cells and nodes count from 0){others}",
        ("give its nodes in the order of the file's format (of arrays, VTK's), or mesh it again",),
    ),
    Kind(
        "maps", "flat_cell", "error",
        CellTopology.without_volume,
        "{cell} has no volume: its Jacobian determinant is 0, {around} (cells and nodes count from 0){others}",
        ("remove it, or mesh it again",),
    ),
    Kind(
        "sides", "overlapping_cells", "error",
        CellTopology.folds,
        "overlapping cells: {count:face} with both cells on one side, the first {around} between cells {one} and "
        "{other}, so that the volume counts twice",
        ("mesh it again, or turn the cell inside out that is",),
    ),
    Kind(
        "space", "overlapping_cells", "error",
        shared_space,
        "overlapping cells: {cells} cover the same place {around}, so that it counts twice{doubt}",
        ("remove what overlaps, or mesh it again",),
    ),
    Kind("cells", "several_bodies", "note", CellTopology.several_bodies, "{count} separate bodies"),
    Kind("cells", "unused_vertices", "note", CellTopology.unused, "{count:node} that no cell uses"),
)  # fmt: skip
