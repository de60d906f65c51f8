"""What one part of an assembly is: its moments, and how they move with each of its uncertain inputs.

A file is integrated once, however many parts it stands for: density and mass scale the moments. The ten moments of a
part are its mass, ∫x and ∫x xᵀ (xx, yy, zz, yz, zx, xy) about its centre of mass; a change of the mass or the density
goes with all of them, one of a scale s with s³, s⁴ and s⁵, one of the centre of mass with ∫x.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np

from inertia.arrays import Float
from inertia.assembly.fields import PartFields
from inertia.assembly.frames import mirror
from inertia.assembly.inputs import Input, Owner, Source
from inertia.errors import SHELL, GeometryError, InertiaError, Sentence, UsageError, reworded, visible
from inertia.estimate import uncertainty_of
from inertia.mass.analyse import analyse, sound_solids_only
from inertia.mass.analysis import Analysis
from inertia.mass.moments import PAIRS, ZERO, Moments, Vector, norm_above, six, vector
from inertia.mass.properties import ErrorBound, MassProperties
from inertia.mesh import primitives
from inertia.mesh.part import Cells, Part
from inertia.mesh.read import read, read_tree
from inertia.mesh.regions import region_of
from inertia.mesh.tree import MeshTree, determinant
from inertia.records import dataclass
from inertia.units import Unit

_PI = Fraction(314159265358979323846264338327950288419716939937510582097494459, 10**62)
_OF_PI = Fraction(1, 2**200)  # how far that is off, relative


@dataclass(frozen=True, eq=False)
class Weight:
    """How heavy a part is: a density, kg/m³, and what it is stated of, or a mass, kg."""

    density: float
    owner: Owner
    mass: float | None = None
    assumed: bool = False


@dataclass(frozen=True, eq=False)
class Body:
    """A kind of part.

    Attributes
    ----------
    moments : kg and m, in its own axes
    volume, volume_bound : m³; 0 where there is none
    method : that ran
    inputs : its uncertain ones
    part : the mesh; None without one
    notes : what was decided, in sentences
    assumed : whether its density is one that nobody stated
    """

    moments: Moments
    volume: Fraction
    volume_bound: Fraction
    method: str
    inputs: tuple[Input, ...] = ()
    part: Part | None = None
    notes: tuple[str, ...] = ()
    assumed: bool = False


class Library:
    """Files that were integrated, each once, with a density of 1 kg/m³; and what they are with others.

    `remarks` are what reading the trees of nested files had to decide, `left_out` what of them has a mass and is not
    in the trees, in sentences.
    """

    def __init__(self) -> None:
        self.remarks: dict[str, None] = {}
        self.left_out: dict[str, None] = {}
        self._analyses: dict[tuple[object, ...], Analysis] = {}
        self._parts: dict[tuple[Path, str | None], Part] = {}
        self._trees: dict[tuple[Path, str | None], MeshTree | None] = {}
        self._bodies: dict[tuple[object, ...], Body] = {}

    def add(
        self, remarks: Iterable[str], tree: tuple[Path, str | None, MeshTree] | None, left_out: Iterable[str] = ()
    ) -> None:
        """Keep what the reading of a file had to decide, and the meshes that it read, by the file and the unit."""
        self.remarks |= dict.fromkeys(remarks)
        self.left_out |= dict.fromkeys(left_out)
        if tree is not None:
            self._trees[tree[:2]] = tree[2]

    def body(self, fields: PartFields, weight: Weight, owner: Owner, folder: Path, unit: Unit) -> Body:
        """Return what a part is, read and integrated where it has a file; its own inputs are those of `owner`.

        Raises `ReadError`, `GeometryError` and `UsageError` of the file, which they name.
        """
        analysis = None
        if fields.file is not None:
            analysis = self._analysis(folder, fields.file, fields, unit)
        tensor = None if fields.inertia is None else fields.inertia.tobytes()
        key = (
            *(
                analysis,
                fields.shape,
                fields.size,
                unit.name,
                float(weight.density),
                weight.mass and float(weight.mass),
            ),
            *(fields.stretch, fields.mirror, fields.center_of_mass, tensor, fields.bound),
        )
        if key not in self._bodies:
            self._bodies[key] = _certain(fields, weight, analysis, unit.metres)
        body = self._bodies[key]
        inputs = (
            tuple(_inputs(fields, weight, owner, body, analysis, unit.metres)) if _is_uncertain(fields, weight) else ()
        )
        return replace(body, inputs=inputs) if inputs else body

    def _analysis(self, folder: Path, file: str, fields: PartFields, unit: Unit) -> Analysis:
        """Return the analysis of a part's file, whose unit is that of the assembly where neither says another."""
        sigma = None if fields.sigma is None else Fraction(fields.sigma) * unit.metres
        key = (
            folder,
            file,
            fields.region,
            fields.mesh,
            fields.unit,
            unit.name,
            sigma,
            fields.shell and float(fields.shell),
        )
        if key not in self._analyses:
            part = self._read(folder / file, fields.unit, fields.mesh)
            if fields.region is not None:
                part = region_of(part, fields.region)
            if part.unit_from == "assumed":
                part = replace(part, unit=unit, unit_from="option")
            try:
                with sound_solids_only("an assembly takes sound solids only, and surfaces by their thickness"):
                    self._analyses[key] = _integrated(part, fields, sigma)
            except GeometryError as error:
                piece = fields.mesh or fields.region
                if piece is None and error.places:
                    raise
                called = str(fields.file) if piece is None else f"{piece!r} of {fields.file}"
                raise reworded(error, error.words, (called,)) from None
        return self._analyses[key]

    def _read(self, path: Path, unit: str | None, mesh: str | None) -> Part:
        if mesh is not None:
            if (path, unit) not in self._trees:
                self._trees[path, unit] = read_tree(path, unit)
            tree = self._trees[path, unit]
            if tree is None:
                raise UsageError(f"{visible(str(path))} is of a format that places no meshes: leave mesh out")
            return tree.part(mesh, visible(str(path)))
        if (path, unit) not in self._parts:
            self._parts[path, unit] = read(path, unit)
        return self._parts[path, unit]


def _integrated(part: Part, fields: PartFields, sigma: Fraction | None) -> Analysis:
    """Return the analysis of a mesh; who is to say how thick a surface is finds a field for it."""
    try:
        return analyse(
            part,
            1.0,
            shell=None if fields.shell is None else float(fields.shell),
            sigma=None if sigma is None else float(sigma / part.unit.metres),
        )
    except GeometryError as error:
        words = (
            f"{SHELL.argument} = {SHELL.value} in the [[part]] of an assembly file" if k == SHELL else k
            for k in Sentence(*error.words).words
        )
        raise reworded(error, words, error.places) from None


def _certain(fields: PartFields, weight: Weight, analysis: Analysis | None, metres: Fraction) -> Body:
    """Return a body without its uncertain inputs."""
    volume, volume_bound, method = ZERO, ZERO, "given"
    notes: tuple[str, ...] = ()
    shape = Moments((ZERO,) * 3, Fraction(1), (ZERO,) * 3, (ZERO,) * 6)
    if analysis is not None:
        properties = analysis.properties
        shape = properties.moments_about(properties.center_of_mass.tolist())
        volume = Fraction(properties.volume)
        volume_bound, method = volume * Fraction(properties.error.volume), properties.error.method
        if fields.stretch is not None:
            shape, size = shape.stretched(fields.stretch), abs(determinant(fields.stretch))
            volume, volume_bound = size * volume, size * volume_bound
        notes = tuple(f"{fields.file}: {note}" for note in analysis.notes)
    elif fields.shape is not None and fields.shape != "point":
        shape = _solid(fields.shape, [metres * Fraction(k) for k in fields.size or ()])
        volume, volume_bound, method = shape.zeroth, shape.zeroth_bound, "closed form"
    moments = shape.scaled(Fraction(weight.density)) if weight.mass is None else shape.weighed(Fraction(weight.mass))
    if fields.mirror is not None:
        moments = moments.turned(mirror(fields.mirror), (ZERO,) * 3)
    if fields.bound is not None:
        moments, method = _loosened(moments, Fraction(fields.bound.mass)), fields.bound.method or method
    moments = _measured(moments, fields, metres)
    part = None if analysis is None else analysis.part
    return Body(moments, volume, volume_bound, method, part=part, notes=notes)


def _is_uncertain(fields: PartFields, weight: Weight) -> bool:
    stated = weight.density, weight.mass, fields.shell, fields.scale
    further = fields.sigma, fields.surface_uncertainty, fields.center_of_mass_uncertainty
    return any(map(uncertainty_of, stated)) or any(further) or fields.inertia_uncertainty is not None


def _loosened(moments: Moments, relative: Fraction) -> Moments:
    """Return moments of a mass that is off by so much of it, and all else in proportion."""
    zeroth, first, second = (
        [bound + relative * (abs(k) + bound) for k, bound in zip(values, bounds, strict=True)]
        for values, bounds in (
            ([moments.zeroth], [moments.zeroth_bound]),
            (moments.first, moments.first_bound),
            (moments.second, moments.second_bound),
        )
    )
    return replace(moments, zeroth_bound=zeroth[0], first_bound=vector(first), second_bound=six(second), norms=None)


def _measured(moments: Moments, fields: PartFields, metres: Fraction) -> Moments:
    """Return the moments with what was measured in place of what was computed."""
    if fields.center_of_mass is None and fields.inertia is None:
        return moments
    mass = moments.zeroth
    central = moments.central()
    bound, tensor_bound = moments.centroid_bound, central.error_norms[1]
    center, second = central.origin, central.second
    if fields.center_of_mass is not None:
        x, y, z = fields.center_of_mass
        center, bound = (metres * x, metres * y, metres * z), ZERO
        if fields.bound is not None:
            bound = metres * Fraction(fields.bound.center_of_mass)
    if fields.inertia is not None:
        try:
            off = 0.0 if fields.bound is None else fields.bound.inertia
            MassProperties(float(mass), 0.0, np.zeros(3), fields.inertia, ErrorBound("given", 0.0, 0.0, 0.0, off))
        except InertiaError as error:
            raise UsageError(f"inertia: {error}") from None
        rows = [[Fraction(k) for k in row] for row in fields.inertia.tolist()]
        half = sum((rows[k][k] for k in range(3)), ZERO) / 2
        xx, yy, zz, yz, zx, xy = ((half if i == j else ZERO) - (rows[i][j] + rows[j][i]) / 2 for i, j in PAIRS)
        second, tensor_bound = (xx, yy, zz, yz, zx, xy), ZERO
        if fields.bound is not None:
            tensor_bound = Fraction(fields.bound.inertia) * norm_above(k for row in rows for k in row)
    # Seen from the centre stated, the true one may be `bound` away: by Steiner's theorem.
    first = (mass + moments.zeroth_bound) * bound
    tensor_bound += Fraction(3, 2) * first * bound
    elements = 2 * tensor_bound
    return Moments(
        center,
        mass,
        (ZERO,) * 3,
        second,
        moments.zeroth_bound,
        (first,) * 3,
        (elements,) * 6,
        (first, tensor_bound),
    )


def _inputs(
    fields: PartFields, weight: Weight, owner: Owner, body: Body, analysis: Analysis | None, metres: Fraction
) -> Iterator[Input]:
    central = body.moments.central()
    mass, center = float(central.zeroth), np.array([float(k) for k in central.origin])
    second = np.array([float(k) for k in central.second])
    whole = np.concatenate([[mass], np.zeros(3), second])
    if weight.mass is None:
        if u := uncertainty_of(weight.density):
            yield Input(Source("density", weight.owner), u / weight.density * whole[np.newaxis])
        shell = fields.shell
        if shell is not None and (u := uncertainty_of(shell)):
            yield Input(Source("thickness", owner), u / shell * whole[np.newaxis])
    elif u := uncertainty_of(weight.mass):
        change = u / weight.mass * whole
        if fields.inertia is not None:
            change[4:] = 0.0
        yield Input(Source("mass", owner), change[np.newaxis])
    if fields.surface_uncertainty and analysis is not None:
        yield Input(Source("surface", owner), _grown(fields, weight, analysis, whole)[np.newaxis])
    if fields.scale is not None and (u := uncertainty_of(fields.scale)):
        grown = np.concatenate([[3.0 * mass], mass * center, 5.0 * second])
        if weight.mass is not None:
            grown[0], grown[4:] = 0.0, 2.0 * second
        if fields.center_of_mass is not None:
            grown[1:4] = 0.0
        if fields.inertia is not None:
            grown[4:] = 0.0
        shared = owner if fields.scale_of is None else Owner(fields.scale_of, kind="scale_of")
        yield Input(Source("scale", shared), u * grown[np.newaxis])
    if u := fields.center_of_mass_uncertainty or 0.0:
        moved = np.zeros((3, 10))
        moved[:, 1:4] = float(metres) * u * mass * np.eye(3)
        yield Input(Source("centre of mass", owner), moved)
    if (spread := fields.inertia_uncertainty) is not None and spread.any():
        each = spread[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        yield Input(Source("tensor", owner), _of_elements(np.diag(each)))
    if analysis is not None and analysis.uncertainty is not None:
        yield Input(Source("vertices", owner), _vertex_changes(analysis, fields, weight, mass))


def _grown(fields: PartFields, weight: Weight, analysis: Analysis, whole: Float) -> Float:
    """Return the change (10,) of the moments for a surface that lies outwards by its uncertainty t: t ∫dA for ∫dV."""
    layer = analyse(analysis.part, 1.0, shell=fields.surface_uncertainty).properties
    moments = layer.moments_about(analysis.properties.center_of_mass.tolist())
    if fields.mirror is not None:
        moments = moments.turned(mirror(fields.mirror), moments.origin)
    change = np.array([float(k) for k in (moments.zeroth, *moments.first, *moments.second)])
    if weight.mass is None:
        change *= float(weight.density)
    else:  # its density follows from its volume
        change = (change * whole[0] - whole * change[0]) / analysis.properties.volume
    if fields.center_of_mass is not None:
        change[1:4] = 0.0
    if fields.inertia is not None:
        change[4:] = 0.0
    return change


def _vertex_changes(analysis: Analysis, fields: PartFields, weight: Weight, mass: float) -> Float:
    """Return independent changes whose squares add up to what noise of the vertices does.

    Which ones does not depend on the mass, as a part may have several, by the materials of the files around its own.
    """
    assert analysis.uncertainty is not None
    covariance, properties = analysis.uncertainty.components["vertices"], analysis.properties
    tensor = properties.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    rates = np.zeros((10, 11))  # of m, ∫x and ∫x xᵀ with volume, m, centre, tensor
    rates[0, 1] = 1.0
    rates[1:4, 2:5] = properties.mass * np.eye(3)
    rates[4:, 5:] = _of_elements(np.eye(6))[:, 4:].T
    if weight.mass is not None:  # all are in proportion to the volume that the mass was found with
        rates[0] = 0.0
        rates[4:, 1] -= _of_elements(tensor[np.newaxis])[0, 4:] / properties.mass
    if fields.center_of_mass is not None:
        rates[1:4] = 0.0
    if fields.inertia is not None:
        rates[4:] = 0.0
    if fields.mirror is not None:
        rates = _moved(mirror(fields.mirror)) @ rates
    values, vectors = np.linalg.eigh(rates @ covariance @ rates.T)
    changes: Float = (vectors * np.sqrt(np.maximum(values, 0.0))).T[values > 1e-30 * max(values[-1], 0.0)]
    return mass / properties.mass * changes


def _of_elements(elements: Float) -> Float:
    """Return changes (k, 10) of the moments for changes (k, 6) of the tensor's xx, yy, zz, xy, xz, yz."""
    xx, yy, zz, xy, xz, yz = elements.T
    half = (xx + yy + zz) / 2
    none = np.zeros_like(xx)
    return np.stack([none, none, none, none, half - xx, half - yy, half - zz, -yz, -xz, -xy], axis=1)


def _moved(rows: tuple[Vector, ...]) -> Float:
    """Return the map (10, 10) of moments about the centre of mass to those of the body turned by R (3, 3)."""
    rotation = np.array([[float(k) for k in row] for row in rows])
    result = np.zeros((10, 10))
    result[0, 0] = 1.0
    result[1:4, 1:4] = rotation
    for column, (i, j) in enumerate(PAIRS):
        unit = np.zeros((3, 3))
        unit[i, j] = unit[j, i] = 1.0
        turned = rotation @ unit @ rotation.T
        result[4:, 4 + column] = [turned[p, q] for p, q in PAIRS]
    return result


def _solid(kind: str, sizes: list[Fraction]) -> Moments:
    """Return the moments of volume of a solid about its origin, by its closed form."""
    bound = ZERO if kind == "box" else _OF_PI
    match kind:
        case "box":
            x, y, z = sizes
            volume = x * y * z
            squares = x * x / 12, y * y / 12, z * z / 12
        case "sphere":
            (r,) = sizes
            volume, squares = _PI * r**3 * 4 / 3, (r * r / 5,) * 3
        case "ellipsoid":
            x, y, z = sizes
            volume, squares = _PI * x * y * z * 4 / 3, (x * x / 5, y * y / 5, z * z / 5)
        case "capsule":
            r, z = sizes
            barrel, ball = r * r * z, r**3 * 4 / 3
            across = (barrel * r * r / 4 + ball * r * r / 5) / (barrel + ball)
            # The centres of the half balls lie 3r/8 beyond the barrel's faces.
            along = (barrel * z * z / 12 + ball * (r * r / 5 + z * z / 4 + 3 * z * r / 8)) / (barrel + ball)
            volume, squares = _PI * (barrel + ball), (across, across, along)
        case "cone":
            r, z = sizes
            volume, squares = _PI * r * r * z / 3, (3 * r * r / 20, 3 * r * r / 20, 3 * z * z / 80)
        case _:
            outer, inner, z = sizes if kind == "tube" else (sizes[0], ZERO, sizes[1])
            across = (outer * outer + inner * inner) / 4
            volume, squares = _PI * (outer * outer - inner * inner) * z, (across, across, z * z / 12)
    xx, yy, zz = (volume * k for k in squares)
    return Moments(
        (ZERO,) * 3,
        volume,
        (ZERO,) * 3,
        (xx, yy, zz, ZERO, ZERO, ZERO),
        bound * volume,
        (ZERO,) * 3,
        (bound * xx, bound * yy, bound * zz, ZERO, ZERO, ZERO),
    )


def triangles_of(fields: PartFields, body: Body, unit: Unit) -> Float | None:
    """Return the triangles (m, 3, 3) m of a part in its own axes; None of what has no surface.

    Those of round shapes have their corners on the shape.
    """
    metres = float(unit.metres)
    if body.part is not None:
        if isinstance(body.part.geometry, Cells):
            return None
        corners = body.part.triangles.corners() * float(body.part.unit.metres)
    elif fields.shape is not None and fields.shape != "point":
        corners = _surface(fields.shape, [metres * float(k) for k in fields.size or ()])
    else:
        return None
    return mapped(fields, corners)


def mapped(fields: PartFields, corners: Float) -> Float:
    """Return triangles (m, 3, 3) of a part's file or shape stretched and mirrored as the part is, facing outwards."""
    maps = [] if fields.stretch is None else [fields.stretch]
    maps += [] if fields.mirror is None else [mirror(fields.mirror)]
    for rows in maps:
        corners = corners @ np.array([[float(k) for k in row] for row in rows]).T
        corners = corners[:, ::-1] if determinant(rows) < 0 else corners
    return corners


def _surface(kind: str, sizes: list[float]) -> Float:
    match kind:
        case "box":
            return primitives.box(np.array(sizes) / 2)
        case "sphere":
            return sizes[0] * primitives.ball()
        case "ellipsoid":
            ball: Float = primitives.ball() * np.array(sizes)
            return ball
        case "capsule":
            r, z = sizes
            ends = r * primitives.ball()
            capsule: Float = ends + np.sign(ends[..., 2:]) * np.array([0, 0, z / 2])
            return capsule
        case "cone":
            r, z = sizes
            return primitives.revolved(z * np.array([-0.25, 0.75]), np.array([r, 0.0]))
        case "tube":
            outer, inner, z = sizes
            heights = z / 2 * np.array([-1.0, 1.0, 1.0, -1.0])
            return primitives.revolved(heights, np.array([outer, outer, inner, inner]), hollow=True)
        case _:
            return primitives.revolved(sizes[1] / 2 * np.array([-1.0, 1.0]), np.full(2, sizes[0]))
