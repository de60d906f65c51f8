"""`Analysis` → lines of text."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from inertia.arrays import Float
from inertia.errors import UNIT, Remedy, Sentence, Wording
from inertia.mass.analysis import Analysis
from inertia.mass.integrand import ELEMENTS
from inertia.mass.integration import TrueShape
from inertia.mass.principal import radii_of_gyration
from inertia.mass.properties import MassProperties
from inertia.report.analysis.document import relative_bounds
from inertia.report.numerals import cleared, columns, number, power, row

if TYPE_CHECKING:
    from inertia.mass.repair import Repaired  # what it mends with is slow to import, and seldom needed

_DENSITY_FROM = {
    "option": "as given",
    "material": "of the material given",
    "mass": "from the mass given",
    "file": "from the file",
    "assumed": Sentence(
        "assumed: state it with ",
        Remedy("analyse", "density", ...),
        ", ",
        Remedy("analyse", "material", ...),
        " or ",
        Remedy("analyse", "mass", ...),
    ),
}
_UNIT_FROM = {"option": "as given", "file": "from the file", "assumed": Sentence("assumed: state it with ", UNIT)}
_ROUNDING = 2.0**-52
_LISTED = 12  # names of regions in the text
_CLASS = {
    "spherical": "spherical (I1 = I2 = I3: every axis is a principal one)",
    "prolate": "prolate (I2 = I3: axes 2 and 3 are any two at right angles to axis 1)",
    "oblate": "oblate (I1 = I2: axes 1 and 2 are any two at right angles to axis 3)",
    "asymmetric": "asymmetric (no two moments are equal)",
    "rotor": "rotor (I1 = 0, I2 = I3: all mass lies on axis 1)",
}


def analysis_text(analysis: Analysis, repaired: Repaired | None = None, *, wording: Wording = str) -> str:
    """Return the analysis as lines of text; what its error bound cannot tell from zero is set as 0."""
    blocks = [
        source_lines(analysis, repaired, wording=wording),
        _repair(repaired, analysis.part.unit.name) if repaired else [],
        _union(analysis),
        list(_results(analysis)),
        _tensor(analysis),
        _principal(analysis),
        _about(analysis),
        _shares(analysis),
        list(_closing(analysis, repaired, wording)),
    ]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def source_lines(analysis: Analysis, repaired: Repaired | None = None, *, wording: Wording = str) -> list[str]:
    """Return the lines that say what was analysed: file, unit, density, mesh, and who said so."""
    part = analysis.part
    counts = ((analysis.triangles, "triangle"), (analysis.cells, "cell"))
    elements = [f"{count} {name}{'' if count == 1 else 's'}" for count, name in counts if count]
    closed = [] if analysis.cells else ["closed" if analysis.closed else "open"]
    no_solid = bool(analysis.cells) and analysis.model != "solid"
    crossings = [] if no_solid else [f"crossings {'' if analysis.crossings_examined else 'not '}examined"]
    bodies = f"{analysis.bodies} {'body' if analysis.bodies == 1 else 'bodies'}"
    repairs = ["repaired"] if repaired and repaired.changes else []
    repairs += ["united"] if analysis.union and analysis.union.changed else []
    repairs += [f"faults allowed for up to {analysis.allowed_faults:g}"] if analysis.allowed_faults else []
    return [
        row("Part", f"{part.name} ({part.source.format})"),
        *([row("SHA-256", part.source.sha256)] if part.source.sha256 else []),
        row("Unit", f"{part.unit.name} ({Sentence(_UNIT_FROM[part.unit_from]).worded(wording)})"),
        row("Density", f"{number(analysis.density)} kg/m³ ({_density_from(analysis, wording)})"),
        row("Mesh", ", ".join([*elements, *closed, bodies, *crossings, *repairs])),
        *([row("Shape", _shape(analysis.shape, part.unit.name))] if analysis.shape else []),
        *([row("Regions", _listed(part.regions.names))] if part.regions else []),
        *([row("Model", _MODEL[analysis.model])] if analysis.model != "solid" else []),
    ]


def _shape(shape: TrueShape, unit: str) -> str:
    solids, faces = (
        f"{n} {what}{'' if n == 1 else 's'}" for n, what in ((len(shape.solids), "solid"), (shape.faces, "face"))
    )
    return f"integrated in place of triangles: {solids}, {faces}, up to {shape.gap:.2g} {unit} apart at their edges"


_MODEL = {"shell": "thin shell: the surface carries the mass", "wire": "wire: the lines carry the mass"}


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(names[:_LISTED]) + (f" and {len(names) - _LISTED} more" if len(names) > _LISTED else "")


def _density_from(analysis: Analysis, wording: Wording) -> str:
    mean = "mean, " if analysis.shares else ""
    return mean + Sentence(_DENSITY_FROM[analysis.density_from]).worded(wording)


def _repair(repaired: Repaired, unit: str) -> list[str]:
    if not repaired.changes:
        return [row("Repair", "nothing to repair: the part is used as it is")]
    changes = [f"{change} {unit}" if change.largest_move else f"{change}" for change in repaired.changes]
    effect = [
        f"volume from {number(repaired.volume_before)} to {number(repaired.volume_after)} m³ "
        "(before: the integral over the triangles that there were)"
    ]
    if repaired.center_of_mass_shift is not None and repaired.inertia_change is not None:
        effect.append(
            f"centre of mass moved by {repaired.center_of_mass_shift:.3g} m, tensor changed by "
            f"{repaired.inertia_change:.3g} of its norm"
        )
    if repaired.volume_between is not None:
        least, most = map(number, repaired.volume_between)
        effect.append(f"the filling is a guess: the rims admit volumes from {least} to {most} m³")
    return [row("" if k else "Repair", line) for k, line in enumerate([*changes, *effect])]


def _union(analysis: Analysis) -> list[str]:
    union, unit = analysis.union, analysis.part.unit
    if union is None:
        return []
    volumes = [(union.more_than_once, "counted more than once"), (union.negative, "counted less than not at all")]
    parts = [
        f"{number(float(Fraction(volume) * unit.metres**3))} m³ of the stored volume {what}"
        for volume, what in volumes
        if volume
    ]
    if not parts:
        return [row("Union", "nothing to unite: all of the volume counts once already")]
    return [row("" if k else "Union", line) for k, line in enumerate(parts)]


def _results(analysis: Analysis) -> Iterator[str]:
    properties, unit = analysis.properties, analysis.part.unit

    def in_unit(value: float, exponent: int) -> str:
        try:
            return number(float(Fraction(value) / unit.metres**exponent))
        except OverflowError:
            return "more than 1.8e308"

    def scalar(label: str, value: float, exponent: int) -> str:
        beside = "" if unit.metres == 1 else f"   = {in_unit(value, exponent)} {power(unit.name, exponent)}"
        return row(label, f"{number(value)} {power('m', exponent)}{beside}")

    def vector(label: str, values: list[float]) -> Iterator[str]:
        yield row(label, f"{', '.join(map(number, values))} m")
        if unit.metres != 1:
            scaled = (in_unit(value, 1) for value in values)
            yield row("", f"= {', '.join(scaled)} {unit.name}")

    low, high = analysis.extents.tolist()
    size = [float(Fraction(b) - Fraction(a)) for a, b in zip(low, high, strict=True)]
    com = [cleared(value, properties.error.center_of_mass) for value in properties.center_of_mass.tolist()]
    yield from vector("Size", size)
    if analysis.model != "wire":
        yield scalar("Volume", properties.volume, 3)
        yield scalar("Surface area", analysis.area, 2)
    yield row("Mass", f"{number(properties.mass)} kg")
    yield from vector("Centre of mass", com)


def _rounding_shows(analysis: Analysis) -> bool:
    """Whether more digits of the centre of mass were asked for than a float64 holds so far from the origin."""
    if analysis.accuracy is None:
        return False
    asked = _ROUNDING if isinstance(analysis.accuracy, str) else analysis.accuracy
    size = float((analysis.extents[1] - analysis.extents[0]).max())
    return analysis.properties.error.center_of_mass > asked * size


def _tensor(analysis: Analysis) -> list[str]:
    properties = analysis.properties
    return [
        "Inertia tensor about the centre of mass, part axes, kg m² (off the diagonal: −∫xy dm)",
        *_matrix(properties.inertia.tolist(), properties.error.inertia),
    ]


def _matrix(rows: list[list[float]], relative: float) -> list[str]:
    bound = relative * math.hypot(*(value for line in rows for value in line))
    return [columns(cleared(value, bound) for value in line) for line in rows]


def _principal(analysis: Analysis) -> list[str]:
    principal, mass = analysis.principal, analysis.properties.mass
    bounds = principal.moment_bounds.tolist()
    moments = [cleared(value, bound) for value, bound in zip(principal.moments.tolist(), bounds, strict=True)]
    radii = radii_of_gyration(moments, mass).tolist()
    semi = ", ".join(map(number, _semi_axes(analysis.properties)))
    lines = [f"{'Principal':<10}{'moment, kg m²':>18}{'gyration, m':>18}{'axis x':>14}{'y':>14}{'z':>14}"]
    for k, (moment, radius) in enumerate(zip(moments, radii, strict=True)):
        axis = "".join(f"{round(value, 9) + 0.0:>14.9f}" for value in principal.axes[:, k].tolist())
        lines.append(f"{f'  {k + 1}':<10}{columns([moment, radius])}{axis}")
    return [
        *lines,
        "",
        row("Class", _CLASS[principal.kind]),
        row("", f"moments count as equal within {principal.tolerance:g} of the largest"),
        row("Equivalent", f"ellipsoid of semi-axes {semi} m along axes 1, 2, 3"),
    ]


def _semi_axes(properties: MassProperties) -> list[float]:
    """Return the semi-axes of the equivalent ellipsoid, 0 where ∫x² dm along the axis cannot be told from zero.

    That integral is a part of either moment about the other axes, so that what either is off by bounds its error.
    """
    bounds = properties.principal.moment_bounds
    least = np.minimum(np.roll(bounds, -1), np.roll(bounds, 1))
    told = properties.principal.second_moments > least
    semi_axes: list[float] = np.where(told, properties.equivalent_ellipsoid, 0.0).tolist()
    return semi_axes


def _angle(bound: float) -> str:
    """Return a bound in degrees, or that there is none."""
    return f"{math.degrees(bound):.2g}°" if bound < 0.5 * math.pi else "any"


def _about(analysis: Analysis) -> list[str]:
    if analysis.about is None:
        return []
    point, tensor = analysis.about
    where = ", ".join(map(number, point))
    return [
        f"Inertia tensor about ({where}) {analysis.part.unit.name}, part axes, kg m²",
        *_matrix(tensor.tolist(), analysis.about_bound or 0.0),
    ]


def _shares(analysis: Analysis) -> list[str]:
    if not analysis.shares:
        return []
    width = max(len("Body"), *(len(_name(share.name)) for share in analysis.shares)) + 2
    head = f"{'Body':<{width}}{'density, kg/m³':>18}{'volume, m³':>18}{'mass, kg':>18}"
    return [
        head,
        *(
            f"{_name(share.name):<{width}}{columns([share.density, share.volume, share.mass])}"
            for share in analysis.shares
        ),
    ]


def _name(name: str) -> str:
    return name or "(the rest)"


def _closing(analysis: Analysis, repaired: Repaired | None, wording: Wording) -> Iterator[str]:
    error = analysis.properties.error
    yield row(
        "Error bound", f"volume {error.volume:.2g}, mass {error.mass:.2g}, tensor {error.inertia:.2g} (relative),"
    )
    principal = analysis.principal
    moments = ", ".join(f"{value:.2g}" for value in relative_bounds(principal))
    axes = ", ".join(_angle(value) for value in principal.axis_bounds.tolist())
    pair = analysis.properties.center_of_mass_pair()[1]
    beside = f", as a pair of numbers {pair:.2g} m" if _rounding_shows(analysis) else ""
    yield row("", f"centre of mass {error.center_of_mass:.2g} m{beside}")
    yield row("", f"principal moments {moments} (relative), axes {axes}")
    if analysis.about_bound is not None:
        yield row("", f"tensor about the point {analysis.about_bound:.2g} (relative)")
    apart = "for the mesh as stored, its tessellation apart"
    yield row("", f"{error.method}; {'for the shape as stored' if analysis.shape else apart}")
    yield from uncertainty_lines(analysis)
    yield from omission_lines(analysis, wording=wording)
    repairs = {f"repaired: {change}" for change in repaired.changes} if repaired else set()
    for note in analysis.notes:
        if note not in repairs:
            yield row("Note", note)


def omission_lines(analysis: Analysis, *, wording: Wording = str) -> Iterator[str]:
    """Yield the lines on what no arithmetic makes less: tessellation, holes filled by a guess, volume in doubt."""
    if (chord := analysis.tessellation) is not None:
        yield row(
            "Tessellation", f"volume {chord.volume:.2g}, mass {chord.mass:.2g}, tensor {chord.inertia:.2g} (relative),"
        )
        yield row("", f"centre of mass {chord.center_of_mass:.2g} m; {chord.method}")
    if (guess := analysis.repair) is not None:
        mass, tensor = (f"{k:.2g}" if k < math.inf else "any" for k in (guess.mass, guess.inertia))
        yield row("Filled holes", f"volume {guess.volume:.2g}, mass {mass}, tensor {tensor} (relative),")
        com = f"{guess.center_of_mass:.2g} m" if guess.center_of_mass < math.inf else "anywhere"
        yield row("", f"centre of mass {com}; {guess.method}")
    for finding in analysis.doubts:
        yield row("In doubt", Sentence(finding.message).worded(wording))


_ROUNDED = 1e-14  # of its scale: less is what rounding leaves of a standard uncertainty of zero


def uncertainty_lines(analysis: Analysis) -> Iterator[str]:
    """Yield the lines on standard uncertainties, and expanded ones, where inputs have some."""
    uncertainty = analysis.uncertainty
    if uncertainty is None:
        return
    properties, principal = analysis.properties, analysis.principal
    yield row("Uncertainty", f"u (standard uncertainty, GUM) for u of {', '.join(uncertainty.stated)}:")
    off = _ROUNDED * float(np.ptp(analysis.extents, axis=0).max()), _ROUNDED * float(uncertainty.of()[5:].max())
    about = analysis.about_uncertainty
    for k, expanded in ((1.0, False), (uncertainty.coverage or 0.0, True)):
        if expanded and not k:
            continue
        if expanded:
            yield row("", f"U = k u (expanded uncertainty), k = {k:g}:")
        volume, mass = k * uncertainty.volume, k * uncertainty.mass
        shares = _share(volume, properties.volume), _share(mass, properties.mass)
        yield row("", f"volume {volume:.2g} m³ ({shares[0]}), mass {mass:.2g} kg ({shares[1]}),")
        yield row("", f"centre of mass {_each(k * uncertainty.center_of_mass, off[0])} m,")
        yield row("", f"tensor xx, yy, zz, xy, xz, yz {_each(k * uncertainty.of()[5:], off[1])} kg m²,")
        if about is not None:
            there = [k * float(about[i, j]) for i, j in ELEMENTS]
            yield row("", f"about the point {_each(np.array(there), _ROUNDED * max(there))} kg m²,")
        moments = zip((k * uncertainty.principal_moments).tolist(), principal.moments.tolist(), strict=True)
        angles = (k * uncertainty.principal_axes).tolist()
        axes = (f"{cleared(u, _ROUNDED):.2g} rad" if math.isfinite(u) else "any" for u in angles)
        yield row("", f"principal moments {', '.join(_share(*pair) for pair in moments)}, axes {', '.join(axes)}")
    for group in uncertainty.principal.equal:
        *others, last = (f"I{index + 1}" for index in group)
        which = "all axes" if len(group) == 3 else f"axes {group[0] + 1} and {group[1] + 1}"
        why = f"{', '.join(others)} and {last} are within 2 u of each other"
        yield row("", f"{which} are undetermined, {'but for their plane, ' if len(group) == 2 else ''}as {why}")
    for remark in uncertainty.remarks:
        yield row("", remark)


def _each(values: Float, bound: float) -> str:
    return ", ".join(f"{cleared(value, bound):.2g}" for value in values.tolist())


def _share(u: float, value: float) -> str:
    """Return an uncertainty as a share of the value."""
    return f"{100 * u / value:.2g} %" if value else f"{u:.2g}"
