"""The best way to put an assembly on a shaft: parts turned about it, parts that change places, parts on such parts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import product

import numpy as np

from inertia.arrays import Float
from inertia.assembly.frames import Frame
from inertia.assembly.lines import square
from inertia.assembly.rollup import place
from inertia.assembly.tree import Node
from inertia.balancing.arrangement import Answer, Choice
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.indexing import Indexing, best_answer
from inertia.balancing.unbalance import Complex
from inertia.documents import FieldError

_OUTER = 1000  # positions of parts that carry others which are put together as well
Copies = tuple[Frame, ...]


def best_way(
    frames: Mapping[Node, Copies],
    chains: Mapping[Node, tuple[Node, ...]],
    turning: Mapping[Node, tuple[Fraction, ...]],
    sets: Sequence[tuple[Node, ...]],
    shaft: Shaft,
    limits: Float,
    keys: Complex,
) -> tuple[dict[Node, Fraction], dict[Node, Node], Indexing]:
    """Return by how much each part is turned, degrees, whose place each of the exchanged ones takes, and what is left.

    Parameters
    ----------
    frames : of all copies of all nodes of the assembly
    chains : which of those that are turned a node is in, or is, from the outermost on
    turning : what may be turned, and by which angles, degrees
    sets : parts that may change places with each other
    shaft : in the axes of the assembly
    limits : (k,) kg m, in the tolerance planes
    keys : (k,) kg m, what else is on the shaft

    Raises `FieldError` where parts change places that are turned otherwise, or too much carries what is left open.
    """
    return _Search(frames, chains, turning, sets, shaft, limits, keys).result()


class _Search:
    def __init__(
        self,
        frames: Mapping[Node, Copies],
        chains: Mapping[Node, tuple[Node, ...]],
        turning: Mapping[Node, tuple[Fraction, ...]],
        sets: Sequence[tuple[Node, ...]],
        shaft: Shaft,
        limits: Float,
        keys: Complex,
    ) -> None:
        self.shaft, self.limits, self.turning, self.sets = shaft, limits, turning, sets
        exchanged = {node for nodes in sets for node in nodes}
        groups: dict[tuple[Node, ...], list[Node]] = {}
        for leaf in frames:
            if leaf.body is not None and leaf not in exchanged:
                groups.setdefault(chains[leaf], []).append(leaf)
        self.chains = [chains[nodes[0]] for nodes in sets]
        for nodes, chain in zip(sets, self.chains, strict=True):
            if any(chains[node] != chain for node in nodes):
                raise FieldError("mount", f"has {nodes[0].name} change places with a part that is turned otherwise")
        # Those on which something else is put together are tried one position after the other.
        self.outer = [
            node
            for node in turning
            if any(node in chain[:-1] for chain in groups) or any(node in chain for chain in self.chains)
        ]
        self.inner = [node for node in turning if node not in self.outer]
        self.keys = keys / limits
        self.parts = {
            chain: self._vectors([(leaf, frames[leaf]) for leaf in leaves]).sum(axis=0)
            for chain, leaves in groups.items()
        }
        self.orders = [
            self._vectors([(part, frames[slot]) for part in nodes for slot in nodes]).reshape(
                len(nodes), len(nodes), -1
            )
            for nodes in sets
        ]

    def _vectors(self, parts: Sequence[tuple[Node, Copies]]) -> Complex:
        """Return what parts bring to the planes in some frames, all copies together, (parts, planes) of the limits.

        With r from bearing A, along the shaft's axes, and L between the bearings: U_B = ∫(x + iy) z dm/L,
        U_A = ∫(x + iy) dm − U_B.
        """
        placed = place([node.body for node, _ in parts if node.body], [frames for _, frames in parts])
        axes, away = self.shaft.axes, placed.center - self.shaft.bearing_a
        mass, first = placed.moments[:, 0], placed.moments[:, 1:4]
        lever = np.einsum("ni,j->nij", first, away)
        second = square(placed.moments[:, 4:]) + lever + lever.swapaxes(1, 2)
        second = axes.T @ (second + mass[:, None, None] * np.outer(away, away)) @ axes
        static = (first + mass[:, None] * away) @ axes
        at_b = (second[:, 0, 2] + 1j * second[:, 1, 2]) / self.shaft.span
        copies = np.stack([static[:, 0] + 1j * static[:, 1] - at_b, at_b], axis=1) / self.limits
        ends = np.cumsum([len(frames) for _, frames in parts])[:-1]
        vectors: Complex = np.array([some.sum(axis=0) for some in np.split(copies, ends)])
        return vectors

    def _choice(self, outer: Mapping[Node, Fraction]) -> Choice:
        """Return what is left open once the outer parts are at these angles."""
        start = self.keys.copy()
        options = {node: np.zeros((len(self.turning[node]), len(start)), complex) for node in self.inner}
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

    def result(self) -> tuple[dict[Node, Fraction], dict[Node, Node], Indexing]:
        count = math.prod(len(self.turning[node]) for node in self.outer)
        if count > _OUTER:
            raise FieldError(
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
        return turns, slots, indexing


def _phase(degrees: Fraction | int) -> complex:
    """Return e^{iα}, exact for multiples of 90°."""
    quarter = Fraction(degrees) / 90
    if quarter.denominator == 1:
        return (1, 1j, -1, -1j)[int(quarter) % 4]
    angle = math.radians(float(Fraction(degrees) % 360))
    return complex(math.cos(angle), math.sin(angle))
