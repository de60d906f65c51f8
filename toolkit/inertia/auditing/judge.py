"""One link judged: what is stated of it against what its shapes have, and the findings that follow."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from inertia.arrays import Float
from inertia.auditing import densities as inversion
from inertia.auditing import physical
from inertia.auditing.bodies import Body, Shape
from inertia.auditing.claim import Context, Statement
from inertia.auditing.placeholder import placeholder
from inertia.auditing.search import Explanation, Search, pairs, singles
from inertia.exchange.robots.links import Placement
from inertia.mass.properties import MassProperties

State = Literal["consistent", "inconsistent", "unphysical", "unjudged"]

LIGHTEST = 10.0
"""kg/m³, below which nothing that carries a load lies."""


@dataclass(frozen=True)
class Finding:
    """What is known of a difference.

    Attributes
    ----------
    code : of its kind, as in ``missing_steiner``
    sentence : what it is
    residual : what is left of the difference when it is undone, relative; None where nothing is undone
    remedy : what mends it, as an imperative; "" where nothing does
    """

    code: str
    sentence: str
    residual: float | None = None
    remedy: str = ""


@dataclass(frozen=True, eq=False)
class Difference:
    """Stated against computed: mass and tensor (Frobenius norm) relative, the centre of mass in metres."""

    mass: float
    center_of_mass: float
    inertia: float


@dataclass(frozen=True, eq=False)
class LinkAudit:
    """What was found out about a link.

    Attributes
    ----------
    name : as in the file
    state : "consistent", "inconsistent", "unphysical" (no body can have it), "unjudged" (nothing to compare with)
    stated : mass, centre of mass (m) and tensor (kg m², about it), link axes; None where the file states nothing
    computed : the same of the shapes, with its bounds; None where they cannot be weighed
    densities : (n,) kg/m³, one a shape, that `computed` was weighed with
    difference : between the two; None where one is missing
    findings : best first
    margin : of the triangle rule, (I1 + I2 − I3) / I3; None where nothing is stated
    shapes : what was weighed
    """

    name: str
    state: State
    stated: Body | None
    computed: MassProperties | None
    densities: tuple[float, ...]
    difference: Difference | None
    findings: tuple[Finding, ...]
    margin: float | None = None
    shapes: tuple[Shape, ...] = ()


@dataclass(frozen=True, eq=False)
class Weighed:
    """A shape with its mass properties at 1 kg/m³ in the axes of the link, bounds included."""

    shape: Shape
    properties: MassProperties

    def moved(self, where: Placement) -> Weighed:
        """Return it in the axes that those of the link are placed in."""
        return Weighed(self.shape.moved(where.rotation, where.origin), placed(self.properties, where))


def placed(properties: MassProperties, where: Placement) -> MassProperties:
    """Return a body of the axes that are placed so in others, seen from those."""
    if not where.origin.any() and np.array_equal(where.rotation, np.eye(3)):
        return properties
    turned = where.rotation.T
    return properties.expressed_in(turned, -turned @ where.origin)


@dataclass(frozen=True, eq=False)
class Subject:
    """A link as it is judged.

    Attributes
    ----------
    name, stated : None where the file states nothing
    shapes, collisions : what is weighed, and the geometry for collisions
    densities : kg/m³ a shape, where they are known
    obstacles : what kept shapes from being weighed
    notes : what had to be done to weigh them
    substitute : whether the shapes stand in for others that could not be weighed
    """

    name: str
    stated: Statement | None
    shapes: Sequence[Weighed] = ()
    collisions: Sequence[Weighed] = ()
    densities: Sequence[float] | None = None
    obstacles: Sequence[Finding] = ()
    notes: Sequence[Finding] = ()
    substitute: bool = False

    @property
    def context(self) -> Context | None:
        """What its claims are made about; None where there is nothing to compare."""
        if self.stated is None or not self.shapes or not self.stated.body.mass > 0:
            return None
        shapes, collisions = ([each.shape for each in some] for some in (self.shapes, self.collisions))
        return Context(self.stated, shapes, collisions, self.densities)


def judge(subject: Subject, others: Sequence[Subject], tolerance: float) -> LinkAudit:
    """Return what can be said of a link.

    Parameters
    ----------
    others : the other links of the file, whose numbers may have been copied
    tolerance : relative difference up to which stated and computed agree
    """
    stated = subject.stated
    if stated is None:
        missing = Finding("nothing_stated", "the file states no mass properties for it")
        return LinkAudit(subject.name, "unjudged", None, None, (), None, (missing, *subject.obstacles))
    if stated.body.mass == 0 and not stated.body.inertia.any():
        frame = Finding("nothing_stated", "the file states a mass of 0 and no tensor: it counts as a frame")
        return LinkAudit(subject.name, "unjudged", None, None, (), None, (frame,))
    faults = [Finding("unphysical", fault.sentence) for fault in physical.faults(stated)]
    margin = physical.margin(stated)
    context = subject.context
    if context is None or subject.obstacles:
        findings = (*faults, *subject.obstacles)
        if not subject.shapes and not subject.obstacles:
            findings = (*faults, Finding("no_geometry", "it has no mesh or primitive to compare with"))
        state: State = "unphysical" if faults else "unjudged"
        return LinkAudit(subject.name, state, stated.body, None, (), None, findings, margin)
    computed, weights = _computed(subject, context)
    faults += [Finding("outside_hull", fault.sentence) for fault in physical.outside(stated, _hull(subject))]
    difference = _difference(stated.body, computed)
    worst = max(difference.mass, difference.inertia, difference.center_of_mass / context.size)
    doubt = max(computed.error.mass, computed.error.inertia, computed.error.center_of_mass / context.size)
    named: list[Finding] = []
    state = "consistent"
    if worst > tolerance:
        state, named, better = _explained(context, subject, others, tolerance)
        if better is not None:
            weights = better.values
            computed = _sum(subject, weights)
            difference = _difference(stated.body, computed)
    elif implausible := _implausible(weights):
        state, named = "inconsistent", [implausible]
    if state == "inconsistent" and any(fault.code == "outside_hull" for fault in faults) and subject.substitute:
        faults = [fault for fault in faults if fault.code != "outside_hull"]
    if abs(worst - tolerance) <= doubt and state in {"consistent", "inconsistent"} and doubt > tolerance / 10:
        state = "unjudged"
        words = f"the meshes leave it open: the difference of {100 * worst:.2g} % has a bound of {100 * doubt:.2g} %"
        named = [Finding("undecided", words), *named]
    if state == "inconsistent" and subject.substitute and named[0].code in {"unexplained", "ambiguous"}:
        state = "unjudged"  # the shapes themselves may agree with what is stated
    named += subject.notes
    if faults:
        state = "unphysical" if any(fault.code == "unphysical" for fault in faults) else "inconsistent"
    return LinkAudit(
        subject.name,
        state,
        stated.body,
        computed,
        tuple(float(weight) for weight in weights),
        difference,
        (*faults, *named),
        margin,
        tuple(each.shape for each in subject.shapes),
    )


def _explained(
    context: Context, subject: Subject, others: Sequence[Subject], tolerance: float
) -> tuple[State, list[Finding], inversion.Densities | None]:
    """Return state and findings of a difference, and the densities that resolve it, if that is what does."""
    about = ((other.name, other.stated, other.context) for other in others if other.stated is not None)
    if words := placeholder(context, about):
        return "inconsistent", [Finding("placeholder", words, None, "state what the meshes have")], None
    search = singles(context, tolerance)
    if search.named is None and context.densities is None:
        densities = inversion.invert(context)
        if densities is not None and densities.residual <= tolerance and densities.values.min() >= LIGHTEST:
            return "consistent", [_inverted(densities, subject)], densities
    if not search.candidates:
        search = pairs(context, tolerance)
    return "inconsistent", list(_findings(search)), None


def _inverted(densities: inversion.Densities, subject: Subject) -> Finding:
    pairs = zip(subject.shapes, densities.values, strict=True)
    values = ", ".join(f"{each.shape.name} {value:.4g}" for each, value in pairs)
    only = "no others do" if densities.unique else "others may do so too"
    return Finding("densities", f"densities of {values} kg/m³ reproduce it; {only}", densities.residual)


def _findings(search: Search) -> Iterator[Finding]:
    if search.named is not None:
        for mistake in search.named.mistakes:
            yield Finding(mistake.code, mistake.words, search.named.residual, mistake.remedy)
    elif search.candidates:
        words = ", or ".join(_words(candidate) for candidate in search.candidates[:3])
        yield Finding("ambiguous", f"more than one mistake explains it: {words}", search.candidates[0].residual)
    else:
        yield Finding("unexplained", "it differs from solids of one density, by no mistake known here")


def _words(explanation: Explanation) -> str:
    words = " and ".join(mistake.words for mistake in explanation.mistakes)
    return f"{words} ({100 * explanation.residual:.2g} % remain)"


def _implausible(weights: Float) -> Finding | None:
    heaviest, lightest = float(max(weights)), float(min(weights))
    if heaviest > inversion.DENSEST:
        words = f"the mass asks for a density of {heaviest:.3g} kg/m³, which no material has: grams for kilograms?"
        return Finding("mass_scale", words, None, "state mass and tensor in kilograms")
    if lightest < LIGHTEST / 10:
        words = f"the mass asks for a density of {lightest:.3g} kg/m³, lighter than any material"
        return Finding("mass_scale", words, None, "check the unit of the mass, and the scale of the meshes")
    return None


def _computed(subject: Subject, context: Context) -> tuple[MassProperties, Float]:
    if subject.densities is not None:
        weights = np.array(subject.densities, float)
        return _sum(subject, weights), weights
    volume = sum(each.properties.volume for each in subject.shapes)
    density = context.stated.body.mass / volume
    whole = _sum(subject, np.ones(len(subject.shapes))).with_mass(context.stated.body.mass)
    return whole, np.full(len(subject.shapes), density)


def _sum(subject: Subject, weights: Float) -> MassProperties:
    """Return the shapes together, with their Steiner terms and bounds."""
    whole: MassProperties | None = None
    for each, weight in zip(subject.shapes, weights, strict=True):
        if weight > 0:
            weighed = each.properties
            if weight != 1:
                weighed = weighed.with_mass(each.properties.mass * float(weight))
            whole = weighed if whole is None else whole + weighed
    assert whole is not None
    return whole


def _difference(stated: Body, computed: MassProperties) -> Difference:
    tensors = max(float(np.linalg.norm(stated.inertia)), float(np.linalg.norm(computed.inertia)))
    return Difference(
        abs(stated.mass - computed.mass) / max(stated.mass, computed.mass),
        float(np.linalg.norm(stated.center - computed.center_of_mass)),
        float(np.linalg.norm(stated.inertia - computed.inertia)) / tensors,
    )


def _hull(subject: Subject) -> Float:
    """Return the triangles of the convex hull of all shapes, those for collisions included."""
    every = [*subject.shapes, *subject.collisions]
    corners = np.concatenate([(e.shape.corners if e.shape.hull is None else e.shape.hull) for e in every])
    whole = Shape("all", corners, Body(0.0, np.zeros(3), np.zeros((3, 3))), np.eye(3), np.zeros(3))
    return corners if whole.hull is None else whole.hull
