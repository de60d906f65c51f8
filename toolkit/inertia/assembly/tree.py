"""`PartTree`: parts, shapes, point masses and other assemblies placed and added up, as an assembly file says."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import field, replace
from fnmatch import fnmatchcase
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np

from inertia.arrays import Float
from inertia.assembly.bodies import Body, Library, Weight, triangles_of
from inertia.assembly.fields import AssemblyFields, PartFields
from inertia.assembly.frames import IDENTITY, LENGTH_BITS, UNTURNED, Frame, frame, turned
from inertia.assembly.inputs import Kind, Owner
from inertia.assembly.outline import relative
from inertia.assembly.rollup import Placed, place
from inertia.documents import Document, FieldError, plain, section_of
from inertia.errors import FieldPath, GeometryError, InertiaError, ReadError, UsageError, placed, reworded
from inertia.mass.density import ASSUMED, density_of
from inertia.mass.moments import ZERO
from inertia.mass.properties import MassProperties
from inertia.mesh.part import Part
from inertia.mesh.tree import MeshTree
from inertia.mesh.turns import TURN_BITS
from inertia.records import dataclass
from inertia.units import Unit, length_unit

_MOST_COPIES = 1_000_000
_DEEPEST = 64  # assemblies in assemblies
_NAMED = 5  # parts that a note lists
_LEVELS = 100  # parts on parts, those of assemblies in assemblies counted on

Triangulated = Callable[[PartFields, Body, Unit], Float | None]


@dataclass(frozen=True, eq=False)
class Node:
    """A place in the tree: a part, a group of parts, or another assembly.

    Attributes
    ----------
    owner : the name of the part, or of the assembly at the top, with the file that it is from
    fields : what the file says of it; None at the top
    path : what errors call it, as ``part[3]``
    file : that says so
    unit : of the lengths in that file
    body : what it is; None of a group
    frames : of its copies, in the axes of its parent
    children : what is in it
    """

    owner: Owner
    fields: PartFields | None
    path: str
    file: str
    unit: Unit
    body: Body | None
    frames: tuple[Frame, ...]
    children: tuple[Node, ...] = ()

    @property
    def name(self) -> str:
        """That of the part, or of the assembly at the top."""
        return self.owner.name

    @property
    def label(self) -> str:
        """The name, with the file that it is from where that is not the one at the top."""
        return self.owner.label

    @property
    def leaves(self) -> Iterator[Node]:
        """The parts in it, itself where it is one, from the top to the bottom."""
        if self.body is not None:
            yield self
        for child in self.children:
            yield from child.leaves


@dataclass(frozen=True, eq=False)
class PartTree(Document):
    """A tree of parts as its file describes it.

    Attributes
    ----------
    fields : what the file says, lengths in its own unit
    folder : where the files are that it names
    text : the file as it was read; None without one
    path : the file's path, or "the assembly"
    remarks : what reading had to decide, in sentences
    tree : the meshes that were read already: of which file, in which unit
    moves : nodes that are elsewhere, see `moved`
    left_out : what has a mass and is not in the tree, in sentences, which are among the remarks
    is_carried : whether the file is one of meshes or of a robot, in which nobody wrote these fields

    Raises `UsageError` naming the field.

    >>> dumbbell = PartTree.from_dict({
    ...     "unit": "m",
    ...     "part": [{"name": "ball", "shape": "point", "mass": 1.0, "at": [1, 0, 0],
    ...               "around": {"count": 2, "axis": "z"}}],
    ... })
    >>> dumbbell.mass_properties().inertia.diagonal().tolist()
    [0.0, 2.0, 2.0]
    """

    noun: ClassVar[str] = "assembly"

    fields: AssemblyFields
    folder: Path = Path()
    text: str | None = None
    path: str = "the assembly"
    remarks: tuple[str, ...] = ()
    tree: tuple[Path, str | None, MeshTree] | None = None
    moves: Mapping[Node, tuple[Frame, ...]] = field(default_factory=dict)
    left_out: tuple[str, ...] = ()
    is_carried: bool = False

    @classmethod
    def _from_table(cls, table: Mapping[str, Any], folder: Path, text: str | None, name: str) -> Self:
        assembly = cls(section_of(AssemblyFields, table, path=""), folder, text, name)
        assembly._require_sense()
        return assembly

    def to_dict(self) -> dict[str, Any]:
        """Return the assembly as a dictionary laid out as the file is; what is at its default is left out."""
        return {"schema": self.fields.schema, "unit": self.fields.unit, **plain(self.fields)}

    @property
    def name(self) -> str:
        """What reports call the whole."""
        return self.fields.name or Path(self.path).stem

    @cached_property
    def unit(self) -> Unit:
        """The unit of all lengths in the file."""
        return length_unit(self.fields.unit)

    def mass_properties(self) -> MassProperties:
        """Return mass, centre of mass and tensor of the whole, with their certified bound.

        Raises `ReadError` and `GeometryError` of the files of parts, `UsageError` of fields that do not go together.
        """
        return self.placed.properties

    @cached_property
    def root(self) -> Node:
        """The tree, its files read and integrated."""
        nodes = self._nodes(self._library, (), (self,))
        return Node(Owner(self.name), None, "", self.path, self.unit, None, (IDENTITY,), nodes)

    @cached_property
    def _library(self) -> Library:
        library = Library()
        library.add(self.remarks, self.tree, self.left_out)
        return library

    @cached_property
    def placed(self) -> Placed:
        """The parts in their places, in the order of the tree."""
        parts = [(node.body, frames) for node, frames in self.in_places() if node.body is not None]
        if not parts and self.unweighed:
            raise placed(GeometryError(f"nothing of it can be weighed: {'; '.join(self.unweighed)}"), self.path)
        if not parts:
            raise placed(UsageError("it has no part with a mass: give one a file, a shape or a mass"), self.path)
        return place(*zip(*parts, strict=True))

    @property
    def unweighed(self) -> tuple[str, ...]:
        """What has a mass and is in no answer, here and in nested files, in sentences."""
        return tuple(self._library.left_out) if self.root else ()

    def in_places(self) -> Iterator[tuple[Node, tuple[Frame, ...]]]:
        """Yield all nodes in the order of the tree, each with the frames of its copies in the axes of the whole."""
        return _in_places(self.root, (IDENTITY,), self.moves)

    def moved(self, moves: Mapping[Node, tuple[Frame, ...]]) -> Self:
        """Return the same tree with the copies of some nodes elsewhere.

        Parameters
        ----------
        moves : the frames of all copies of a node, in the axes of the whole; what hangs on it moves along where it is
            not listed itself
        """
        result = replace(self, moves=moves)
        result.__dict__.update(root=self.root, _library=self._library)
        return result

    def surfaces(self, of: Triangulated = triangles_of) -> Iterator[tuple[Node, Float]]:
        """Yield the triangles (m, 3, 3) m of each copy of each part in its place, turned in float64.

        Parameters
        ----------
        of : returns those of a part in its own axes; None of what has none
        """
        for node, frames in self.in_places():
            own = None if node.body is None or node.fields is None else of(node.fields, node.body, node.unit)
            for each in frames if own is not None else ():
                turn = np.array([k / (1 << TURN_BITS) for k in each.rotation]).reshape(3, 3)
                yield node, own @ turn.T + np.array([k / (1 << LENGTH_BITS) for k in each.origin])

    def mesh(self) -> Part | None:
        """Return all parts in their places as one, for drawings; None where none has a surface."""
        corners = [corners for _, corners in self.surfaces()]
        if not corners:
            return None
        vertices = np.concatenate(corners).reshape(-1, 3)
        return Part.from_arrays(vertices, np.arange(len(vertices)).reshape(-1, 3))

    @property
    def notes(self) -> tuple[str, ...]:
        """What was decided on the way, in sentences."""
        leaves = [(leaf.name, leaf.body) for leaf in self.root.leaves if leaf.body is not None]
        notes = dict(self._library.remarks)
        notes |= dict.fromkeys(note for _, body in leaves for note in body.notes)
        assumed = list(dict.fromkeys(name for name, body in leaves if body.assumed))
        several = f"{', '.join(assumed[:_NAMED])} and {len(assumed) - _NAMED} other parts"
        for what in [several] if len(assumed) > _NAMED else assumed:
            notes[f"the density of {what} is assumed to be {ASSUMED:g} kg/m³"] = None
        return tuple(notes)

    def _require_sense(self) -> None:
        """Raise `FieldError` where parts are not called, or hang together, as they must."""
        parts = self.fields.part
        names = {part.name: k for k, part in enumerate(parts)}
        if len(names) < len(parts):
            twice = next(name for name, count in Counter(part.name for part in parts).items() if count > 1)
            number = names[twice]
            raise FieldError(f"part[{number}].name", f"is {twice!r}, as that of another part: give it its own")
        for k, part in enumerate(parts):
            if part.parent is not None and part.parent not in names:
                raise FieldError(f"part[{k}].parent", f"is {part.parent!r}: there is no part of that name")
            above, seen = part.parent, {part.name}
            while above is not None:
                if above in seen:
                    raise FieldError(f"part[{k}].parent", f"is {part.parent!r}, which hangs on this part itself")
                seen.add(above)
                above = parts[names[above]].parent

    def _nodes(
        self, library: Library, chain: tuple[str, ...], contexts: tuple[PartTree, ...], level: int = 1, copies: int = 1
    ) -> tuple[Node, ...]:
        """Return the nodes from a level on, of which there are so many copies.

        `contexts` are this assembly and those that it is in, innermost first.
        """
        below: dict[str | None, list[int]] = {}
        for k, part in enumerate(self.fields.part):
            below.setdefault(part.parent, []).append(k)

        def node(number: int, level: int, copies: int) -> Node:
            part, where = self.fields.part[number], f"part[{number}]"
            try:
                if level > _LEVELS:
                    raise UsageError(f"{part.name} is {level} levels deep: {_LEVELS} are the most")
                copies *= part.copies
                if copies > _MOST_COPIES:
                    raise UsageError(f"{part.name}: {copies} copies are more than {_MOST_COPIES}")
                body = self._body(part, library, contexts)
                inner = self._nested(part, library, chain, contexts, level + 1, copies)
            except InertiaError as error:
                raise self._placed(error, number) from None
            own = tuple(node(k, level + 1, copies) for k in below.get(part.name, ()))
            frames = self._frames(part)  # once it is known that there are not too many below
            owner = self._owner(part.name, contexts)
            return Node(owner, part, where, self.path, self.unit, body, frames, inner + own)

        return tuple(node(k, level, copies) for k in below.get(None, ()))

    def _placed(self, error: InertiaError, number: int) -> InertiaError:
        """Return an error of a part with where that is: a field of the file, or what the file calls it."""
        if not self.is_carried:
            return placed(error, self.path, FieldPath(f"part[{number}]"))
        parts = self.fields.part
        within = [parts[number].name] if len(parts) > 1 else []
        own = (place for place in error.places if place != self.path)
        return reworded(error, error.words, (self.path, *within, *own))

    def _nested(
        self,
        part: PartFields,
        library: Library,
        chain: tuple[str, ...],
        contexts: tuple[PartTree, ...],
        level: int,
        copies: int,
    ) -> tuple[Node, ...]:
        if part.assembly is None:
            return ()
        file = self.folder / part.assembly
        here = os.path.realpath(self.path)
        if os.path.realpath(file) in (here, *chain):
            raise ReadError(f"{part.assembly} holds itself: an assembly cannot be one of its own parts", code="cycle")
        if len(chain) >= _DEEPEST:
            raise ReadError(f"{part.assembly} is {len(chain)} assemblies deep: {_DEEPEST} are the most")
        nested = type(self).load(file)
        library.add(nested.remarks, nested.tree, nested.left_out)
        if unused := [name for name in ("allowances", "limit") if getattr(nested.fields, name)]:
            does = "counts" if unused == ["limit"] else "count"
            says = f"{part.assembly}: its {' and '.join(unused)} {does} where it is asked about by itself, not here"
            library.add([says], None)
        return nested._nodes(library, (*chain, here), (nested, *contexts), level, copies)

    def _body(self, part: PartFields, library: Library, contexts: tuple[PartTree, ...]) -> Body | None:
        if part.is_group or part.assembly is not None:
            return None
        weight, owner = self._weight(part, contexts), self._owner(part.name, contexts)
        body = library.body(part, weight, owner, self.folder, self.unit)
        return replace(body, assumed=True) if weight.assumed else body

    def _weight(self, part: PartFields, contexts: tuple[PartTree, ...]) -> Weight:
        """Return how heavy a part is: as weighed, by its own density or material, or by a glob that fits its name."""
        own = self._owner(part.name, contexts)
        if part.mass is not None:
            return Weight(1.0, own, part.mass)
        if part.density is not None:
            return Weight(part.density, own)
        material = part.material
        for context in contexts if material is None else ():
            globs = context.fields.materials or {}
            material = next((globs[glob] for glob in globs if fnmatchcase(part.name, glob)), None)
            if material is not None:
                break
        if material is None:
            return Weight(ASSUMED, own, assumed=True)
        for context in contexts:
            if (density := (context.fields.densities or {}).get(material)) is not None:
                return Weight(density, context._owner(material, contexts, "material"))
        return Weight(density_of(material), Owner(material, kind="material"))

    def _owner(self, name: str, contexts: tuple[PartTree, ...], kind: Kind = "part") -> Owner:
        """Return what has a name in this file; the last of `contexts` is the assembly at the top."""
        return Owner(name, "" if self is contexts[-1] else relative(Path(self.path), contexts[-1].folder), kind)

    def _frames(self, part: PartFields) -> tuple[Frame, ...]:
        """Return the frames of all copies of a part, in the axes of its parent."""
        metres = self.unit.metres
        rows, skew = part.rotation()
        at = part.at or (ZERO,) * 3
        if part.matrix is not None and part.matrix.shape == (4, 4):
            at = tuple(Fraction(k) for k in part.matrix[:3, 3].tolist())
        copies = [IDENTITY]
        if part.around is not None:
            point = [metres * k for k in part.around.through or (ZERO,) * 3]
            back = frame(UNTURNED, [-k for k in point])
            copies = [frame(turned(turn), point).then(back) for turn in part.around.turns()]
        if part.rows is not None:
            x, y, z = (metres * k for k in part.rows.step)
            a, b, c = map(range, part.rows.count)
            copies = [frame(UNTURNED, (i * x, j * y, k * z)) for i in a for j in b for k in c]
        own = frame(rows, at, skew, metres)
        copies = [copy.then(own) for copy in copies] if len(copies) > 1 else [own]
        return tuple(copies) * part.quantity


def _in_places(
    node: Node, places: tuple[Frame, ...], moves: Mapping[Node, tuple[Frame, ...]]
) -> Iterator[tuple[Node, tuple[Frame, ...]]]:
    if len(places) * len(node.frames) > _MOST_COPIES:
        raise UsageError(f"{node.name}: {len(places) * len(node.frames)} copies are more than {_MOST_COPIES}")
    if node in moves:
        here = moves[node]
    elif node.frames == (IDENTITY,):
        here = places
    elif places == (IDENTITY,):
        here = node.frames
    else:
        here = tuple(outer.then(inner) for outer in places for inner in node.frames)
    yield node, here
    for child in node.children:
        yield from _in_places(child, here, moves)
