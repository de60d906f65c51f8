"""One link judged: what is stated of it against what its shapes have, and the findings that follow."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Literal

import numpy as np

from inertia.arrays import Float
from inertia.auditing import densities as inversion
from inertia.auditing import physical
from inertia.auditing.bodies import Body, Shape, norm
from inertia.auditing.claim import Context, Statement
from inertia.auditing.placeholder import placeholder
from inertia.auditing.search import Explanation, Search, pairs, singles
from inertia.errors import InertiaError
from inertia.exchange.robots.links import Placement
from inertia.mass.properties import MassProperties, stretched
from inertia.mesh.tree import ONE
from inertia.records import dataclass

State = Literal["consistent", "inconsistent", "unphysical", "unjudged"]

_EXACTLY = 1e-3
"""Residual at which a mistake is no coincidence: twice the mass is counted twice, round moments are a sphere's."""

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
    link : the name of the link that it is of
    """

    code: str
    sentence: str
    residual: float | None = None
    remedy: str = ""
    link: str = ""


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
    room : what the faults of their meshes leave open, relative; it is in the bounds of `computed`
    mended : what the file should state; None where nothing is to be mended, or what is not known
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
    room: float = 0.0
    mended: MassProperties | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "findings", tuple(replace(each, link=self.name) for each in self.findings))

    @property
    def comparable(self) -> bool:
        """Whether the file has both sides of a comparison: mass properties, and geometry, be it readable or not."""
        return self.stated is not None and all(finding.code != "no_geometry" for finding in self.findings)


@dataclass(frozen=True, eq=False)
class Weighed:
    """A shape with its mass properties at 1 kg/m³ in the axes of the link, bounds included.

    `room` is what the faults of its mesh leave open, relative; it is in these bounds.
    """

    shape: Shape
    properties: MassProperties
    room: float = 0.0

    def moved(self, where: Placement) -> Weighed:
        """Return it in the axes that those of the link are placed in."""
        return Weighed(self.shape.moved(where.rotation, where.origin), placed(self.properties, where), self.room)


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
    fault : why what is stated cannot be read, a sentence; "" where it can
    """

    name: str
    stated: Statement | None
    shapes: Sequence[Weighed] = ()
    collisions: Sequence[Weighed] = ()
    densities: Sequence[float] | None = None
    obstacles: Sequence[Finding] = ()
    notes: Sequence[Finding] = ()
    substitute: bool = False
    fault: str = ""

    @cached_property
    def figures(self) -> tuple[float, ...]:
        """Centre of mass and tensor as the file writes them; nothing where it states nothing."""
        if self.stated is None:
            return ()
        return (*self.stated.body.center.tolist(), *self.stated.written.ravel().tolist())

    @cached_property
    def context(self) -> Context | None:
        """What its claims are made about; None where there is nothing to compare."""
        if self.stated is None or not self.shapes or not self.stated.body.mass > 0:
            return None
        shapes, collisions = ([each.shape for each in some] for some in (self.shapes, self.collisions))
        return Context(self.stated, shapes, collisions, self.densities)


def judge(subject: Subject, alike: Sequence[Subject], tolerance: float) -> LinkAudit:
    """Return what can be said of a link.

    Parameters
    ----------
    alike : the links of the file with the same centre and tensor, which may have been copied
    tolerance : relative difference up to which stated and computed agree
    """
    stated, name = subject.stated, subject.name
    if subject.fault:
        unreadable = Finding("unreadable", subject.fault, None, "state it anew")
        return LinkAudit(name, "inconsistent", None, None, (), None, (unreadable, *subject.obstacles))
    if stated is None or (stated.body.mass == 0 and not stated.body.inertia.any()):
        words = (
            "no mass properties for it, or none that count"
            if stated is None
            else "a mass of 0 and no tensor: it counts as a frame"
        )
        missing = Finding("nothing_stated", f"the file states {words}")
        return LinkAudit(name, "unjudged", None, None, (), None, (missing, *subject.obstacles))
    faults = [Finding("unphysical", fault.sentence) for fault in physical.faults(stated)]
    margin = physical.margin(stated)
    context = subject.context
    if context is None or subject.obstacles:
        findings = (*faults, *subject.obstacles)
        if not subject.shapes and not subject.obstacles:
            findings = (*faults, Finding("no_geometry", "it has no mesh or primitive to compare with"))
        return LinkAudit(name, "unphysical" if faults else "unjudged", stated.body, None, (), None, findings, margin)
    try:
        with np.errstate(all="ignore"):  # nothing is explained by what is no number
            judgement = _judgement(subject, context, alike, tolerance)
            if not subject.substitute and not judgement.of_mesh and judgement.state != "consistent":
                faults += [
                    Finding("outside_hull", fault.sentence) for fault in physical.outside(stated, _hull(subject))
                ]
    except (InertiaError, np.linalg.LinAlgError):  # the shapes are weighed already, but not at that mass
        words = f"with the stated mass of {stated.body.mass:g} kg the comparison leaves float64"
        undecided = (*faults, Finding("undecided", words), *subject.notes)
        return LinkAudit(name, "unphysical" if faults else "unjudged", stated.body, None, (), None, undecided, margin)
    state, findings = judgement.state, (*faults, *judgement.findings, *subject.notes)
    if faults:
        state = "unphysical" if faults[0].code == "unphysical" else "inconsistent"
    sound = not subject.substitute and all(each.room <= tolerance for each in subject.shapes)
    impossible = any(fault.code == "unphysical" for fault in faults)  # a hull may lack what has some of the mass
    mendable = sound and not judgement.of_mesh and (judgement.mendable or impossible)
    return LinkAudit(
        name,
        state,
        stated.body,
        judgement.computed,
        tuple(float(weight) for weight in judgement.weights),
        _difference(stated.body, judgement.computed),
        findings,
        margin,
        tuple(each.shape for each in subject.shapes),
        max(each.room for each in subject.shapes),
        judgement.computed if mendable and state != "consistent" else None,
    )


@dataclass(frozen=True, eq=False)
class _Judgement:
    """What a comparison leads to, with the mass properties and densities (kg/m³ a shape) that it ended with.

    `of_mesh` is set where the meshes are wrong, so that nothing is to be mended by them.
    """

    state: State
    findings: tuple[Finding, ...]
    computed: MassProperties
    weights: Float
    mendable: bool = False
    of_mesh: bool = False


def _judgement(subject: Subject, context: Context, alike: Sequence[Subject], tolerance: float) -> _Judgement:
    """Compare what is stated with what the shapes have, and look for what explains a difference."""
    computed, weights = _computed(subject, context)
    difference = _difference(context.stated.body, computed)
    worst = max(difference.mass, difference.inertia, difference.center_of_mass / context.size)
    error = computed.error
    doubt = max(error.mass, error.inertia, error.center_of_mass / context.size)
    if doubt > tolerance / 10 and abs(worst - tolerance) <= doubt and worst > _EXACTLY:
        words = f"the meshes leave it open: the difference of {100 * worst:.2g} % has a bound of {100 * doubt:.2g} %"
        return _Judgement("unjudged", (Finding("undecided", words),), computed, weights)
    if worst <= tolerance:
        if implausible := _implausible(weights):
            return _Judgement("inconsistent", (implausible,), computed, weights)
        return _Judgement("consistent", (), computed, weights)
    rest = ((other.name, other.context) for other in alike if other is not subject)
    search = singles(context, tolerance)
    named = search.named  # the moments of a sphere may be round, and zeros may be what rounding leaves
    exactly = named is not None and named.residual <= _EXACTLY and named.codes != {"rounded"}
    if not exactly and (why := placeholder(context, rest)):
        finding = Finding("placeholder", why, None, "state what the meshes have")
        return _Judgement("inconsistent", (finding,), computed, weights, mendable=True)
    densities = _densities(context, search, tolerance)
    if densities is not None and densities.telling:
        finding = _inverted(densities, subject)
        return _Judgement("consistent", (finding,), _sum(subject, densities.values), densities.values)
    if not search.candidates:
        search = pairs(context, tolerance)
    if search.named is None and densities is not None:
        words = "densities that differ from mesh to mesh reproduce it, but so many can be made to fit almost anything"
        return _Judgement("unjudged", (Finding("undecided", words, densities.residual),), computed, weights)
    findings = tuple(_findings(search))
    if search.named is None:
        if not search.candidates and context.densities is None and (implausible := _implausible(weights)):
            findings += (implausible,)  # in another unit, and with what is not known here
        doubtful = subject.substitute or any(each.room > tolerance / 10 for each in subject.shapes)
        state: State = "unjudged" if doubtful else "inconsistent"
        return _Judgement(state, findings, computed, weights)
    factor = math.prod(mistake.mass for mistake in search.named.mistakes)
    if factor != 1 and context.densities is None:
        computed, weights = computed.with_mass(factor * computed.mass), factor * weights
    of_mesh = any(mistake.of_mesh for mistake in search.named.mistakes)
    return _Judgement("inconsistent", findings, computed, weights, not of_mesh, of_mesh)


def _densities(context: Context, search: Search, tolerance: float) -> inversion.Densities | None:
    """Return densities of the shapes that reproduce what is stated, unless one mistake does it as well."""
    if context.densities is not None:
        return None
    named = search.named
    if named is not None and (named.residual <= _EXACTLY or named.codes != {"mesh_counted_twice"}):
        return None
    densities = inversion.invert(context)
    if densities is None or densities.residual > tolerance or densities.values.min() < LIGHTEST:
        return None
    return densities if named is None or densities.residual < named.residual / 2 else None


def _inverted(densities: inversion.Densities, subject: Subject) -> Finding:
    pairs = zip(subject.shapes, densities.values, strict=True)
    values = ", ".join(f"{each.shape.name} {value:.4g}" for each, value in pairs)
    only = "no others do" if densities.unique else "others may do so too"
    return Finding("densities", f"densities of {values} kg/m³ reproduce it; {only}", densities.residual)


def _findings(search: Search) -> Iterator[Finding]:
    if search.named is not None:
        for mistake in search.named.mistakes:
            yield Finding(mistake.code, mistake.words, search.named.residual, mistake.remedy)
        if search.named.alike:
            words = ", or ".join(_words(each) for each in search.named.alike[:2])
            yield Finding("alike", f"with this link it comes to the same that {words}")
    elif search.candidates:
        words = ", or ".join(f"{_words(each)} ({100 * each.residual:.2g} % remain)" for each in search.candidates[:3])
        yield Finding("ambiguous", f"more than one mistake explains it: {words}", search.candidates[0].residual)
    else:
        yield Finding("unexplained", "it differs from solids of one density, by no mistake known here")


def _words(explanation: Explanation) -> str:
    return " and ".join(mistake.words for mistake in explanation.mistakes)


def _implausible(weights: Float) -> Finding | None:
    heaviest, lightest = float(max(weights)), float(min(weights))
    least, greatest = inversion.PLAUSIBLE
    if heaviest > greatest:
        words = f"the mass asks for a density of {heaviest:.3g} kg/m³, which no material has: grams for kilograms?"
        return Finding("mass_scale", words, None, "state mass and tensor in kilograms")
    if lightest < least:
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
                weighed = stretched(weighed, ONE, Fraction(float(weight)))
            whole = weighed if whole is None else whole + weighed
    assert whole is not None
    return whole


def _difference(stated: Body, computed: MassProperties) -> Difference:
    tensors = max(norm(stated.inertia), norm(computed.inertia))
    return Difference(
        abs(stated.mass - computed.mass) / max(stated.mass, computed.mass),
        norm(stated.center - computed.center_of_mass),
        norm(stated.inertia - computed.inertia) / tensors if tensors else 0.0,  # both below what float64 holds
    )


def _hull(subject: Subject) -> Float:
    """Return the triangles of the convex hull of all shapes, those for collisions included."""
    every = [*subject.shapes, *subject.collisions]
    if len(every) == 1 and every[0].shape.hull is not None:
        return every[0].shape.hull
    corners = np.concatenate([(e.shape.corners if e.shape.hull is None else e.shape.hull) for e in every])
    whole = Shape("all", corners, Body(0.0, np.zeros(3), np.zeros((3, 3))), np.eye(3), np.zeros(3))
    return corners if whole.hull is None else whole.hull
