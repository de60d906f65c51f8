"""A rotor that is an assembly: its parts as bodies, how they are best put together, and how they are mounted.

The unbalance is that of the assembly's moments, which are turned and shifted exactly; the triangles of its parts are
what is cut, drawn and kept apart. A part that is turned about the shaft takes along what hangs on it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from fractions import Fraction
from itertools import product

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
from inertia.balancing.arrangement import Answer, Choice
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.bounds import Uncertainty
from inertia.balancing.facet_error import FacetLayers
from inertia.balancing.indexing import Indexing, best_answer
from inertia.balancing.mounting import Joint
from inertia.balancing.rotor import Rotor
from inertia.balancing.rotor_bodies import RotorBody, require_apart
from inertia.balancing.rotor_fields import MountFields
from inertia.balancing.unbalance import Complex, Unbalance
from inertia.documents import FieldError
from inertia.errors import InertiaError, UsageError, placed
from inertia.mass.analyse import analyse, sound_solids_only
from inertia.mass.density import DensityFrom
from inertia.mass.properties import MassProperties
from inertia.mesh.part import Part, Rounding, Surface
from inertia.mesh.turns import TURN_BITS, about

_SOLIDS = tuple(shape for shape, lengths in SIZES.items() if lengths)
_OUTER = 1000  # positions of parts that carry others which are put together as well
Copies = tuple[Frame, ...]


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
        return _Search(self, shaft, np.asarray(limits), keys, turning, sets).result()

    def chain(self, node: Node, among: Mapping[Node, object]) -> tuple[Node, ...]:
        """Return which of some nodes a node is in, or is, from the outermost on."""
        nodes = []
        while node in self._above or node in among:
            if node in among:
                nodes.append(node)
            if node not in self._above:
                break
            node = self._above[node]
        return tuple(reversed(nodes))


class _Search:
    """What is left open of a rotor that is put together, and how the best way is looked for."""

    def __init__(
        self,
        rotor: AssembledRotor,
        shaft: Shaft,
        limits: Float,
        keys: Complex,
        turning: Mapping[Node, tuple[Fraction, ...]],
        sets: Sequence[tuple[Node, ...]],
    ) -> None:
        self.rotor, self.shaft, self.limits, self.turning, self.sets = rotor, shaft, limits, turning, sets
        exchanged = {node for nodes in sets for node in nodes}
        groups: dict[tuple[Node, ...], list[Node]] = {}
        for leaf in rotor.tree.root.leaves:
            if leaf not in exchanged:
                groups.setdefault(rotor.chain(leaf, turning), []).append(leaf)
        self.chains = [rotor.chain(nodes[0], turning) for nodes in sets]
        for nodes, chain in zip(sets, self.chains, strict=True):
            if any(rotor.chain(node, turning) != chain for node in nodes):
                raise rotor._unusable(
                    "mount", f"has {nodes[0].name} change places with a part that is turned otherwise"
                )
        #: those on which something else is put together are tried one position after the other
        self.outer = [
            node
            for node in turning
            if any(node in chain[:-1] for chain in groups) or any(node in chain for chain in self.chains)
        ]
        self.inner = [node for node in turning if node not in self.outer]
        self.keys = keys / limits
        self.parts = {chain: self._vector(leaves) for chain, leaves in groups.items()}
        self.orders = [
            np.array([[self._vector([part], rotor.frames[slot]) for slot in nodes] for part in nodes]) for nodes in sets
        ]

    def _vector(self, leaves: Sequence[Node], frames: Copies | None = None) -> Complex:
        """Return what parts bring to the planes, in parts of the limits."""
        parts = [(leaf.body, self.rotor.frames[leaf] if frames is None else frames) for leaf in leaves if leaf.body]
        properties = place(*zip(*parts, strict=True)).properties
        zs = self.shaft.z_a, self.shaft.z_b
        vectors: Complex = Unbalance.of(properties, self.shaft).in_many_planes(zs) / self.limits
        return vectors

    def _choice(self, outer: Mapping[Node, Fraction]) -> Choice:
        """Return what is left open once the outer parts are at these angles."""
        start, options = (
            self.keys.copy(),
            {node: np.zeros((len(self.turning[node]), len(self.limits)), complex) for node in self.inner},
        )
        for chain, vector in self.parts.items():
            turned = vector * _phase(sum(outer.get(node, Fraction(0)) for node in chain))
            if chain and chain[-1] in options:
                phases = np.array([_phase(angle) for angle in self.turning[chain[-1]]])
                options[chain[-1]] += turned * phases[:, None]
            else:
                start += turned
        orders = [
            order * _phase(sum(outer.get(node, Fraction(0)) for node in chain))
            for order, chain in zip(self.orders, self.chains, strict=True)
        ]
        return Choice(start, tuple(options.values()), tuple(orders))

    def result(self) -> tuple[AssembledRotor, Indexing]:
        """Return the rotor put together the best way."""
        count = math.prod(len(self.turning[node]) for node in self.outer)
        if count > _OUTER:
            raise self.rotor._unusable(
                "mount",
                f"turns parts to {count} positions on which others are put together: {_OUTER} are the most that are "
                "tried, give fewer",
            )
        best: tuple[Answer, Choice, dict[Node, Fraction]] | None = None
        bound = math.inf
        for angles in product(*(self.turning[node] for node in self.outer)):
            outer = dict(zip(self.outer, angles, strict=True))
            choice = self._choice(outer)
            answer = best_answer(choice)
            bound = min(bound, answer.bound)
            if best is None or answer.left < best[0].left * (1 - 1e-12):
                best = answer, choice, outer
        assert best is not None, "there is one position at least"
        answer, choice, outer = best
        turns = outer | {node: self.turning[node][k] for node, k in zip(self.inner, answer.positions, strict=True)}
        slots = {
            part: nodes[place]
            for nodes, places in zip(self.sets, answer.places, strict=True)
            for part, place in zip(nodes, places, strict=True)
        }
        filed = self.keys + sum(self.parts.values()) + sum(order.diagonal().T.sum(axis=0) for order in self.orders)
        left = choice.sum(answer.positions, answer.places)
        indexing = Indexing(
            turns=tuple(math.radians(turns[node] % 360) for node in self.turning),
            left=answer.left,
            as_filed=float(np.abs(filed).max()),
            bound=bound,
            ways=count * choice.ways,
            names=tuple(node.name for node in self.turning),
            moves=tuple((part.name, slot.name) for part, slot in slots.items()),
            planes_as_filed=tuple((filed * self.limits).tolist()),
            planes_left=tuple((left * self.limits).tolist()),
        )
        return AssembledRotor(self.rotor.rotor, self._moved(turns, slots)), indexing

    def _moved(self, turns: Mapping[Node, Fraction], slots: Mapping[Node, Node]) -> Assembly:
        moves = {}
        for node in self.rotor.frames:
            slot = slots.get(node, node)
            angle = sum((turns[each] for each in self.rotor.chain(slot, turns)), Fraction(0))
            if angle % 360 or slot is not node:
                moves[node] = tuple(about_shaft(self.shaft, angle).then(each) for each in self.rotor.frames[slot])
        return self.rotor.tree.moved(moves)


def about_shaft(shaft: Shaft, degrees: Fraction) -> Frame:
    """Return the frame of what is turned about the shaft, counter-clockwise seen from B looking toward A."""
    if degrees % 360 == 0:
        return IDENTITY
    a, b = (tuple(map(Fraction, each.tolist())) for each in (shaft.bearing_a, shaft.bearing_b))
    turn = rotation(about([q - p for p, q in zip(a, b, strict=True)], degrees))
    return frame(turn, a).then(frame(UNTURNED, [-k for k in a]))


def _phase(degrees: Fraction | int) -> complex:
    """Return e^{iα}, exact for multiples of 90°."""
    quarter = Fraction(degrees) / 90
    if quarter.denominator == 1:
        return (1, 1j, -1, -1j)[int(quarter) % 4]
    angle = math.radians(float(Fraction(degrees) % 360))
    return complex(math.cos(angle), math.sin(angle))
