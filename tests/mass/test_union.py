"""Mass properties of unions: densities, what is refused, bounds of what reading rounded, and what the outputs say."""

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tests.mesh import solids
from tests.mesh.self_crossing import CROSSING, SOUND, pentagram
from tests.mesh.solids import box, cube, joined, sphere

import inertia
from inertia.mesh.part import Regions
from inertia_cli.main import main
from inertia_meshes import path


def regions(*boxes: tuple, unit: str = "m") -> inertia.Part:
    """Return boxes as a part in which each is a region: "a", "b", ..."""
    surface = joined(*(box(*corners) for corners in boxes))
    index = np.repeat(np.arange(len(boxes)), surface.count // len(boxes)).astype(np.int32)
    part = inertia.Part.from_arrays(surface.vertices, surface.faces, unit=unit)
    return replace(part, regions=Regions(tuple("abcd"[: len(boxes)]), index))


OVERLAPPING = regions(((0, 0, 0), (2, 2, 2)), ((1, 1, 1), (3, 3, 3)))


def test_regions_of_different_densities_that_share_space_are_refused() -> None:
    with pytest.raises(inertia.GeometryError, match=r"regions of different densities share space.*not known"):
        inertia.mass_properties(OVERLAPPING, {"a": 1.0, "b": 2.0}, union=True)


def test_regions_of_one_density_may_share_space() -> None:
    for density in (3.0, {"a": 3.0, "b": 3.0, "": 3.0}):
        result = inertia.mass_properties(OVERLAPPING, density, union=True)
        assert (result.volume, result.mass) == (15.0, 45.0)


def test_regions_apart_are_united_each_by_itself() -> None:
    part = regions(((0, 0, 0), (2, 2, 2)), ((5, 0, 0), (6, 1, 1)), ((1, 1, 1), (3, 3, 3)))
    part = replace(part, regions=Regions(("a", "b"), np.where(part.regions.index == 1, 1, 0).astype(np.int32)))
    analysis = inertia.analyse(part, {"a": 1.0, "b": 2.0}, union=True)
    assert [(share.name, share.volume, share.mass) for share in analysis.shares] == [("a", 15.0, 15.0), ("b", 1.0, 2.0)]
    assert analysis.union.more_than_once == pytest.approx(1.0, rel=1e-14)


def test_regions_that_touch_have_their_densities() -> None:
    part = regions(((0, 0, 0), (2, 2, 2)), ((2, 0, 0), (3, 1, 1)))
    assert inertia.mass_properties(part, {"a": 1.0, "b": 2.0}, union=True).mass == 10.0


def test_a_region_with_a_density_is_closed_by_itself() -> None:
    part = regions(((0, 0, 0), (2, 2, 2)))
    part = replace(part, regions=Regions(("a", "b"), np.repeat([0, 1], [6, 6]).astype(np.int32)))
    with pytest.raises(inertia.GeometryError, match=r"^region 'a' .* is not closed .* one density for the part$"):
        inertia.mass_properties(part, {"a": 1.0, "b": 2.0}, union=True)


def test_bodies_with_densities_by_number_are_not_united() -> None:
    part = solids.part(joined(box((0, 0, 0), (2, 2, 2)), box((1, 1, 1), (3, 3, 3))))
    with pytest.raises(
        inertia.GeometryError, match="densities are given for bodies, and bodies that are united are one"
    ):
        inertia.mass_properties(part, {"1": 1.0, "2": 2.0}, union=True)


@pytest.mark.parametrize("options", [{"shell": 1.0}, {"orientation": "absolute"}])
def test_a_union_is_of_solids_as_they_are_stored(options: dict) -> None:
    with pytest.raises(inertia.UsageError, match="union"):
        inertia.mass_properties(solids.part(joined(cube())), union=True, **options)


def test_a_sound_part_keeps_its_answer_bit_for_bit() -> None:
    part = inertia.Part.from_arrays(*SOUND["ring with a gap"])
    plain, united = inertia.analyse(part), inertia.analyse(part, union=True)
    assert united.part is part
    assert plain.properties.inertia.tobytes() == united.properties.inertia.tobytes()
    assert plain.properties.error == united.properties.error


def test_a_mass_that_was_weighed_is_spread_over_the_union() -> None:
    part = inertia.Part.from_arrays(*CROSSING["hairpin"])
    result = inertia.mass_properties(part, mass=7.0, union=True)
    assert (result.mass, result.volume) == (7.0, pytest.approx(70.0, rel=1e-15))


def test_a_united_part_goes_on_to_other_verbs() -> None:
    union = inertia.unite(inertia.Part.from_arrays(*CROSSING["ring with overlapping ends"]))
    report = inertia.check(union.part)
    assert report.fit
    assert report.crossings_examined
    assert inertia.analyse(union.part).crossings_examined
    assert inertia.unite(union.part).part is union.part


@pytest.mark.parametrize("decimals", [3, 6])
def test_the_bound_holds_for_the_surface_that_the_file_writes(tmp_path: Path, decimals: int) -> None:
    vertices, faces = pentagram()
    written = [[f"{x:.{decimals}f}" for x in point] for point in np.add(vertices, [0.1, 0.2, 0.3]).tolist()]
    lines = [f"v {' '.join(point)}" for point in written] + [f"f {' '.join(map(str, f + 1))}" for f in faces]
    (tmp_path / "star.obj").write_text("\n".join(lines))
    outline = [tuple(map(Fraction, point[:2])) for point in written[:5]]
    from tests.mesh.prisms import moments

    low, high = Fraction(written[0][2]), Fraction(written[5][2])
    exact = moments([(outline, low, high)])["1"] * Fraction(1, 10**9)
    for accuracy in (None, "exact"):
        result = inertia.mass_properties(inertia.read(tmp_path / "star.obj"), union=True, accuracy=accuracy)
        assert abs(Fraction(result.volume) - exact) <= Fraction(result.error.volume) * exact
        assert result.error.volume < 1e-13


def with_chords(chords: list[float], *bodies: solids.Mesh) -> inertia.Part:
    """Return bodies as a part, each with the distance, m, that its triangles may be off."""
    part = solids.part(joined(*bodies), unit="m")
    return replace(part, chord=np.repeat(chords, [len(faces) for _, faces in bodies]))


TILTED = np.array([[2, -2, 1], [1, 2, 2], [-2, -1, 2]]) / 3


@pytest.mark.parametrize("turned", [np.eye(3), TILTED])
@pytest.mark.parametrize("radius", [0.1, 1.0, 3.9])
def test_what_lies_deep_in_another_body_is_off_at_no_cost(turned: np.ndarray, radius: float) -> None:
    bodies = box((0, 0, 0), (10, 10, 10)), sphere((5, 5, 5), radius, 4)
    block, ball = ((vertices @ turned.T, faces) for vertices, faces in bodies)
    analysis = inertia.analyse(with_chords([1e-9, 0.01], block, ball), union=True)
    alone = inertia.analyse(with_chords([1e-9], block))
    assert analysis.properties.volume == pytest.approx(1000, rel=1e-14)
    assert analysis.tessellation.volume == pytest.approx(alone.tessellation.volume, rel=1e-6)
    assert analysis.tessellation.inertia == pytest.approx(alone.tessellation.inertia, rel=1e-6)
    assert "1e-09 m" in analysis.tessellation.method


def test_what_lies_apart_keeps_its_own_chord() -> None:
    bodies = box((0, 0, 0), (2, 2, 2)), box((1, 1, 1), (3, 3, 3)), box((9, 0, 0), (10, 1, 1))
    part = inertia.unite(with_chords([1e-9, 2e-9, 1e-3], *bodies)).part
    assert sorted({*part.chord[part.triangles.corners()[:, 0, 0] > 8].tolist()}) == pytest.approx([1e-3], rel=1e-9)
    assert 2e-9 <= part.chord[part.triangles.corners()[:, 0, 0] < 8].max() < 1e-8


@pytest.mark.parametrize(
    ("boxes", "chords", "true"),
    [
        # a wall that two bodies share, and that neither has where both are off
        ([((0, 0, 0), (5, 5, 1)), ((0, 0, 0.999), (5, 5, 2))], [1e-3, 1e-3], 50 - 25 * 1e-3),
        # a block just under the top of another, which it rises above where it is off
        ([((0, 0, 0), (10, 10, 10)), ((1, 1, 1), (9, 9, 9.999))], [1e-12, 3e-3], 1000 + 64 * 2e-3),
    ],
)
def test_what_may_come_to_light_is_in_the_bound(boxes: list, chords: list[float], true: float) -> None:
    analysis = inertia.analyse(with_chords(chords, *(box(*corners) for corners in boxes)), union=True)
    assert abs(analysis.properties.volume - true) <= analysis.tessellation.volume * analysis.properties.volume


def test_a_chord_that_is_stated_counts_for_what_is_hidden_too() -> None:
    """Twenty plates, each a little into the next, all of which may be thinner at both faces."""
    plates = [box((0, 0, 0.049 * k), (1, 1, 0.049 * k + 0.05)) for k in range(20)]
    part = solids.part(joined(*plates), unit="m")
    stated = inertia.analyse(part, union=True, chord=0.004)
    own = inertia.analyse(replace(part, chord=np.full(part.triangles.count, 0.004)), union=True)
    assert stated.tessellation == own.tessellation
    assert stated.properties.volume - 20 * 0.042 <= stated.tessellation.volume * stated.properties.volume


def test_text_and_json_say_what_counted_more_than_once(capsys: pytest.CaptureFixture[str]) -> None:
    file = str(path("broken/overlapping_cubes.stl"))
    assert main(["analyse", file, "--union", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["mesh"]["union"] == {"crossings": 6, "counted_more_than_once": 1.25e-10, "counted_negative": 0.0}
    assert document["volume"] == 1.875e-09
    assert main(["analyse", file, "--union"]) == 0
    text = capsys.readouterr().out
    assert "Union             1.25e-10 m³ of the stored volume counted more than once" in text
    assert "crossings examined, united" in text
    assert main(["analyse", str(path("cube.stl")), "--union"]) == 0
    assert "nothing to unite: all of the volume counts once already" in capsys.readouterr().out
