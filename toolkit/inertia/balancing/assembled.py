"""A rotor that is an assembly: its parts as bodies, how they are best put together, and how they are mounted.

The unbalance is that of the assembly's moments, which are turned and shifted exactly; the triangles of its parts are
what is cut, drawn and kept apart. A part that is turned about the shaft takes along what hangs on it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from fractions import Fraction

import numpy as np

from inertia.arrays import Float
from inertia.assembly.bodies import Body, triangles_of
from inertia.assembly.document import Assembly
from inertia.assembly.fields import SIZES, PartFields
from inertia.assembly.frames import IDENTITY, LENGTH_BITS, UNTURNED, Frame, frame
from inertia.assembly.frames import turned as rotation
from inertia.assembly.rollup import place
from inertia.assembly.tree import Node
from inertia.balancing import bounds
from inertia.balancing.assembled_search import best_way
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.bounds import Uncertainty
from inertia.balancing.facet_error import FacetLayers
from inertia.balancing.indexing import Indexing
from inertia.balancing.mounting import Joint
from inertia.balancing.rotor import Rotor
from inertia.balancing.rotor_bodies import RotorBody, require_apart
from inertia.balancing.rotor_fields import MountFields
from inertia.balancing.unbalance import Complex
from inertia.documents import FieldError
from inertia.errors import InertiaError, UsageError, placed
from inertia.mass.analyse import analyse, sound_solids_only
from inertia.mass.density import DensityFrom
from inertia.mass.properties import MassProperties
from inertia.mesh.part import Part, Rounding
from inertia.mesh.surface import Surface
from inertia.mesh.turns import TURN_BITS, about

_SOLIDS = tuple(shape for shape, lengths in SIZES.items() if lengths)


class AssembledRotor:
    """The parts of a rotor's assembly in their places."""

    def __init__(self, rotor: Rotor, tree: Assembly) -> None:
        self.rotor, self.tree = rotor, tree
        self.frames = dict(tree.in_places())
        self._above: dict[Node, Node] = {}
        for node in self.frames:
            self._above |= dict.fromkeys(node.children, node)
        self.mounts = [(fields, tuple(self._nodes(number, fields))) for number, fields in enumerate(rotor.fields.mount)]

    def _nodes(self, number: int, fields: MountFields) -> Iterator[Node]:
        """Yield the parts that a mount names; those that are put together stand alone."""
        path, fits = f"mount[{number}]", [k for k in self.frames if k.fields and fnmatchcase(k.name, fields.part)]
        if not fits:
            names = sorted({k.name for k in self.frames if k.fields})
            few = ", ".join(names[:6]) + (" …" if len(names) > 6 else "")
            raise self._unusable(f"{path}.part", f"is {fields.part!r}: no part of the assembly has that name, of {few}")
        for node in fits:
            what = "turned" if fields.indexing is not None else "exchanged" if fields.interchangeable else None
            if what and len(self.frames[node]) > 1:
                raise self._unusable(
                    f"{path}.part",
                    f"is {node.name}, of which there are {len(self.frames[node])} copies: list what is {what} part by "
                    "part",
                )
            if fields.interchangeable and (node.body is None or node.children):
                raise self._unusable(
                    f"{path}.part", f"is {node.name}: a group does not change places, only its parts do"
                )
            yield node
        if fields.interchangeable and len(fits) < 2:
            raise self._unusable(
                f"{path}.part", f"is {fields.part!r}, which only {fits[0].name} fits: nothing to exchange"
            )

    def _unusable(self, path: str, says: str) -> InertiaError:
        return placed(FieldError(path, says), self.rotor.name)

    @property
    def properties(self) -> MassProperties:
        """Of the whole."""
        return self.tree.mass_properties()

    @property
    def notes(self) -> tuple[str, ...]:
        """What was decided on the way, in sentences."""
        bare = [node.name for node in self.frames if node.body is not None and not self._is_solid(node)]
        few = ", ".join(bare[:3]) + (" …" if len(bare) > 3 else "")
        more = (f"no solid, so that it counts, and is neither drawn nor cut: {few}",) if bare else ()
        return (*more, *self.tree.notes)

    def _is_solid(self, node: Node) -> bool:
        fields = node.fields
        return fields is not None and fields.shell is None and (fields.file is not None or fields.shape in _SOLIDS)

    def bodies(self) -> tuple[RotorBody, ...]:
        """Return the copies of all parts that are closed meshes or solids, each as a body.

        Raises `GeometryError` where one is not sound, or two share space.
        """
        result = []
        for node, frames in self.frames.items():
            fields, body = node.fields, node.body
            if fields is None or body is None or not self._is_solid(node):
                continue
            own = triangles_of(fields, body, node.unit)
            if own is None:
                continue
            for number, each in enumerate(frames, 1):
                name = node.name if len(frames) == 1 else f"{node.name} {number}"
                result.append(self._body(fields, body, name, own, each))
        if not result:
            raise placed(UsageError("none of its parts is a solid: give one a file or a shape"), self.tree.path)
        require_apart(self.rotor, result)
        return tuple(result)

    def _body(self, fields: PartFields, body: Body, name: str, own: Float, each: Frame) -> RotorBody:
        turn = np.array([k / (1 << TURN_BITS) for k in each.rotation]).reshape(3, 3)
        corners = own @ turn.T + np.array([k / (1 << LENGTH_BITS) for k in each.origin])
        read = body.part
        scale = 1.0 if read is None else float(read.unit.metres)
        surface = Surface(corners.reshape(-1, 3) / scale, np.arange(3 * len(corners)).reshape(-1, 3))
        if read is None:
            part = Part.from_arrays(surface.vertices, surface.faces)
        else:
            rounding = None if read.rounding is None else Rounding(read.rounding.distance)
            part = replace(read, geometry=surface, rounding=rounding, shape=None, regions=None)
        density = float(body.moments.zeroth / body.volume)
        try:
            with sound_solids_only("a rotor takes sound solids only"):
                analysis = analyse(part, density)
        except InertiaError as error:
            raise placed(error, self.tree.path, name) from None
        stated: DensityFrom = (
            "mass" if fields.mass is not None else "option" if fields.density is not None else "material"
        )
        analysis = replace(
            analysis, properties=place([body], [[each]]).properties, density_from=stated, notes=(), uncertainty=None
        )
        layers = FacetLayers(part)
        if read is None or (read.shape is not None and read.chord is not None):
            return RotorBody(name, part, part, analysis, layers.sag, "shape", layers)
        if read.chord is not None:
            return RotorBody(name, part, part, analysis, float(read.chord.max()) * scale, "read", layers)
        return RotorBody(name, part, part, analysis, layers.sag, "estimated" if layers.sag else "exact", layers)

    def joints(self) -> tuple[Joint, ...]:
        """Return how parts are mounted, each copy with all that hangs on it."""
        result = []
        for fields, nodes in self.mounts:
            spreads = self.rotor.mounting(fields)
            if not any(spread.total for spread in spreads.values()):
                continue
            z = None if fields.z is None else fields.z * float(self.rotor.unit.metres)
            for node in nodes:
                count = len(self.frames[node])
                for k in range(count):
                    name = node.name if count == 1 else f"{node.name} {k + 1}"
                    result.append(Joint(name, self._carried(node, k, count), spreads, z))
        return tuple(result)

    def _carried(self, node: Node, copy: int, count: int) -> MassProperties:
        """Return the mass properties of one copy of a node with all that hangs on it."""
        leaves = list(node.leaves)
        if not leaves:
            raise self._unusable("mount", f"names {node.name}, which carries no part with a mass")
        parts = [(leaf.body, self.frames[leaf]) for leaf in leaves if leaf.body is not None]
        some = [(body, each[copy * len(each) // count : (copy + 1) * len(each) // count]) for body, each in parts]
        return place(*zip(*some, strict=True)).properties

    def uncertainty(self, shaft: Shaft, z: float) -> Uncertainty:
        """Return what uncertain inputs of the assembly leave uncertain of the unbalance; z, m, as of `Unbalance`."""
        modes: list[tuple[complex, complex]] = []
        labels: list[str] = []
        sigma = self.tree.budget().total.sigma
        owner = np.asarray(sigma.owner, dtype=np.intp)
        for number, label in enumerate(sigma.labels):
            changes = np.zeros((int((owner == number).sum()), 11))
            changes[:, 1:] = sigma.changes[owner == number, :10]
            if np.abs(changes).max(initial=0.0) > 0:
                one = bounds.propagated(label, changes.T @ changes, self.properties, shaft, z)
                modes += one.modes
                labels += [label] * len(one.modes)
        return Uncertainty("input", tuple(modes), bodies=tuple(labels))

    def put_together(
        self, shaft: Shaft, limits: Sequence[float], keys: Complex
    ) -> tuple[AssembledRotor, Indexing] | None:
        """Return the rotor put together the best way; None where nothing is left open.

        Parameters
        ----------
        shaft : in the axes of the assembly
        limits : (k,) kg m, in the tolerance planes
        keys : (k,) kg m, what else is on the shaft
        """
        turning = {node: self.rotor.indexing(f) for f, nodes in self.mounts if f.indexing is not None for node in nodes}
        sets = [nodes for f, nodes in self.mounts if f.interchangeable]
        if not turning and not sets:
            return None
        moved = [node for f, nodes in self.mounts if f.interchangeable or f.indexing is not None for node in nodes]
        if twice := next((node.name for node in moved if moved.count(node) > 1), None):
            raise self._unusable("mount", f"has {twice} turned or exchanged twice: name it once")
        chains = {node: self._chain(node, turning) for node in self.frames}
        try:
            turns, slots, indexing = best_way(self.frames, chains, turning, sets, shaft, np.asarray(limits), keys)
        except FieldError as error:
            raise placed(error, self.rotor.name) from None
        moves = {}
        for node in self.frames:
            slot = slots.get(node, node)
            angle = sum((turns[each] for each in chains[slot]), Fraction(0))
            if angle % 360 or slot is not node:
                moves[node] = tuple(about_shaft(shaft, angle).then(each) for each in self.frames[slot])
        return AssembledRotor(self.rotor, self.tree.moved(moves)), indexing

    def _chain(self, node: Node, among: Mapping[Node, object]) -> tuple[Node, ...]:
        """Return which of some nodes a node is in, or is, from the outermost on."""
        nodes = [node] if node in among else []
        while node in self._above:
            node = self._above[node]
            nodes += [node] if node in among else []
        return tuple(reversed(nodes))


def about_shaft(shaft: Shaft, degrees: Fraction) -> Frame:
    """Return the frame of what is turned about the shaft, counter-clockwise seen from B looking toward A."""
    if degrees % 360 == 0:
        return IDENTITY
    a, b = (tuple(map(Fraction, each.tolist())) for each in (shaft.bearing_a, shaft.bearing_b))
    turn = rotation(about([q - p for p, q in zip(a, b, strict=True)], degrees))
    return frame(turn, a).then(frame(UNTURNED, [-k for k in a]))
