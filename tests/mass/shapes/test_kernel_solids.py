"""True shapes of OpenCASCADE's solids against closed forms and identities, and read from STEP."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import inertia
from inertia.errors import TESSELLATED, GeometryError, UsageError
from inertia.mass.shapes.solids import solid_moments
from inertia.mesh.shape import Curve, Shape, Trim
from inertia_cli.main import main

pytest.importorskip("OCP")

from tests.benchmarks.shapes import kernel
from tests.benchmarks.shapes.random_solids import integrated, of_primitives, of_splines
from tests.benchmarks.shapes.solids import SAMPLES


@pytest.mark.parametrize("name", [sample.name for sample in SAMPLES if sample.volume is not None])
def test_the_error_is_within_the_bound(name: str) -> None:
    sample = next(sample for sample in SAMPLES if sample.name == name)
    assert sample.volume is not None
    volume, bound = integrated(sample.make())
    truth = sample.volume()
    assert abs(volume - truth) <= bound + 4e-16 * truth
    assert abs(volume / truth - 1) < (1e-12 if sample.kind == "analytic" else 1e-9)
    assert bound < 1e-9 * truth


@pytest.mark.parametrize("seed", range(12))
def test_what_solids_share_and_unite_adds_up(seed: int) -> None:
    assert all(error <= bound for error, bound in of_primitives(seed))


@pytest.mark.parametrize("seed", range(6))
def test_splines_that_are_cut_or_moved_at_random_add_up(seed: int) -> None:
    assert all(error <= bound for error, bound in of_splines(seed))


_LOFT = kernel.lofted([kernel.ring(2.0, 0.0), kernel.ring(1.0, 3.0, 0.5), kernel.ring(1.5, 6.0)])


@pytest.mark.parametrize(
    "solid",
    [
        _LOFT,
        kernel.filleted(kernel.extruded(kernel.wavy(5, 0.3), (0, 0, 4)), 0.2),
        kernel.nurbs(kernel.torus(2.5, 1)),
        kernel.shelled(_LOFT, 1, 0.2),
    ],
    ids=["loft", "rounded", "rational", "offset"],
)
def test_splines_that_are_cut_or_moved_add_up(solid: Any) -> None:
    tool = kernel.cylinder(0.7, 10, (-5, 0.2, 1.5), (1, 0.1, 0.1))
    whole, shared, rest = (integrated(k) for k in (solid, kernel.common(solid, tool), kernel.cut(solid, tool)))
    assert abs(shared[0] + rest[0] - whole[0]) <= whole[1] + shared[1] + rest[1]
    moved = integrated(kernel.moved(solid, (30, 40, 50), (1, 2, 3), 0.7))
    assert abs(moved[0] - whole[0]) <= moved[1] + whole[1]


def _written(solid: Any, path: Path) -> Path:
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

    Interface_Static.SetIVal_s("write.precision.mode", 0)
    writer = STEPControl_Writer()
    writer.Transfer(solid, STEPControl_AsIs)
    assert writer.Write(str(path)) == IFSelect_RetDone
    return path


@pytest.fixture(scope="module")
def pipe(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A cylinder with a cross hole, off its axis."""
    solid = kernel.cut(kernel.cylinder(2, 10, (0, 0, -5)), kernel.cylinder(1.5, 10, (-5, 0.3, 0), (1, 0, 0)))
    return _written(solid, tmp_path_factory.mktemp("step") / "pipe.step")


def test_step_is_integrated_on_its_faces(pipe: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sample = next(sample for sample in SAMPLES if "eccentric" in sample.name)
    assert sample.volume is not None
    assert main(["analyse", str(pipe), "--accuracy", "1e-9", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["volume"] == pytest.approx(1e-9 * sample.volume(), rel=1e-12)
    assert "tessellation" not in document["error"]
    assert document["mesh"]["shape"]["faces"] == 4
    assert document["mesh"]["shape"]["solids"][0]["volume"] == document["volume"]
    assert main(["analyse", str(pipe)]) == 0
    assert "for the shape as stored" in capsys.readouterr().out


def test_an_accuracy_that_cannot_be_had_is_refused(pipe: Path) -> None:
    part = inertia.read(pipe)
    with pytest.raises(UsageError, match="exact arithmetic is for triangle surfaces") as refusal:
        inertia.analyse(part, accuracy="exact")
    assert TESSELLATED in refusal.value.remedies
    with pytest.raises(GeometryError, match="above the accuracy asked for, 1e-15: ask for a larger figure"):
        inertia.analyse(part, accuracy=1e-15)
    assert part.shape is not None
    sample = next(sample for sample in SAMPLES if sample.name == "spline extruded, edges rounded")
    rounded = kernel.taken_over(sample.make())
    size = np.cbrt(50.0 * 1e-9 / inertia.mass_properties(part, tessellated=True).volume)  # near that of the other solid
    mesh = inertia.Part.from_arrays(size * part.triangles.vertices, part.triangles.faces, "mm")
    loose = replace(mesh, shape=rounded)  # faces that are tangent, and 1e-5 apart
    with pytest.raises(GeometryError, match=r"above the accuracy .* \(the faces of the shape are up to \S+ mm apart"):
        inertia.analyse(loose, accuracy=1e-12)
    assert inertia.analyse(loose, accuracy=1e-6).properties.error.volume < 1e-6


def _changed(shape: Shape, **fields: Any) -> Shape:
    first = shape.solids[0]
    face = replace(first.faces[0], **fields)
    return replace(shape, solids=(replace(first, faces=(face, *first.faces[1:])),))


def test_a_shape_that_contradicts_its_triangles_is_refused(pipe: Path) -> None:
    part = inertia.read(pipe)
    shape = part.shape
    assert shape is not None
    body = shape.solids[0]
    larger = replace(
        part, shape=replace(shape, solids=(body, replace(body, placement=body.placement + np.eye(3, 4, 3))))
    )
    with pytest.raises(GeometryError, match="farther apart than their chord tolerance") as refusal:
        inertia.analyse(larger)
    assert TESSELLATED in refusal.value.remedies
    assert inertia.analyse(larger, tessellated=True).shape is None
    scaled = replace(part, shape=replace(shape, solids=(replace(body, placement=1.001 * body.placement),)))
    with pytest.raises(GeometryError, match="no rotation and translation"):
        inertia.analyse(scaled, accuracy=1e-6)


@pytest.mark.parametrize(
    "damage",
    [
        lambda shape: _changed(shape, inward=not shape.solids[0].faces[0].inward),
        lambda shape: _changed(shape, loops=()),
        lambda shape: _changed(shape, patch=replace(shape.solids[0].faces[0].patch, frame=np.full((4, 3), math.nan))),
        lambda shape: _changed(shape, patch=replace(shape.solids[0].faces[0].patch, frame=1e200 * np.ones((4, 3)))),
        lambda shape: _changed(shape, loops=shape.solids[0].faces[0].loops[:1] * 2),
        lambda shape: _changed(shape, loops=tuple(loop[:-1] for loop in shape.solids[0].faces[0].loops)),
        lambda shape: _changed(
            shape,
            loops=(
                tuple(Trim(Curve("line", t.curve.frame + 9, t.curve.sizes, t.curve.spline), t.start, t.stop, t.edge)
                for t in shape.solids[0].faces[0].loops[0]),
            ),
        ),
        lambda shape: replace(shape, solids=(replace(shape.solids[0], faces=shape.solids[0].faces[1:]),)),
        lambda shape: replace(shape, solids=()),
    ],
)  # fmt: skip
def test_triangles_take_the_place_of_a_damaged_shape(pipe: Path, damage: Any) -> None:
    part = inertia.read(pipe)
    assert part.shape is not None
    broken = replace(part, shape=damage(part.shape))
    answer = inertia.analyse(broken)
    assert answer.shape is None
    assert answer.tessellation is not None
    assert any(note.startswith("the triangles were integrated, as the true shape cannot be: ") for note in answer.notes)
    with pytest.raises(GeometryError) as refusal:
        inertia.analyse(broken, accuracy=1e-9)
    assert TESSELLATED in refusal.value.remedies


def test_solids_are_placed_and_weighed_by_name(pipe: Path) -> None:
    part = inertia.read(pipe)
    assert part.shape is not None
    body = part.shape.solids[0]
    turn = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    mirror = np.diag([1.0, 1.0, -1.0])
    placements = np.eye(3, 4), np.column_stack([turn, [10, 20, 30]]), np.column_stack([mirror, [0, 0, 100]])
    solids = tuple(replace(body, name=name, placement=k) for name, k in zip("aba", placements, strict=True))
    corners = part.triangles.corners()
    meshes = [corners @ k[:, :3].T + k[:, 3] for k in placements]
    meshes[2] = meshes[2][:, ::-1]
    all_of_it = np.concatenate(meshes).reshape(-1, 3)
    chord = None if part.chord is None else np.tile(part.chord, 3)
    surface = inertia.Part.from_arrays(all_of_it, np.arange(len(all_of_it)).reshape(-1, 3), "mm")
    several = replace(surface, chord=chord, shape=replace(part.shape, solids=solids))
    alone = inertia.mass_properties(part, 1000.0)
    apart = inertia.analyse(several, {"a": 1000.0, "b": 3000.0})
    assert apart.properties.mass == pytest.approx(5 * alone.mass, rel=1e-14)
    assert [share.name for share in apart.shares] == ["a", "b"]
    center = [alone.center_of_mass @ k[:, :3].T + 1e-3 * k[:, 3] for k in placements]
    assert apart.properties.center_of_mass == pytest.approx((center[0] + 3 * center[1] + center[2]) / 5, rel=1e-13)
    pieces = [
        inertia.MassProperties(w * alone.mass, w * alone.volume, c, w * k[:, :3] @ alone.inertia @ k[:, :3].T)
        for w, c, k in zip((1, 3, 1), center, placements, strict=True)
    ]
    assert apart.properties.inertia == pytest.approx((pieces[0] + pieces[1] + pieces[2]).inertia, rel=1e-12, abs=1e-18)
    with pytest.raises(UsageError, match="no region or body called 'c'"):
        inertia.analyse(several, {"c": 1000.0, "": 1.0})


def test_a_shell_has_the_true_area(pipe: Path) -> None:
    ball = kernel.taken_over(kernel.sphere(3.0))
    part = inertia.read(pipe)
    assert part.shape is not None
    sheet = solid_moments(ball.solids[0], ball.tolerances, 1e-12, surface=True).moments
    assert float(sheet.zeroth) == pytest.approx(36 * math.pi, rel=1e-14)
    assert float(sheet.central().second[0]) == pytest.approx(36 * math.pi * 3, rel=1e-13)
    thin = inertia.analyse(part, 1000.0, shell=0.1)
    assert thin.shape is not None
    assert thin.properties.mass == pytest.approx(1000 * 1e-4 * thin.area, rel=1e-12)


def test_changed_parts_have_no_true_shape(pipe: Path) -> None:
    part = inertia.read(pipe)
    assert part.chord is not None
    most = np.arange(1, part.triangles.count)
    holed = replace(part, geometry=part.triangles.select(most), chord=part.chord[most], regions=None)
    assert inertia.repair(holed).part.shape is None
    assert inertia.repair(part).part.shape is part.shape
