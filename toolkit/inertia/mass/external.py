"""Integration of a surface that is larger than the memory that may be taken: its file is read again and again.

The sums are those of `inertia.mass.triangles`, which take triangles block by block whatever their number, so that the
moments have the same bits as in memory. Closure, pieces and orientation come from `inertia.mesh.external`. Triangles
that cross, and bodies that share space, are not looked for: the notes say so.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator

import numpy as np

from inertia.arrays import Float, Progress
from inertia.errors import ABSOLUTE, REPAIR, SEPARATE, UNION, WELD, GeometryError, Remedy, UsageError, Word
from inertia.mass.integration import Group, Integral, naming, refuse_faults, refuse_flat, sums_of_small, surface_area
from inertia.mass.moments import Moments
from inertia.mass.triangles.arithmetic import METHODS, arithmetics, shell_moments, solid_moments
from inertia.mass.triangles.sums import Frame, SummedFacets, Sums, block_rows, frame_of, sum_triangles, sums_of
from inertia.mesh.checks.edge_faults import edge_faults, shell_findings
from inertia.mesh.checks.findings import Finding, counted
from inertia.mesh.external.closure import Pairing, external_closure, room_for, room_to_look
from inertia.mesh.external.memory import RESERVE, enough, fits, fits_in_memory, in_bytes, resident
from inertia.mesh.external.shuffle import DaskWorkers
from inertia.mesh.external.temporary_file import MEMORY
from inertia.mesh.geometry.irregular_edges import Irregular
from inertia.mesh.geometry.shells import Shell, bodies, shells
from inertia.mesh.geometry.sound_shells import sound_bodies
from inertia.mesh.part import Part
from inertia.mesh.surface import FacesInFile, Facets, Surface, Triangles

_AMPLE = 1_000_000_000  # bytes beside the least, where workers do what takes most
_AT_ONCE = (REPAIR, WELD, UNION, SEPARATE, ABSOLUTE)  # remedies that take the whole part in memory
_DASK = Remedy("analyse", "dask")
_NESTING = 24  # bytes of memory that a triangle takes where shells are looked for in one another


def answered_at_once(part: Part, memory: float) -> bool:
    """Say whether a part is analysed in memory, as ever, within so many bytes of this process."""
    geometry = part.geometry
    if isinstance(geometry, FacesInFile):
        return False
    if isinstance(geometry, Surface):
        return fits_in_memory(geometry.count, memory, geometry.vertices.nbytes + geometry.faces.nbytes)
    return fits(geometry.count, memory)


def require_external(part: Part, memory: float, asked: Collection[str]) -> None:
    """Raise `UsageError` where a part that does not fit into memory cannot be analysed otherwise.

    Parameters
    ----------
    asked : in words, what takes the whole part in memory
    """
    if not isinstance(part.geometry, Facets | FacesInFile):
        raise UsageError(
            f"{part.name} is no binary STL file, nor a binary PLY file of triangles alone: only these go piece by "
            "piece, so leave the limit of memory, or the Dask workers, out, or write it as one"
        )
    if asked and not math.isfinite(memory):
        raise UsageError(f"{' and '.join(asked)} cannot be had from Dask workers: leave one or the other out")
    if asked:
        takes = in_bytes(enough(part.triangles.count))
        raise UsageError(
            f"{part.name} takes up to {takes} of memory, beyond {in_bytes(memory)}, and "
            f"{' and '.join(asked)} cannot be had otherwise: leave that out, or allow that much by ",
            MEMORY,
        )


def external_integrals(
    part: Part,
    memory: float,
    *,
    shell: bool = False,
    accuracy: float | str | None = None,
    workers: DaskWorkers | None = None,
    progress: Progress | None = None,
) -> Iterator[Integral]:
    """Integrate a file of triangles as a solid or a `shell`, within so many bytes of this process.

    With workers, these sum its triangles in float64 and pair their edges. Yields as
    `inertia.mass.integration.surface_integrals` does, and raises what that raises, with what its remedies take;
    `UsageError` where the memory is too little, `WriteError` where there is no room for temporary files.
    """
    try:
        yield from _integrals(part, memory, shell, accuracy, workers, progress)
    except GeometryError as fault:
        raise _with_what_remedies_take(part, fault, workers is not None) from None


def _with_what_remedies_take(part: Part, fault: GeometryError, distributed: bool) -> GeometryError:
    """Return a refusal that says how those of its remedies can be had that take the whole part in memory."""
    remedies = [remedy for remedy in fault.remedies if remedy in _AT_ONCE]
    if not remedies:
        return fault
    words: list[Word] = ["; ", remedies[0]]
    for remedy in remedies[1:]:
        words += [" and ", remedy]
    words.append(" take the whole part in memory: " if remedies[1:] else " takes the whole part in memory: ")
    if distributed:
        words += ["leave ", _DASK, " out"]
    else:
        words += [f"allow {in_bytes(enough(part.triangles.count))} by ", MEMORY]
    return GeometryError(*fault.words, *words, places=fault.places, code=fault.code)


def _integrals(
    part: Part,
    memory: float,
    shell: bool,
    accuracy: float | str | None,
    workers: DaskWorkers | None,
    progress: Progress | None,
) -> Iterator[Integral]:
    triangles = part.triangles
    tries = arithmetics(accuracy)
    beside = resident() + RESERVE + triangles.count
    most = enough(triangles.count) if workers is None else math.inf
    room = int(memory - beside) if math.isfinite(memory) else room_for(triangles.count) + _AMPLE
    if room < room_for(triangles.count):
        least = min(1.02 * (beside + room_for(triangles.count)), most)
        raise UsageError(
            f"{part.name} has {triangles.count} triangles, which cannot be checked within {in_bytes(memory)} of "
            f"memory: allow at least {in_bytes(least)} by ",
            MEMORY,
        )
    with naming(part):
        if workers is None:
            summed_meanwhile = SummedFacets(triangles, surface=shell) if isinstance(triangles, Facets) else None
            pairing = external_closure(summed_meanwhile or triangles, room, _part_of(progress, 0.0, 0.7))
            summing = _part_of(progress, 0.7, 0.9)
            if summed_meanwhile is not None:
                sums = summed_meanwhile.sums(summing)
            else:
                sums = sum_triangles(triangles, surface=shell, progress=summing)
        else:
            of_block = None if shell else sums_of_small(triangles)
            sums = of_block or _sums_by(workers, triangles, shell, _part_of(progress, 0.0, 0.2))
            pairing = external_closure(triangles, room, _part_of(progress, 0.2, 0.9), workers=workers)
    extents = np.array([sums.low, sums.high])
    topology = pairing.closure
    pieces: tuple[Shell, ...] = ()
    doubts: tuple[Finding, ...] = ()
    if not shell:
        pieces = _shells(part, pairing, room, beside, most) if topology.open_edges == 0 else ()
        refuse_faults(part, edge_faults(part, topology, pairing.irregular, pieces, extents))
        doubts = _shell_doubts(part, pairing, pieces, extents) if pieces else ()
    elif topology.crowded:
        _irregular_of(part, pairing, beside, most)
    integral = Integral(
        groups=(),
        method=METHODS["float64"],
        triangles=triangles.count,
        cells=0,
        closed=topology.open_edges == 0,
        bodies=len(bodies(pieces)) if pieces else topology.components,
        area=surface_area(sums),
        extents=extents,
        notes=(_note(memory, workers is not None, pieces, topology.crowded),),
        doubts=doubts,
    )
    for k, arithmetic in enumerate(tries[:2] if shell else tries):
        further = _part_of(progress, 0.9 + 0.1 * k / len(tries), 0.9 + 0.1 * (k + 1) / len(tries))
        of = shell_moments if shell else solid_moments
        whole = of(triangles, arithmetic, sums, further, part.rounding)
        if shell or whole.zeroth > whole.zeroth_bound:
            yield Integral(**{**vars(integral), "groups": (Group("1", whole),), "method": METHODS[arithmetic]})
        elif whole.zeroth < -whole.zeroth_bound and not pieces:
            pieces = _only(part, pairing, whole, extents, room)
            _shell_doubts(part, pairing, pieces, extents)
        elif arithmetic == tries[-1]:
            refuse_flat(part, whole, extents)


def _sums_by(workers: DaskWorkers, triangles: Triangles, shell: bool, progress: Progress | None) -> Sums:
    frame = frame_of(triangles, surface=shell)
    return sums_of(triangles, frame, workers.over_ranges(_rows, frame, progress=progress))


def _rows(triangles: Triangles, frame: Frame) -> Float:
    """Return the rows of the blocks of some triangles."""
    with np.errstate(invalid="ignore", over="ignore"):
        return np.concatenate([rows for _, rows in block_rows(triangles, frame)])


def _shell_doubts(part: Part, pairing: Pairing, pieces: tuple[Shell, ...], extents: Float) -> tuple[Finding, ...]:
    """Raise `GeometryError` for what is wrong with shells; return what leaves some of the volume in doubt."""
    assert isinstance(pairing.irregular, Irregular)
    return refuse_faults(part, shell_findings(part, pairing.closure, pairing.irregular, pieces, extents))


def _irregular_of(part: Part, pairing: Pairing, beside: float, most: float) -> Irregular:
    """Return the irregular edges; raise `UsageError` where they are too many for the memory."""
    if isinstance(pairing.irregular, Irregular):
        return pairing.irregular
    edges, least = pairing.irregular.crowded, beside + room_to_look(part.triangles.count, pairing.irregular.halves)
    raise _too_little(part, f"{counted(edges, 'edge')} of more than two triangles", least, most)


def _shells(part: Part, pairing: Pairing, room: int, beside: float, most: float) -> tuple[Shell, ...]:
    """Return the shells of a closed surface; none where it has one, or all of them are bodies that lie apart."""
    triangles, topology = part.triangles, pairing.closure
    _irregular_of(part, pairing, beside, most)
    count = topology.components
    if count == 1 or sound_bodies(triangles, topology, streamed=True) == count:
        return ()
    if not _nests(triangles, room):
        least = beside + (4 + _NESTING) * triangles.count
        raise _too_little(part, f"{topology.components} shells, and which of them lie in others,", least, most)
    return shells(triangles, topology)


def _only(part: Part, pairing: Pairing, whole: Moments, extents: Float, room: int) -> tuple[Shell, ...]:
    """Return the shells of a surface of negative volume that were not looked at: the only one, or all inward."""
    if _nests(part.triangles, room):
        return shells(part.triangles, pairing.closure)
    return (Shell(0, "inward", part.triangles.count, 0, float(whole.zeroth), extents, 0, 0, None),)


def _nests(triangles: Triangles, room: int) -> bool:
    return room - 4 * triangles.count >= _NESTING * triangles.count


def _too_little(part: Part, what: str, least: float, most: float) -> UsageError:
    """Return that more memory is needed: the least bytes piece by piece, or the `most`, where it is done at once."""
    allow = in_bytes(min(1.02 * least, most))
    return UsageError(
        f"{part.name} has {what} which cannot be looked at in so little memory: allow {allow} by ", MEMORY
    )


def _note(memory: float, distributed: bool, pieces: tuple[Shell, ...], crowded: int) -> str:
    """Say what was not looked for."""
    several = ", nor whether bodies share space" if len(bodies(pieces)) > 1 else ", nor whether its shells meet"
    others = several if len(pieces) > 1 else ""
    which = counted(crowded, "edge")
    edges = f", nor whether material lies on material at {which} of more than two triangles" if crowded else ""
    how = "by the workers of a Dask scheduler" if distributed else f"within {in_bytes(memory)} of memory"
    return f"checked {how}: triangles that cross were not looked for{others}{edges}"


def _part_of(progress: Progress | None, start: float, stop: float) -> Progress | None:
    return None if progress is None else lambda done: progress(start + done * (stop - start))
