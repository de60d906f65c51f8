"""Bodies of several parts in scene files: what the file may say, what is run, and the sentence for what is wrong."""

import math
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.dynamics.models.deforming import assemblies
from tests.dynamics.scenes import scene

import inertia
from inertia.dynamics.plan import plan
from inertia.dynamics.scene.body import SceneBody
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.scene.sections import Settings, Start
from inertia.dynamics.sensitivity import attitude_uncertainty
from inertia.dynamics.simulate import simulate
from inertia.errors import GeometryError, ReadError, UsageError
from inertia.report.run.document import run_document
from inertia.report.run.text import run_text
from inertia_meshes import path

STOOL: dict[str, Any] = {
    "part": [
        {"name": "man", "mass": 80.0, "principal_moments": [9.0, 9.0, 3.0]},
        {
            "name": "wheel",
            "mass": 1.0,
            "principal_moments": [0.5, 0.5, 1.0],
            "parent": "man",
            "joint": [{"axis": [0, 0, 1], "times": [0.0, 1.0], "angles": [0.0, 2 * math.pi]}],
        },
    ],
    "start": {"angular_velocity": [0.0, 0.0, 0.0], "frame": "part"},
    "run": {"duration": 1.0, "samples": 3},
}


def stool(joint: dict[str, Any] | None = None, wheel: dict[str, Any] | None = None, **sections: Any) -> dict[str, Any]:
    """Return the stool with changes to its joint, to its wheel, and with other sections; None takes a field out."""
    made = deepcopy(STOOL)
    for place, changes in (
        (made["part"][1]["joint"][0], joint or {}),
        (made["part"][1], wheel or {}),
        (made, sections),
    ):
        place.update(changes)
        for name in [name for name, value in changes.items() if value is None]:
            del place[name]
    return made


def test_a_man_who_turns_a_wheel_turns_the_other_way() -> None:
    run = simulate(Scene.from_dict(STOOL))
    assert run.model == "deforming body"
    quarter = [
        [0, 0, 0, 1],
        [0, 0, -math.sin(math.pi / 8), math.cos(math.pi / 8)],
        [0, 0, -math.sqrt(0.5), math.sqrt(0.5)],
    ]
    np.testing.assert_allclose(run.attitude, quarter, atol=1e-12)
    np.testing.assert_array_equal(run.angular_momentum, 0)
    assert run.invariants["angular momentum"].largest_relative_drift < 1e-13  # of what the wheel has, for L is zero
    assert "the angular momentum stays fixed in space" in run.why[-1]
    assert run.remarks[0].startswith("The angular momentum is zero")


@pytest.mark.parametrize("name", ["cat", "diver", "skater"])
def test_sample_scenes_are_the_bodies_that_the_tests_know(name: str) -> None:
    answer, known = Scene.load(path(f"scenes/{name}.toml")).body.assembly, getattr(assemblies, name)()
    assert answer is not None
    instants = np.linspace(0, 6, 50)
    one, other = answer.shape(instants), known.shape(instants)
    np.testing.assert_allclose(one.inertia, other.inertia, atol=1e-14)
    np.testing.assert_allclose(one.internal_angular_momentum, other.internal_angular_momentum, atol=1e-13)


def test_the_start_may_be_given_along_principal_axes_or_in_space() -> None:
    # Together they have the moments 4 about z and 9.5 twice: principal axis 1 is z.
    spins = {"part": [0, 0, 2.0], "principal": [2.0, 0, 0], "space": [0, 0, 2.0]}
    runs = [
        simulate(Scene.from_dict(stool(start={"angular_velocity": spin, "frame": frame})))
        for frame, spin in spins.items()
    ]
    for run in runs:
        np.testing.assert_allclose(run.angular_momentum[0], [0, 0, 8.0], atol=1e-14)


def test_parts_may_be_meshes(tmp_path: Path) -> None:
    for name in ("box.stl", "cube.stl"):
        (tmp_path / name).write_bytes(path(name).read_bytes())
    parts = [
        {"name": "box", "part": "box.stl", "unit": "mm", "density": 1000.0},
        {"name": "cube", "part": "cube.stl", "parent": "box", "joint": STOOL["part"][1]["joint"]},
    ]
    answer = Scene.from_dict(stool(part=parts), tmp_path).body
    whole = sum(
        inertia.mass_properties(inertia.read(path(name), unit="mm"), density=1000.0).mass
        for name in ("box.stl", "cube.stl")
    )
    assert answer.mass == pytest.approx(whole)
    assert [mesh is not None and mesh.triangles.count for mesh in answer.meshes] == [12, 12]
    assert "cube: the unit of the part is assumed to be mm" in answer.notes
    assert not any(note.startswith("box: the unit") for note in answer.notes)


def test_parts_whose_joints_rest_are_one_rigid_body() -> None:
    resting = {"angles": [0.5, 0.5]}
    chosen = plan(Scene.from_dict(stool(resting, start={"angular_velocity": [1, 0, 3]})))
    assert (chosen.model, chosen.why[0]) == ("symmetric top", "No joint moves: the parts make one rigid body.")
    damped = stool(resting, start={"angular_velocity": [1, 0, 3]}, load=[{"kind": "damping", "coefficient": 0.1}])
    assert plan(Scene.from_dict(damped)).model == "Euler equations"


def test_a_body_of_parts_is_put_together_in_python() -> None:
    run = simulate(Scene(SceneBody.of_assembly(assemblies.skater()), Start([0, 0, 8.0], "part"), Settings(6.0, 7)))
    assert run.angular_velocity[2, 2] == pytest.approx(8 * 4.505 / 0.905)


@pytest.mark.parametrize("name", ["cat", "diver", "skater"])
def test_written_anew_a_scene_has_its_joints(name: str) -> None:
    given = Scene.load(path(f"scenes/{name}.toml"))
    one, other = (simulate(each) for each in (given, Scene.loads(given.to_toml())))
    assert other.model == "deforming body"
    np.testing.assert_array_equal(one.attitude, other.attitude)


def test_the_report_and_the_document_tell_of_the_parts() -> None:
    run = simulate(Scene.from_dict(STOOL))
    text, document = run_text(run), run_document(run)
    assert "Parts             man, wheel (1 joint); at the start:\n" in text
    assert "Joint values" in text
    assert "Part poses" not in text
    assert max(map(len, text.splitlines())) < 130
    assert document["body"]["parts"] == ["man", "wheel"]
    assert np.shape(document["quantities"]["part poses"]) == (3, 2, 7)
    assert "parts" not in run_document(simulate(scene()))["body"]


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (stool(body={"principal_moments": [1, 2, 3]}), "part is given beside [body]"),
        (stool(part={"name": "man"}), "part must be a list of tables: write [[part]]"),
        (stool(part=[]), "part is empty"),
        (stool(wheel={"joint": {"axis": [0, 0, 1]}}), "part[1].joint must be a list of tables: write [[part.joint]]"),
        (stool({"times": [0.0, 0.0]}), "part[1].joint[0].times[1] is 0 s, not after the 0 s before it"),
        (stool({"times": [0.0, math.nan]}), "part[1].joint[0].times[1] is nan"),
        (stool({"times": []}), "part[1].joint[0].times is empty"),
        (stool({"times": None}), "part[1].joint[0].times is missing"),
        (stool({"angles": [0.0]}), "part[1].joint[0].angles has 1 entries for 2 times"),
        (stool({"angels": [0.0]}), "part[1].joint[0].angels is unknown: did you mean angles?"),
        (stool({"displacements": [0, 1]}), "part[1].joint[0] has both: give angles for a hinge"),
        (stool({"axis": [0, 0, 0]}), "part[1].joint[0].axis is [0.0, 0.0, 0.0]: it must have a direction"),
        (stool({"rates": [0.0, "fast"]}), "part[1].joint[0].rates[1] is 'fast'"),
        (stool(wheel={"mass": None}), "part[1].mass is missing"),
        (stool(wheel={"mass": -1}), "part[1].mass is -1"),
        (stool(wheel={"name": None}), "part[1].name is missing"),
        (stool(wheel={"name": "man"}), 'part[1].name is "man" like part[0]'),
        (stool(wheel={"parent": "men"}), 'part[1].parent is "men", which is no part: did you mean "man"?'),
        (stool(wheel={"parent": None}), "part[1].parent is missing"),
        (stool(wheel={"density": 1.0}), "part[1].density goes with no principal_moments"),
        (stool(wheel={"weight": 1.0}), "part[1].weight is unknown"),
        (stool(wheel={"principal_moments": None}), "part[1] has no tensor: give one of part, inertia"),
        (stool(wheel={"principal_moments": [1, 2]}), "part[1].principal_moments has 2 entries, not 3"),
        (
            stool(load=[{"kind": "damping", "coefficient": 1}]),
            "load[0] is damping: a body that changes its shape takes",
        ),
        (stool(load=[{"kind": "torque", "torque": [0, 0, 1]}]), "load[0] is torque: a body that changes its shape"),
        (stool(constraint={"kind": "fixed_point"}), 'constraint.kind is "fixed_point": a body that changes its shape'),
    ],
)
def test_a_field_of_a_part_that_is_wrong_is_named(table: dict[str, Any], words: str) -> None:
    with pytest.raises(UsageError) as caught:
        Scene.from_dict(table)
    message = str(caught.value)
    assert message.startswith("the scene: ")
    assert words in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("wheel", "message"),
    [
        ({"principal_moments": [1, 1, 3]}, 'part "wheel".inertia is not physical: .*triangle rule'),
        ({"principal_moments": [1, -1, 1]}, 'part "wheel".inertia is not physical: .* not all positive'),
    ],
)
def test_what_no_part_can_be_is_refused(wheel: dict[str, Any], message: str) -> None:
    with pytest.raises(GeometryError, match=f"^the scene: {message}"):
        Scene.from_dict(stool(wheel=wheel))


def test_what_is_uncertain_of_parts_on_joints_moves_the_attitude_as_that_of_one_body_does() -> None:
    """The same box as one body and as two halves of its mass, by a mass that is as uncertain in both."""
    heavy = {"part": str(path("box.stl")), "unit": "mm"}
    there = {"start": {"angular_velocity": [1.0, 3.0, 8.0], "frame": "part"}, "run": {"duration": 2.0, "samples": 2}}
    still = {"axis": [0, 0, 1], "times": [0.0, 1.0], "angles": [0.0, 0.0]}
    halves = [
        {"name": "base", **heavy, "mass": "0.5±0.01", "sigma": 0.05},
        {"name": "lid", "parent": "base", **heavy, "mass": "0.5±0.01", "sigma": 0.05, "joint": [still]},
    ]
    whole = attitude_uncertainty(simulate(scene(there, body={**heavy, "mass": "1±0.01", "sigma": 0.05})))
    parts = attitude_uncertainty(simulate(scene(there, part=halves)))
    assert whole is not None
    assert parts == pytest.approx(whole / math.sqrt(2.0), rel=1e-3)  # independent halves
    run = simulate(scene(there, part=halves))
    assert run_document(run)["accuracy"]["standard_uncertainty"] == pytest.approx(parts)
    assert "(one standard deviation)" in run_text(run)
    assert attitude_uncertainty(simulate(Scene.from_dict(STOOL))) is None


def test_a_file_that_is_not_there_is_named() -> None:
    with pytest.raises(ReadError, match=r"nosuch\.stl: there is no such file"):
        Scene.from_dict(stool(wheel={"principal_moments": None, "mass": None, "part": "nosuch.stl"}))


def test_a_unit_that_is_unknown_is_said_of_the_part() -> None:
    wheel = {"principal_moments": None, "mass": None, "part": "cube.stl", "unit": "parsec"}
    with pytest.raises(UsageError, match=r"the scene: part\[1\]: unknown unit 'parsec'"):
        Scene.from_dict(stool(wheel=wheel), path("cube.stl").parent)


@pytest.mark.parametrize(
    ("run", "message"),
    [
        ({"model": "symmetric top"}, "does not describe this scene: use one of 'deforming body'"),
        ({"method": "DOP853"}, "run.method is 'DOP853', but a deforming body has one method of its own"),
    ],
)
def test_there_is_one_model_of_a_body_that_changes_its_shape(run: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError) as caught:
        plan(Scene.from_dict(stool(run={"duration": 1.0, **run})))
    assert message in str(caught.value)


def test_too_long_a_run_is_refused_with_the_name_of_the_scene() -> None:
    wheel = {"times": [0.0], "angles": [0.0], "rates": [1e6]}
    with pytest.raises(GeometryError, match=r"^the scene: in 10000 s the parts turn through"):
        simulate(Scene.from_dict(stool(wheel, run={"duration": 1e4})))
