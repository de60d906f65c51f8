"""Recording of an assembly and its mass budget: the tree of parts in their places, what each has, how sure that is.

Meshes in the colour of their density, an ellipsoid of the same mass and moments for each part and group, the centres
of mass, the principal axes of the whole, and the region that its centre of mass is in with 95 %, enlarged, in the box
that limits set. Entities hang as the parts do.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from inertia import palette
from inertia.arrays import Float
from inertia.assembly.bodies import Body, mapped, triangles_of
from inertia.assembly.budget import Budget
from inertia.assembly.frames import LENGTH_BITS, Frame
from inertia.assembly.limits import Limit
from inertia.assembly.lines import Line
from inertia.assembly.tree import Node
from inertia.dynamics.kinematics import quaternion
from inertia.errors import visible
from inertia.mass.moments import inertia_tensor
from inertia.mass.principal import principal
from inertia.mesh.turns import TURN_BITS
from inertia.recording.display import PART_COLORS, equivalent_ellipsoid, facets, shown_triangles
from inertia.recording.drawing import COLORS, Color, write_axes, write_labels, write_lines, write_text
from inertia.recording.screen import Screen, eye, space_view, text_view
from inertia.recording.summary import figure, listed, markdown, sentence, ten_to
from inertia.recording.writer import Recording

if TYPE_CHECKING:
    import rerun.blueprint as rrb

PARTS, ELLIPSOIDS, CENTER = "parts", "ellipsoids", "center_of_mass"
"""Axes of the whole, about its centre of mass: meshes, ellipsoids, and what is known of that centre, enlarged."""

_NEARER = 0.8  # of the distance from which a ball of that size is seen whole
_ELLIPSOIDS = 2000  # parts: of more, those of groups alone are drawn
_NAMES = ("steel blue", "brown", "green", "purple", "olive", "teal")  # of the colours of parts
_MOST = 400_000  # triangles that all parts are shown with, those of copies counted once
_FEWEST = 200  # of one part
_POINT = 0.02  # of the whole, the radius of a part that is a point
_ROWS = 40  # of the table
_GROUP, _WHOLE = palette.rgb(palette.SKY), palette.rgb(palette.ORANGE)
_REGION = math.sqrt(7.814727903251178)  # χ² of three degrees of freedom at 95 %, standard uncertainties
_NOTHING = 1e-9  # of the unit of length: what is less is rounding
_ALONG = 1.0  # of the whole, the length of its principal axes


class _Row(NamedTuple):
    """A line of the budget with its node, where its copies lie, and the path of its entity."""

    line: Line
    node: Node
    frames: tuple[Frame, ...]
    path: tuple[str, ...]


def screen(budget: Budget) -> Screen:
    """Return the recording of a budget, which does not move."""
    rows = list(_rows(budget))
    center = budget.total.center_of_mass
    leaves = [_Leaf.of(row, center, max(_FEWEST, _MOST // len(rows))) for row in rows if row.node.body is not None]
    size = max((leaf.reach for leaf in leaves), default=0.0) or 1.0
    unit = 10.0 ** math.floor(math.log10(size))
    densities = list(dict.fromkeys(leaf.density for leaf in leaves))
    densities.sort(key=lambda one: -sum(leaf.mass for leaf in leaves if leaf.density == one))
    colors = {one: PART_COLORS[k % len(PART_COLORS)] for k, one in enumerate(densities)}

    def write(recording: Recording) -> None:
        for leaf in leaves:
            leaf.write(recording, unit, size, colors[leaf.density], with_ellipsoid=len(leaves) <= _ELLIPSOIDS)
        for row in rows:
            if row.line.children:
                _write_group(recording, row.line, row.path, center, unit)
        axes = principal(budget.properties.inertia).axes if budget.properties.inertia.any() else np.eye(3)
        for root in (PARTS, ELLIPSOIDS):
            write_axes(recording, f"{root}/principal_axes", _ALONG * size / unit * axes, 0.006 * size / unit)
        _write_center(recording, budget)
        write_text(recording, _text(budget, colors, unit))

    return Screen("inertia-budget", visible(budget.assembly.name), _blueprint(budget, size / unit), write)


def _rows(budget: Budget) -> Iterator[_Row]:
    """Yield the lines from the top to the bottom, parts of one name below one another told apart."""
    paths: list[tuple[str, ...]] = []
    taken: set[tuple[str, ...]] = set()
    for line, (node, frames) in zip(budget.total.lines(), budget.assembly.in_places(), strict=True):
        del paths[line.level :]
        above = paths[-1] if paths else ()
        path, number = (*above, visible(line.name)), 1
        while path in taken:
            number += 1
            path = (*above, f"{visible(line.name)} {number}")
        taken.add(path)
        paths.append(path)
        yield _Row(line, node, frames, path)


def _entity(root: str, path: tuple[str, ...], *more: str) -> str:
    import rerun as rr

    return "/".join([root, *(rr.escape_entity_path_part(part) for part in (*path, *more))])


class _Leaf(NamedTuple):
    """A part as it is drawn: triangles (k, 3, 3) m in its own axes, or none, and the places of its copies.

    `semi_axes` and `attitude` are those of the ellipsoid of the same moments about `own`, (3,) m, its centre of mass.
    """

    line: Line
    path: tuple[str, ...]
    triangles: Float
    places: Float
    turns: Float
    own: Float
    semi_axes: Float
    attitude: Float
    mass: float
    density: float
    reach: float

    @classmethod
    def of(cls, row: _Row, center: Float, most: int) -> _Leaf:
        body = row.node.body
        assert body is not None
        triangles = _triangles(row.node, body, most)
        places = np.array([[k / (1 << LENGTH_BITS) for k in frame.origin] for frame in row.frames]) - center
        turns = np.array([[k / (1 << TURN_BITS) for k in frame.rotation] for frame in row.frames]).reshape(-1, 3, 3)
        central = body.moments.central()
        own, mass = np.array([float(k) for k in central.origin]), float(central.zeroth)
        tensor = np.array([[float(k) for k in each] for each in inertia_tensor(central.second)])
        semi_axes, attitude = np.zeros(3), np.asarray(quaternion.IDENTITY)
        if tensor.any():
            axes = principal(tensor)
            semi_axes, attitude = equivalent_ellipsoid(axes.moments, mass), quaternion.from_matrix(axes.axes)
        around = triangles.reshape(-1, 3) if len(triangles) else own + np.stack([semi_axes, -semi_axes])
        away = np.linalg.norm(places + turns @ own, axis=1).max()
        reach = float(away + np.linalg.norm(around - own, axis=1).max())
        density = float(body.moments.zeroth / body.volume) if body.volume else 0.0
        turned = np.array([quaternion.from_matrix(turn) for turn in turns])
        return cls(row.line, row.path, triangles, places, turned, own, semi_axes, attitude, mass, density, reach)

    def write(self, recording: Recording, unit: float, size: float, color: Color, *, with_ellipsoid: bool) -> None:
        """Write it, and the ellipsoid of each copy; a point where it has neither surface nor extent."""
        import rerun as rr

        centers = (self.places + quaternion.to_space(self.turns, self.own)) / unit
        if self.semi_axes.any():
            solid: Any = rr.Ellipsoids3D(
                half_sizes=np.broadcast_to(self.semi_axes / unit, centers.shape),
                centers=centers,
                quaternions=quaternion.multiply(self.turns, self.attitude),
                colors=[color],
                fill_mode=rr.components.FillMode.TransparentFillMajorWireframe,
            )
        else:
            solid = rr.Points3D(centers, colors=[color], radii=[_POINT * size / unit])
        drawn = [solid]
        if len(self.triangles):
            instances = rr.InstancePoses3D(translations=self.places / unit, quaternions=self.turns)
            drawn = [facets(self.triangles / unit, color), instances]
        recording.static(_entity(PARTS, self.path), *drawn, _figures(self.line))
        if with_ellipsoid:
            recording.static(_entity(ELLIPSOIDS, self.path), solid)


def _figures(line: Line) -> Any:
    """Return what the viewer says of a part that is picked."""
    import rerun as rr

    return rr.AnyValues(
        basic_mass_kg=line.basic_mass,
        predicted_mass_kg=line.predicted_mass,
        standard_uncertainty_kg=line.sigma.mass,
        quantity=line.quantity,
    )


def _triangles(node: Node, body: Body, most: int) -> Float:
    """Return the triangles of a part in its own axes, few enough to be shown."""
    assert node.fields is not None
    if body.part is not None:
        return mapped(node.fields, shown_triangles(body.part, np.zeros(3), most)[0])
    own = triangles_of(node.fields, body, node.unit)
    return np.empty((0, 3, 3)) if own is None else own


def _write_group(recording: Recording, line: Line, path: tuple[str, ...], center: Float, unit: float) -> None:
    """Write the centre of mass of a group, and the ellipsoid of the moments of all that is in it."""
    import rerun as rr

    place = (line.center_of_mass - center) / unit
    color = _GROUP if line.level else _WHOLE
    point = rr.Points3D([place], colors=[color], radii=[rr.Radius.ui_points(4.0 if line.level else 7.0)])
    for root in (PARTS, ELLIPSOIDS):
        recording.static(_entity(root, path, "center_of_mass"), point, _figures(line))
    if not line.inertia.any():
        return
    axes = principal(line.inertia)
    recording.static(
        _entity(ELLIPSOIDS, path, "ellipsoid"),
        rr.Ellipsoids3D(
            half_sizes=[equivalent_ellipsoid(axes.moments, line.basic_mass) / unit],
            centers=[place],
            quaternions=[rr.Quaternion(xyzw=quaternion.from_matrix(axes.axes))],
            colors=[color],
            fill_mode=rr.components.FillMode.MajorWireframe,
        ),
    )


def _box(budget: Budget) -> list[tuple[float, float]]:
    """Return the limits of the centre of mass along x, y and z, m from where it is; infinite without."""
    ends = [(-math.inf, math.inf)] * 3
    for limit in budget.limits:
        axis = "xyz".find(limit.what[-1])
        if limit.what.startswith("center_of_mass.") and axis >= 0:
            low, high = ends[axis]
            own = float(budget.total.center_of_mass[axis])
            ends[axis] = (
                max(low, -math.inf if limit.low is None else limit.low - own),
                min(high, math.inf if limit.high is None else limit.high - own),
            )
    return ends


def _region(budget: Budget) -> tuple[Float, Float]:
    """Return the semi-axes (3,) m of the region of 95 % of the centre of mass, and its axes, as columns."""
    changes = budget.total.sigma.changes[:, 1:4]
    squares, axes = np.linalg.eigh(changes.T @ changes)
    if np.linalg.det(axes) < 0:
        axes[:, 0] *= -1
    return _REGION * np.sqrt(np.maximum(squares, 0.0)), axes


def _write_center(recording: Recording, budget: Budget) -> None:
    """Write the region of 95 % of the centre of mass, and the box that its limits make, in units of the region."""
    import rerun as rr

    semi_axes, axes = _region(budget)
    recording.static(f"{CENTER}/estimate", rr.Points3D([[0, 0, 0]], colors=[_WHOLE], radii=[rr.Radius.ui_points(5.0)]))
    unit = _enlarged(budget)
    if semi_axes.any():
        recording.static(
            f"{CENTER}/region",
            rr.Ellipsoids3D(
                half_sizes=[np.maximum(semi_axes, 0.01 * semi_axes.max()) / unit],
                quaternions=[rr.Quaternion(xyzw=quaternion.from_matrix(axes))],
                colors=[_WHOLE],
                fill_mode=rr.components.FillMode.TransparentFillMajorWireframe,
            ),
        )
    for k, (name, (low, high)) in enumerate(zip("xyz", _box(budget), strict=True)):
        along = np.eye(3)[k]
        recording.static(f"{CENTER}/{name}", rr.Arrows3D(vectors=[3.0 * along], colors=[COLORS[k]], radii=[0.02]))
        write_labels(recording, f"{CENTER}/{name}/name", [3.2 * along], [name])
        for end in (low, high):
            if math.isfinite(end):
                across = [np.roll(along, 1), np.roll(along, 2)]
                corners = np.array(
                    [a * across[0] + b * across[1] for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1), (1, 1))]
                )
                side = "min" if end == low else "max"
                here = float(np.clip(end / unit, -_FARTHEST, _FARTHEST))
                lines = [3.0 * corners + here * along]
                write_lines(recording, f"{CENTER}/limit_{name}_{side}", lines, palette.rgb(palette.WHITE), 0.02)


_FARTHEST = 4.0  # units of the region: a limit beyond is drawn there


def _enlarged(budget: Budget) -> float:
    """Return m that are one unit of the view of the centre of mass: the size of its region, or of its box."""
    reach = float(_region(budget)[0].max(initial=0.0))
    ends = [abs(end) for pair in _box(budget) for end in pair if math.isfinite(end)]
    return reach or max(ends, default=0.0) or 1.0


def _text(budget: Budget, colors: Mapping[float, Color], unit: float) -> str:
    """Return the table of masses and what is shown, in Markdown."""
    total, lines = budget.total, list(budget.total.lines())
    share = 100 / total.basic_mass if total.basic_mass else 0.0
    head = "no limits are stated" if budget.verdict is None else budget.verdict.upper()
    paragraphs = [f"**{markdown(budget.assembly.name)}**: {head}"]
    paragraphs += [_limit(limit, budget) for limit in budget.limits]
    table = ["| part | qty | basic kg | % | predicted kg | u kg |", "|:--|--:|--:|--:|--:|--:|"]
    for line in lines[:_ROWS]:
        name = "\u2003" * line.level + markdown(line.name)
        table.append(
            f"| {name} | {line.quantity if line.level else ''} | {line.basic_mass:.5g} | {share * line.basic_mass:.3g} "
            f"| {line.predicted_mass:.5g} | {line.sigma.mass:.2g} |"
        )
    paragraphs.append("\n".join(table))
    if len(lines) > _ROWS:
        paragraphs.append(f"… and {len(lines) - _ROWS} more")
    center, metres = total.center_of_mass, float(budget.assembly.unit.metres)
    paragraphs.append(f"Centre of mass: {listed(center / metres)} {budget.assembly.unit.name}")
    shades = [
        f"{'no volume' if not density else f'{density:.5g} kg/m³'} {_NAMES[PART_COLORS.index(color)]}"
        for density, color in colors.items()
    ]
    shown = ", ".join(shades[: len(PART_COLORS)]) + (" …" if len(shades) > len(PART_COLORS) else "")
    paragraphs.append(f"Colours: {shown}. Groups are sky blue, the whole is orange.")
    paragraphs.append(
        "Points are centres of mass. Each ellipsoid is solid and has the mass and the moments of what it stands for."
    )
    if sum(not line.children for line in lines) > _ELLIPSOIDS:
        paragraphs.append(f"Of more than {_ELLIPSOIDS} parts, the ellipsoids of groups alone are drawn.")
    power = round(math.log10(unit))
    paragraphs.append(f"One unit of the view is {'1' if not power else ten_to(power)} m.")
    reach = _region(budget)[0]
    if reach.any():
        size = f"{listed(reach[::-1] / metres)} {budget.assembly.unit.name}"
        frames = "; a frame is a limit, drawn at 4 units where it is farther" if np.isfinite(_box(budget)).any() else ""
        paragraphs.append(
            f"The centre of mass is in its ellipsoid with 95 %: semi-axes {size}. A unit there is "
            f"{figure(reach.max())} m{frames}."
        )
    else:
        paragraphs.append("No uncertainty is stated, so that the centre of mass has no region.")
    paragraphs += [sentence(markdown(note)) for note in budget.notes]
    return "\n\n".join(paragraphs)


def _limit(limit: Limit, budget: Budget) -> str:
    """Return a limit in a line, a coordinate in the unit of the file."""
    unit = budget.assembly.unit
    along = limit.what.startswith("center_of_mass")
    value = limit.value / float(unit.metres) if along else limit.value
    shown = "0" if along and abs(value) < _NOTHING else f"{value:.5g}"
    name = f" {unit.name}" if along else " kg" if limit.what.endswith("mass") else "" if "/" in limit.what else " kg m²"
    return f"{markdown(limit.what)}: {shown}{name}, **{limit.verdict.upper()}**"


def _blueprint(budget: Budget, radius: float) -> rrb.Blueprint:
    import rerun.blueprint as rrb

    left = rrb.Vertical(
        space_view(PARTS, "Parts", eye(_NEARER * radius)),
        space_view(ELLIPSOIDS, "Ellipsoids of the same moments", eye(_NEARER * radius)),
    )
    views: list[Any] = [text_view()]
    if budget.total.sigma.changes.any() or np.isfinite(_box(budget)).any():
        views.append(space_view(CENTER, "Centre of mass of the whole, 95 %", eye(5.5)))
    right = rrb.Vertical(*views, row_shares=[2.0, 1.0][: len(views)])
    return rrb.Blueprint(
        rrb.Horizontal(left, right, column_shares=[1.3, 1.0]),
        rrb.TimePanel(state="hidden"),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
    )
