"""What a person would have written who made given mistakes, and how far that is from what a file states."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from inertia.arrays import Float
from inertia.auditing.bodies import Body, Shape, norm, together
from inertia.exchange.robots.links import Figures
from inertia.records import dataclass

_SMALL = 0.02
"""Of the largest: elements that are smaller count as if they were as large."""

Step = Callable[["Context", Body], Body]
"""What is made of a body as it is written down."""


@dataclass(frozen=True, eq=False)
class Statement:
    """What a file states of a link.

    Attributes
    ----------
    body : mass, centre (3,) m and tensor about it, in the axes of the link
    rotation : (3, 3), the axes in which the file writes the tensor, in those of the link
    figures : how the centre and the tensor are written; None where that is not known
    integrals : whether the fields of the products are for positive integrals
    """

    body: Body
    rotation: Float
    figures: tuple[Figures | None, Figures | None] = (None, None)
    integrals: bool = False

    @cached_property
    def written(self) -> Float:
        """The tensor (3, 3) along the axes in which the file writes it."""
        return self.rotation.T @ self.body.inertia @ self.rotation


@dataclass(frozen=True, eq=False)
class Context:
    """What a claim is made about: the statement, the shapes of the link and those for collisions, and their densities.

    `densities` (kg/m³ a shape) are None where the shapes are of one density that reproduces the stated mass.
    """

    stated: Statement
    shapes: Sequence[Shape]
    collisions: Sequence[Shape] = ()
    densities: Sequence[float] | None = None

    @cached_property
    def size(self) -> float:
        """Length of the diagonal of the box around the shapes, or the way from it to the stated centre if longer, m."""
        low, high = (np.array(ends) for ends in zip(*(shape.box for shape in self.shapes), strict=True))
        low, high = low.min(axis=0), high.max(axis=0)
        center = self.stated.body.center
        beyond = np.maximum(low - center, center - high).clip(min=0)
        return max(norm(high - low), norm(beyond))

    @cached_property
    def truth(self) -> Claim:
        """What there is to be stated."""
        bodies = [shape.solid for shape in self.shapes]
        if self.densities is not None:
            bodies = [body.weighed(density) for body, density in zip(bodies, self.densities, strict=True)]
        return Claim(self, tuple(bodies), (1,) * len(bodies))


@dataclass(frozen=True, eq=False)
class Claim:
    """Bodies put together and written down in a way that may be mistaken.

    Attributes
    ----------
    bodies : in the axes of the link, of density 1 if the densities are not known
    copies : how often each counts
    steiner : whether the bodies were put together with the terms of Steiner's theorem
    before, step : the claim that this one makes something else of, and what; a mistake of a later stage keeps both
    """

    context: Context
    bodies: tuple[Body, ...]
    copies: tuple[int, ...]
    steiner: bool = True
    before: Claim | None = None
    step: Step | None = None

    def then(self, step: Step) -> Claim:
        """Return the claim with one more step after the bodies were put together."""
        return replace(self, before=self, step=step)

    @cached_property
    def body(self) -> Body:
        """What would be stated, of the stated mass where densities are not known."""
        if self.before is not None and self.step is not None:
            return self.step(self.context, self.before.body)
        bodies = [body for body, count in zip(self.bodies, self.copies, strict=True) for _ in range(count)]
        whole = together(bodies, steiner=self.steiner)
        if self.context.densities is None:
            whole = whole.weighed(self.context.stated.body.mass / whole.mass)
        return whole

    @cached_property
    def residual(self) -> float:
        """How far that is from what is stated: the largest of three relative differences.

        Of the masses; of the tensors (Frobenius norm, over the larger one); of the centres, over the size of the link.
        """
        return difference(self.context, self.body, self.context.stated.body)


def mismatch(context: Context, body: Body) -> float:
    """Return how badly a body fits what is stated, by the root mean square of elements each over its own size.

    Small elements count for more than in `difference`: a product of inertia with the wrong sign is told from one with
    the right sign even where it is 1 % of the tensor.
    """
    stated = context.stated.body
    worst = []
    for one, other, size in (
        (body.inertia, stated.inertia, norm(stated.inertia)),
        (body.center, stated.center, context.size),
    ):
        worst.append((one - other) / (np.abs(other) + max(_SMALL * size, np.finfo(float).tiny)))
    every = np.concatenate([each.ravel() for each in worst])
    return float(np.sqrt(np.mean(every**2)))


def difference(context: Context, one: Body, other: Body) -> float:
    """Return the largest of the relative differences of mass, tensor and centre (over the size) of two bodies."""
    mass = abs(one.mass - other.mass) / max(abs(one.mass), abs(other.mass), np.finfo(float).smallest_subnormal)
    norms = max(norm(one.inertia), norm(other.inertia), np.finfo(float).smallest_subnormal)
    tensor = norm(one.inertia - other.inertia) / norms
    center = norm(one.center - other.center) / context.size
    worst = max(mass, tensor, center)
    return worst if np.isfinite(worst) else np.inf


@dataclass(frozen=True)
class Mistake:
    """One way in which numbers go wrong.

    Attributes
    ----------
    code : of the kind of mistake, as in ``product_signs``
    stage : when it is made: -1 as the meshes are scaled, 0 as the shapes are chosen, 1 as they are counted, 2 as they
        are put together, 3 at the point, axes and signs, 5 at the units, 6 afterwards
    words : "the tensor is written about the link's origin, not about the centre of mass"
    remedy : what mends it, as an imperative
    make : what a claim becomes by it; that of other shapes has a context of its own, whose size it is measured by
    mass : what the stated mass times is the right one
    of_mesh : whether the meshes are wrong, and not what is stated
    density : what the density that the mass asks for times is the right one; None where it says nothing
    blur : how far facets that stand for what is round leave what it leads to open, relative
    """

    code: str
    stage: int
    words: str
    remedy: str
    make: Callable[[Claim], Claim]
    mass: float = 1.0
    of_mesh: bool = False
    density: float | None = None
    blur: float = 0.0


Kind = Callable[[Context], Iterable[Mistake]]
"""Return the ways in which one kind of mistake can be made with a link."""
