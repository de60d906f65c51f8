"""A robot's stated mass properties audited, link by link, against those of its meshes."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from inertia.arrays import Progress
from inertia.auditing.bodies import Body, together
from inertia.auditing.claim import Statement
from inertia.auditing.judge import Finding, LinkAudit, Subject, Weighed, judge
from inertia.auditing.search import EXPLAINED
from inertia.auditing.shapes import Scales, cause
from inertia.errors import InertiaError, ReadError, UsageError, placed, visible
from inertia.estimate import uncertainty_of
from inertia.exchange.robots.links import Geometry, Link, Placement, Robot
from inertia.exchange.robots.mend import Mended, mend
from inertia.exchange.robots.read import read_robot
from inertia.exchange.robots.solids import inertial_of
from inertia.records import dataclass
from inertia.standard_input import file_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_NAMED = 8  # shapes that a refusal lists
_SAME_CENTER = 1e-4
"""Of the largest radius of gyration: a centre of mass that is no farther off is left as it is written."""

_Groups = dict[str, list[tuple[str, Placement]]]
"""Links by the one that they hang from by fixed joints, and where they lie in its axes."""

Verdict = Literal["consistent", "inconsistent", "undecided"]


@dataclass(frozen=True, eq=False)
class Audit:
    """Stated against computed mass properties, link by link.

    Attributes
    ----------
    robot : what was read
    sha256 : of the file
    tolerance : relative difference up to which stated and computed agree
    verdict : "inconsistent" if a link is inconsistent or unphysical; else "undecided" if one that has mass properties
        and geometry could not be judged, as where its mesh is not there, or if none could be; else "consistent"
    links : in the file's order
    findings : of all links, in their order; each says its link
    """

    robot: Robot
    sha256: str
    tolerance: float
    links: tuple[LinkAudit, ...]

    @property
    def verdict(self) -> Verdict:
        """What follows from the links."""
        states = {link.state for link in self.links}
        if states & {"inconsistent", "unphysical"}:
            return "inconsistent"
        left = any(link.state == "unjudged" and link.comparable for link in self.links)
        return "consistent" if "consistent" in states and not left else "undecided"

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What was found, link by link."""
        return tuple(finding for link in self.links for finding in link.findings)

    def plot(self, ax: Axes | None = None) -> Figure:
        """Draw by how much the stated tensor of each link is off, beside the tolerance, and return the figure.

        Raises `UsageError` where matplotlib is not installed.
        """
        from inertia.palette import BLUE, GREEN, VERMILLION
        from inertia.plotting import figure_of

        def draw(axes: Axes) -> None:
            links, colors = self.links[::-1], {"consistent": GREEN, "unjudged": BLUE}
            sizes = [0.0 if link.difference is None else link.difference.inertia for link in links]
            axes.barh(range(len(links)), sizes, color=[colors.get(link.state, VERMILLION) for link in links])
            axes.axvline(self.tolerance, color="#555555", linewidth=1.0)
            axes.set_yticks(range(len(links)), [visible(link.name) for link in links])
            axes.set_xlabel("difference of the tensors, relative")

        return figure_of(draw, ax, f"{visible(self.robot.name or self.robot.path.name)}: {self.verdict}")

    def _repr_html_(self) -> str:
        """Return a small table, as a notebook shows it."""
        from inertia.notebook import html_of

        rows = [("Robot", f"{self.robot.name or self.robot.path.name}: {self.verdict}")]
        for link in self.links:
            off = "" if link.difference is None else f", tensor off by {100 * link.difference.inertia:.3g} %"
            says = "".join(f"; {finding.sentence}" for finding in link.findings if link.state != "consistent")
            rows.append((link.name, f"{link.state}{off}{says}"))
        return html_of([*rows, *(("Note", note) for note in self.robot.notes)])

    def fixed(self) -> bytes:
        """Return the file with the mass properties of mistaken links mended, and nothing else changed.

        Links whose difference no mistake explains, unless no body can have what is stated, those that were not judged
        by their own meshes, and those that are stated elsewhere stay as they are: see `unmended`.

        Raises `UsageError` where the format cannot be written into, or links were lumped.
        """
        return self._mending[0]

    @property
    def unmended(self) -> tuple[str, ...]:
        """Which links `fixed` leaves as they are although they differ, and why, in sentences; raises as it does."""
        left = self._mending[1]
        reasons = (
            (link.name, left.get(link.name, "") if link.mended is not None else _why_not(link))
            for link in self.links
            if link.state in ("inconsistent", "unphysical")
        )
        return tuple(f"{name} stays as it is: {why}" for name, why in reasons if why)

    @cached_property
    def _mending(self) -> tuple[bytes, dict[str, str]]:
        if {link.name for link in self.robot.links} != {link.name for link in self.links}:
            raise UsageError("links that were lumped are not those of the file: audit it without lumping to mend it")
        mended = {
            link.name: Mended(link.mended, _cause(link), _center_agrees(link))
            for link in self.links
            if link.mended is not None
        }
        return mend(self.robot, mended)


def audit(
    path: str | Path,
    *,
    densities: float | Mapping[str, float] | None = None,
    tolerance: float = EXPLAINED,
    lump: bool = False,
    progress: Progress | None = None,
) -> Audit:
    """Compare the mass properties that a robot's file states with those of the meshes of each link.

    A link's meshes are taken for solids of one density that reproduces the stated mass, unless densities are given.
    Where stated and computed differ, the mistakes are searched for that lead from one to the other.

    Parameters
    ----------
    path : a robot: URDF, MJCF, SDFormat or USD, or a list of parts as CSV or TOML
    densities : kg/m³ of all meshes, or of each by its file's name, with folders where these tell files apart ("" is
        the rest)
    tolerance : relative difference (mass, tensor, centre of mass over the size of the link) up to which they agree
    lump : links that hang together by fixed joints count as one, as simulators merge them

    Raises
    ------
    ReadError : the file cannot be read
    UsageError : an argument is not usable
    """
    if not 0 < tolerance < 1:
        raise UsageError(f"the tolerance is {tolerance:g}: it must lie between 0 and 1")
    for name, density in (densities if isinstance(densities, Mapping) else {"": densities}).items():
        of = f" of {visible(name)!r}" if name else ""
        if density is not None and not 0 < density < math.inf:
            raise UsageError(f"the density{of} is {density:g} kg/m³: it must be positive and finite")
        if density is not None and uncertainty_of(density):
            words = "has an uncertainty, which an audit does not take: give the number alone"
            raise UsageError(f"the density{of} of {density:g} kg/m³ {words}")
    robot = read_robot(path)
    if isinstance(densities, Mapping):
        _require_known(densities, robot)
    scales = Scales()
    subjects = []
    for number, link in enumerate(robot.links):
        subjects.append(_subject(link, scales, densities))
        if progress is not None:
            progress((number + 1) / len(robot.links))
    try:
        groups = _fixed_together(robot)
    except ReadError as error:
        if lump:
            raise placed(error, str(robot.path)) from None
        robot = replace(robot, notes=(*robot.notes, str(error)))
    if lump:
        subjects = list(_lumped(groups, subjects))
    alike: dict[tuple[float, ...], list[Subject]] = {}
    for subject in subjects:
        alike.setdefault(subject.figures, []).append(subject)
    links = tuple(judge(subject, alike[subject.figures], tolerance) for subject in subjects)
    return Audit(robot, sha256(file_of(str(robot.path)).read_bytes()).hexdigest(), tolerance, links)


def _cause(link: LinkAudit) -> str:
    """Return the mistakes that are named; where none is, why what is stated is impossible."""
    named = [finding.sentence for finding in link.findings if finding.remedy]
    return "; and ".join(named) or link.findings[0].sentence


def _why_not(link: LinkAudit) -> str:
    """Return why a link that differs is not mended: what lies outside a hull says nothing of the mistake."""
    return next((each for each in link.findings if each.code != "outside_hull"), link.findings[0]).sentence


def _center_agrees(link: LinkAudit) -> bool:
    """Say whether the stated centre of mass is as good as the mended one: Steiner's term is of second order."""
    if link.difference is None or link.mended is None:
        return False
    radius = float(link.mended.radii_of_gyration.max())
    return link.difference.center_of_mass < _SAME_CENTER * radius


def _require_known(densities: Mapping[str, float], robot: Robot) -> None:
    """Refuse a density of what the robot has not."""
    geometries = [geometry for link in robot.links for geometry in link.geometries]
    names = list(dict.fromkeys(geometry.name for geometry in geometries))
    known = {name for geometry in geometries for name in _names_of(geometry)}
    for name in densities:
        if name and name not in known:
            close = get_close_matches(name, names, _NAMED, 0.0)
            more = f" and {len(names) - len(close)} more" if len(names) > len(close) else ""
            there = f"there are {', '.join(close)}{more}" if names else "it has none"
            raise UsageError(f"no mesh or shape of {visible(robot.path.name)} is called {visible(name)!r}: {there}")


def _subject(link: Link, scales: Scales, densities: float | Mapping[str, float] | None) -> Subject:
    stated, inertial = None, link.inertial
    if link.stated is not None:
        try:
            inertial = inertial_of([each for each in link.geometries if each.weighs], link.mass, link.stated)
        except InertiaError as error:
            words = f"what is stated needs what collides of it beside, and {visible(str(error))}"
            return Subject(link.name, None, obstacles=(Finding("mesh_unusable", words),))
    if inertial is not None:
        rotation = inertial.placement.rotation
        inertia = rotation @ inertial.inertia @ rotation.T
        body = Body(inertial.mass, inertial.placement.origin, inertia)
        stated = Statement(body, rotation, inertial.figures, inertial.integrals)
    by_role: dict[str, list[Geometry]] = {"visual": [], "collision": []}
    for geometry in link.geometries:
        by_role[geometry.role].append(geometry)
    visual, obstacles = _weighed(_told_apart(by_role["visual"]), scales)
    collision, others = _weighed(_told_apart(by_role["collision"]), scales)
    if (obstacles.blocking or not by_role["visual"]) and collision and not others.blocking:
        words = "the visual meshes cannot be weighed" if by_role["visual"] else "it has no visual geometry"
        note = Finding("collision_weighed", f"{words}: the collision geometry is weighed in their place")
        weights = _weights(by_role["collision"], densities)
        notes = (note, *obstacles.blocking, *others.notes)
        substitute = bool(by_role["visual"])
        return Subject(link.name, stated, collision, (), weights, (), notes, substitute, link.fault)
    weights = _weights(by_role["visual"], densities)
    blocking = obstacles.blocking if by_role["visual"] else others.blocking
    return Subject(link.name, stated, visual, collision, weights, blocking, obstacles.notes, fault=link.fault)


@dataclass(frozen=True)
class _Obstacles:
    """What keeps shapes from being weighed, and what had to be done to those that were."""

    blocking: tuple[Finding, ...]
    notes: tuple[Finding, ...]


def _weighed(geometries: Sequence[Geometry], scales: Scales) -> tuple[list[Weighed], _Obstacles]:
    weighed, blocking, notes = [], [], []
    for geometry in geometries:
        try:
            shape, note = scales.weigh(geometry)
        except InertiaError as error:
            blocking.append(Finding("mesh_unusable", f"{geometry.name}: {cause(error)}"))
            continue
        weighed.append(shape)
        if shape.shape.unit != 1:
            words = f"its file's own unit ({shape.shape.unit:g} m) and the scale are both applied"
            notes.append(Finding("unit_and_scale", f"{geometry.name}: {words}, as RViz, Gazebo and Bullet do"))
        if note is not None:
            notes.append(note)
    return weighed, _Obstacles(tuple(blocking), tuple(notes))


def _weights(geometries: Sequence[Geometry], densities: float | Mapping[str, float] | None) -> tuple[float, ...] | None:
    if densities is None:
        return None
    if not isinstance(densities, Mapping):
        return (float(densities),) * len(geometries)
    weights = []
    for geometry in geometries:
        name = next((each for each in (*_names_of(geometry), "") if each in densities), None)
        if name is None:
            words = "give one by that name, or one without a name for all that have none"
            raise UsageError(f"no density is given for {geometry.name}: {words}")
        weights.append(float(densities[name]))
    return tuple(weights)


def _names_of(geometry: Geometry) -> list[str]:
    """Return what a geometry may be called: by the end of its file's path, the longest first, and by its name."""
    parts = geometry.shape.parts if isinstance(geometry.shape, Path) else ()
    return [*("/".join(parts[k:]) for k in range(len(parts) - 1)), geometry.name]


def _told_apart(geometries: Sequence[Geometry]) -> list[Geometry]:
    """Return geometries with those called after their folders too that lie in files of one name."""
    files = {(geometry.name, geometry.shape) for geometry in geometries if isinstance(geometry.shape, Path)}
    shared = {name for name, count in Counter(name for name, _ in files).items() if count > 1}
    return [
        replace(each, name=f"{each.shape.parent.name}/{each.name}")
        if isinstance(each.shape, Path) and each.name in shared
        else each
        for each in geometries
    ]


def _lumped(groups: _Groups, subjects: Sequence[Subject]) -> Iterator[Subject]:
    """Yield the links with those that hang from them by fixed joints, Steiner terms included."""
    by_name = {subject.name: subject for subject in subjects}
    for root, members in groups.items():
        if len(members) == 1:
            yield by_name[root]
            continue
        stated = [
            subject.stated.body.placed(where.rotation, where.origin)
            for name, where in members
            if (subject := by_name[name]).stated is not None and subject.stated.body.mass > 0
        ]
        here = [(by_name[name], where) for name, where in members]
        weights = [subject.densities for subject, _ in here]
        known = None if any(each is None for each in weights) else tuple(w for each in weights for w in each or ())
        yield Subject(
            root,
            Statement(together(stated), np.eye(3)) if stated else None,
            [_of_link(subject, each.moved(where)) for subject, where in here for each in subject.shapes],
            [_of_link(subject, each.moved(where)) for subject, where in here for each in subject.collisions],
            known,
            [finding for subject, _ in here for finding in subject.obstacles],
            [finding for subject, _ in here for finding in subject.notes],
            fault=next((by_name[name].fault for name, _ in members if by_name[name].fault), ""),
        )


def _of_link(subject: Subject, weighed: Weighed) -> Weighed:
    """Return a shape that is called after its link, too."""
    return replace(weighed, shape=replace(weighed.shape, name=f"{subject.name}/{weighed.shape.name}"))


def _fixed_together(robot: Robot) -> _Groups:
    """Return each link that hangs from none by a fixed joint, the links that hang from it so, and where these are."""
    by_name = {each.name: each for each in robot.links}
    places: dict[str, tuple[str, Placement]] = {}
    for link in robot.links:
        above, seen = [link], {link.name}
        while (here := above[-1]).name not in places and here.parent in by_name:
            if here.parent in seen:
                raise ReadError(
                    f"link {here.name!r} hangs from itself by fixed joints: turn one of them round",
                    code="cycle",
                )
            above.append(by_name[here.parent])
            seen.add(here.parent)
        places.setdefault(here.name, (here.name, Placement()))
        for each, parent in zip(above[-2::-1], above[:0:-1], strict=True):
            root, where = places[parent.name]
            places[each.name] = root, where.then(each.placement)
    hung: dict[str, list[tuple[str, Placement]]] = {link.name: [] for link in robot.links}
    for name, (root, where) in ((link.name, places[link.name]) for link in robot.links):
        hung[root].append((name, where))
    return {root: members for root, members in hung.items() if members}
