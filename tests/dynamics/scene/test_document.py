"""Scenes: what a file may say, what it comes to, and the sentence where it says something else."""

import math
from pathlib import Path

import numpy as np
import pytest
from tests.dynamics.scenes import DISC, PLAIN, TOP, scene, table

from inertia.dynamics.loads.gravity import Gravity
from inertia.dynamics.loads.torque import Torque
from inertia.dynamics.scene.body import SceneBody
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.scene.sections import Settings, Start
from inertia.errors import GeometryError, InertiaError, ReadError, UsageError
from inertia.mass.analyse import analyse
from inertia.mass.properties import MassProperties
from inertia.mesh.read import read
from inertia_meshes import catalogue, path

POINT = table(TOP, body__principal_moments=[0, 0, 0])

CONTRACT = """
schema = 1
[body]                                  # one of: part | inertia | principal_moments
part = "t_handle.stl"
unit = "mm"
density = 7850.0
[start]
angular_velocity = [0.001, 10.0, 0.0]   # rad/s
frame = "principal"                     # principal | part | space
attitude = [0, 0, 0, 1]                 # xyzw, part axes to space at t = 0
[constraint]
kind = "free"                           # free | fixed_point | rolling
[[load]]                                # gravity | torque | damping
kind = "gravity"
acceleration = [0, 0, -9.80665]
[run]
duration = 60.0
samples = 6000
accuracy = 1e-10                        # rad, attitude at every sample
"""


def test_a_file_is_read_as_the_contract_says(tmp_path: Path) -> None:
    (tmp_path / "t_handle.stl").write_bytes(path("t_handle.stl").read_bytes())
    file = tmp_path / "scene.toml"
    file.write_text(CONTRACT)
    example = Scene.load(file)
    assert (example.run.duration, example.run.samples, example.run.accuracy) == (60.0, 6000, 1e-10)
    assert example.constraint.kind == "free"
    assert example.gravity.tolist() == [0, 0, -9.80665]
    assert (example.text, example.name) == (CONTRACT, str(file))
    known = catalogue()["t_handle.stl"]["mesh"]
    assert example.body.mass == pytest.approx(7850 * known["volume"] * 1e-9, rel=1e-14)
    np.testing.assert_allclose(example.body.inertia, 7850e-15 * np.array(known["inertia"]), rtol=0, atol=1e-20)
    assert example.body.part is not None
    assert example.body.part.triangles.count == catalogue()["t_handle.stl"]["triangles"]


def test_what_the_moments_are_uncertain_by_is_noted() -> None:
    part = str(path("t_handle.stl"))
    example = scene(body={"part": part, "unit": "mm", "density": "7850±78.5"})
    (note,) = (k for k in example.body.notes if "standard uncertainties" in k)
    plain = scene(body={"part": part, "unit": "mm", "density": 7850})
    hundredths = ", ".join(f"{0.01 * k:.2g}" for k in plain.body.principal.moments.tolist())
    assert f"standard uncertainties of {hundredths} kg m², for those of density;" in note
    assert note.endswith("; a single motion is that of the moments as they are")  # draws of an ensemble are not
    noisy = scene(body={"part": part, "unit": "mm", "mass": "0.05±0.001", "sigma": 0.02})
    assert any("for those of vertices and mass" in k for k in noisy.body.notes)
    assert example.body.inertia.tolist() == plain.body.inertia.tolist()


def test_a_surface_and_lines_carry_the_mass_where_that_is_asked_for(tmp_path: Path) -> None:
    sheet, lines = tmp_path / "sheet.obj", tmp_path / "lines.obj"
    sheet.write_text("v 0 0 0\nv 30 0 0\nv 0 40 0\nf 1 2 3\n")
    lines.write_text("v 0 0 0\nv 100 0 0\nv 100 50 0\nl 1 2 3\n")
    for file, model in ((sheet, {"shell": 1.5}), (lines, {"wire": 2.0})):
        there = {"part": str(file), "unit": "mm", "density": 7850}
        body = scene(body=there | model).body
        alone = analyse(read(file, "mm"), 7850, **model).properties
        assert (body.mass, body.inertia.tolist()) == (alone.mass, alone.inertia.tolist())
        (name, value), *_ = model.items()
        uncertain = scene(body=there | {name: f"{value}±{0.1 * value}"}).body
        assert any("standard uncertainties" in note for note in uncertain.notes)
        with pytest.raises(GeometryError, match=f"use {name} = [A-Z]+ in \\[body\\]"):
            scene(body=there)
        with pytest.raises(UsageError, match=f"leave allow_faults in \\[body\\] or {name} in \\[body\\] out"):
            scene(body=there | model | {"allow_faults": 0.1})
        parts = [there | model | {"name": "base"}, there | model | {"name": "lid", "parent": "base"}]
        assert scene(body=None, part=parts).body.mass == pytest.approx(2 * alone.mass)


def test_a_wire_where_there_are_no_lines_is_to_be_left_out_of_its_table(tmp_path: Path) -> None:
    sheet = tmp_path / "sheet.obj"
    sheet.write_text("v 0 0 0\nv 30 0 0\nv 0 40 0\nf 1 2 3\n")
    there = {"part": str(sheet), "unit": "mm", "wire": 1.0}
    other = {"name": "lid", "parent": "base", "mass": 1.0, "principal_moments": [1, 1, 1]}
    for tables, where in (({"body": there}, "[body]"), ({"part": [there | {"name": "base"}, other]}, "its [[part]]")):
        with pytest.raises(GeometryError) as caught:
            scene(**{"body": None} | tables)
        assert f": leave wire in {where} out, or use shell = THICKNESS in {where}" in str(caught.value)
    with pytest.raises(GeometryError) as caught:
        scene(body=there | {"wire": None})
    text = str(caught.value)
    assert "use shell = THICKNESS in [body] or inertia.repair(part) (inertia.repair(part) with inertia.analyse" in text


def test_small_faults_of_the_part_are_allowed_for_where_that_is_asked_for() -> None:
    part = str(path("broken/overlapping_cubes.stl"))
    example = scene(body={"part": part, "unit": "mm", "allow_faults": 0.1})
    assert any("the tensor has a bound of 0.034 (relative)" in note for note in example.body.notes)
    with pytest.raises(GeometryError, match="overlapping bodies"):
        scene(body={"part": part, "unit": "mm"})
    with pytest.raises(GeometryError, match=r"above the 0\.01 allowed"):
        scene(body={"part": part, "unit": "mm", "allow_faults": 0.01})
    with pytest.raises(UsageError, match="allow_faults"):
        scene(body={"part": part, "unit": "mm", "allow_faults": 1.5})


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ({"principal_moments": [1, 2, 3], "mass": "1±0.1"}, "body.mass"),
        ({"principal_moments": [1, 2, 3], "allow_faults": 0.1}, "body.allow_faults"),
        ({"principal_moments": [1, 2, 3], "sigma": 0.1}, "body.sigma"),
        ({"principal_moments": [1, 2, 3], "shell": 0.1}, "body.shell goes with no principal_moments"),
        ({"part": str(path("assemblies/fan.toml")), "wire": 0.1}, "body.wire goes with a mesh"),
        ({"part": str(path("cube.stl")), "wire": -0.1}, "body.wire is -0.1: it must be positive"),
        ({"part": str(path("cube.stl")), "wire": 1, "shell": 1}, "both a shell and a wire are asked for"),
        ({"part": "t_handle.stl", "density": "7850±"}, "body.density"),
    ],
)
def test_an_uncertainty_that_goes_with_nothing_is_refused(body: dict, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        scene(body=body)


def test_what_is_left_out_has_a_default() -> None:
    example = scene()
    assert example.start.frame == "principal"
    assert example.start.attitude.tolist() == [0, 0, 0, 1]
    assert (example.run.samples, example.run.accuracy) == (11, 1e-10)
    assert (example.start.position, example.start.velocity, example.run.model, example.text) == (None,) * 4
    assert example.gravity.tolist() == [0, 0, 0]


def test_a_windows_file_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    body = "[body]\nprincipal_moments = [1, 2, 3]\n[start]\nangular_velocity = [0, 0, 1]\n[run]\nduration = 1\n"
    file.write_bytes(b"\xef\xbb\xbf" + body.replace("\n", "\r\n").encode())
    assert Scene.load(str(file)).run.duration == 1.0


def test_the_part_is_looked_for_beside_the_file_and_not_beside_the_user(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    changed = table(body={"part": "cube.stl", "unit": "cm", "mass": 6.0})
    example = Scene.from_dict(changed, path("cube.stl").parent)
    np.testing.assert_allclose(example.body.inertia, np.eye(3) * 6 * 0.1**2 / 6, rtol=1e-14)
    with pytest.raises(ReadError, match=r"cube\.stl: there is no such file"):
        Scene.from_dict(changed)


def test_a_scene_is_put_together_in_python() -> None:
    properties = MassProperties(2.0, 1.0, [0, 0, 1], np.diag([3.0, 1.0, 2.0]))
    example = Scene(SceneBody.of(properties), Start(np.array([1, 2, 3])), Settings(2), applied_loads=[Gravity()])
    assert example.angular_velocity.tolist() == pytest.approx([3, 1, 2])  # axis 1 is y, axis 2 is z, axis 3 is x
    assert example.applied_loads[0].acceleration.tolist() == [0, 0, -9.80665]
    with pytest.raises(UsageError, match=r"^start\.angular_velocity\[1\] is nan: it must be finite$"):
        Start([0, np.nan, 0])


def test_principal_components_are_those_of_ascending_moments_unless_the_scene_gave_the_moments() -> None:
    turned = scene(body={"inertia": [[3, 0, 0], [0, 1, 0], [0, 0, 2]]})
    assert turned.angular_velocity.tolist() == [2.0, 0.3, 1.0]
    given = scene(body={"principal_moments": [3, 1, 2]})
    assert given.angular_velocity.tolist() == [0.3, 1.0, 2.0]


def test_components_in_space_are_turned_by_the_attitude() -> None:
    quarter = [0, 0, math.sqrt(0.5), math.sqrt(0.5)]  # takes part x to space y
    example = scene(start={"angular_velocity": [1, 2, 3], "frame": "space", "attitude": quarter})
    np.testing.assert_allclose(example.angular_velocity, [2, -1, 3], atol=1e-15)


def test_an_attitude_loses_its_rounding() -> None:
    example = scene(start__attitude=[0.6, 0.0, 0.0, 0.8 + 1e-9])
    assert np.linalg.norm(example.start.attitude) == pytest.approx(1, abs=4e-16)


def test_a_table_of_torques_is_read_from_csv(tmp_path: Path) -> None:
    (tmp_path / "push.csv").write_text("time,x,y,z\n0, 0, 0, 1\n\n12.5,0,0,-1\n")
    example = Scene.from_dict(table(load=[{"kind": "torque", "table": "push.csv"}]), tmp_path)
    (load,) = example.applied_loads
    assert isinstance(load, Torque)
    assert load.table is not None
    assert load.table.times.tolist() == [0, 12.5]
    assert load.table.torques.tolist() == [[0, 0, 1], [0, 0, -1]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0,0,0,0\n", "has 1 rows"),
        ("0,0,0,0\n1,0,0\n", "line 2: 3 columns"),
        ("t,x,y,z\n0,0,0,0\n1,0,zero,0\n", "line 3: 'zero' is not a finite number"),
    ],
)
def test_a_table_that_is_wrong_says_where(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "push.csv").write_text(text)
    with pytest.raises(ReadError, match=f"push.csv.*{message}"):
        Scene.from_dict(table(load=[{"kind": "torque", "table": "push.csv"}]), tmp_path)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([[0, 0, 0, 0], [9, 0, 0, 0]], "covers 0 … 9 s, but the run goes from 0 to 10 s"),
        ([[1, 0, 0, 0], [10, 0, 0, 0]], "covers 1 … 10 s"),
        ([[2, 0, 0, 0], [1, 0, 0, 0]], "goes back in time"),
        ([[0, 0, 0, 0], [10, 0, math.nan, 0]], "not finite"),
        ([[0, 0, 0], [10, 0, 0]], r"give \(k,\) and \(k, 3\)"),
        ([1, 2, 3, 4], "must be rows of four numbers"),
        ("none.csv", "must be rows of four numbers"),
    ],
)
def test_the_rows_of_a_table_are_checked(rows: list, message: str) -> None:
    with pytest.raises(UsageError, match=rf"load(\[0\])?\.table .*{message}"):
        Scene(scene().body, Start([0, 0, 1]), Settings(10.0), applied_loads=(Torque(table=rows),))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"bodi": {}}, "bodi is unknown: did you mean body?"),
        ({"body__density": 1.0}, "body.density goes with no principal_moments"),
        ({"body__masss": 1.0}, "body.masss is unknown: did you mean mass?"),
        ({"start__angular_velocty": 1.0}, "start.angular_velocty is unknown: did you mean angular_velocity?"),
        ({"run__seconds": 1.0}, "run.seconds is unknown: use duration, samples, accuracy, model, method, time_limit"),
        ({"constraint__kid": "free"}, "constraint.kid is unknown: did you mean kind?"),
        ({"load": [{"kind": "gravity", "accel": [0, 0, 1]}]}, "load[0].accel is unknown: did you mean acceleration?"),
        ({"schema": 2}, "schema is 2"),
        ({"body": None}, "body is missing"),
        ({"start": None}, "start is missing"),
        ({"run": None}, "run is missing"),
        ({"start": {}}, "start.angular_velocity is missing"),
        ({"run": {}}, "run.duration is missing"),
        ({"body": 3}, "body is 3: it must be a table"),
        ({"load": {"kind": "gravity"}}, "load must be a list of tables: write [[load]]"),
        ({"load": [{}]}, "load[0].kind is missing"),
        ({"load": [{"kind": "gravity"}, {"kind": "gravty"}]}, "load[1].kind is 'gravty'"),
        ({"body": {}}, "body has no tensor: give one of part, inertia, principal_moments"),
        ({"body__inertia": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}, "body has both inertia and principal_moments"),
        ({"body": {"part": "cube.stl", "center_of_mass": [0, 0, 0]}}, "body.center_of_mass goes with no part"),
        ({"body__mass": 0}, "body.mass is 0: it must be positive"),
        ({"body__mass": -1.5}, "body.mass is -1.5: it must be positive"),
        ({"body__mass": True}, "body.mass is True: it must be a number"),
        ({"body__principal_moments": [1, 2]}, "body.principal_moments has 2 entries, not 3"),
        ({"body__principal_moments": 5}, "body.principal_moments is 5: body.principal_moments must be three numbers"),
        ({"body": {"inertia": [[1, 0, 0], [0, 1], [0, 0, 1]]}}, "body.inertia[1] has 2 entries, not 3"),
        ({"body": {"inertia": [[1, 0, 0], [0, "x", 0], [0, 0, 1]]}}, "body.inertia[1][1] is 'x'"),
        ({"start__angular_velocity": [0, math.nan, 0]}, "start.angular_velocity[1] is nan: it must be finite"),
        ({"start__angular_velocity": [0, 0, 10**400]}, "start.angular_velocity[2] is 1000"),
        ({"start__angular_velocity": [0, 0, 0]}, "start.angular_velocity is zero"),
        (
            {"start__angular_velocity": [0, 0, 0], "load": [{"kind": "damping", "coefficient": 1}]},
            "is zero, and nothing",
        ),
        ({"start__attitude": [0, 0, 0, 0]}, "start.attitude is zero"),
        ({"start__attitude": [0, 0, 0, 2]}, "start.attitude has length 2"),
        ({"start__attitude": [0, 0, 1]}, "start.attitude has 3 entries, not 4"),
        ({"start__frame": "body"}, "start.frame is 'body': use one of 'principal', 'part', 'space'"),
        ({"start__velocity": "fast"}, "start.velocity is 'fast'"),
        ({"constraint__kind": "fixed-point"}, "did you mean 'fixed_point'?"),
        (
            {"constraint__point": [0, 0, 0]},
            'constraint.point goes with kind = "fixed_point" or kind = "hinge" or kind = "sliding" only',
        ),
        ({"constraint": {"kind": "rolling"}}, "constraint.radius is missing"),
        ({"constraint": {"kind": "rolling", "radius": 1}}, "load needs one of kind"),
        ({"constraint": {"kind": "rolling", "radius": 1, "offset": 0.1}}, "constraint.axis is missing"),
        ({"constraint": {"kind": "rolling", "radius": 0}}, "constraint.radius is 0: it must be positive"),
        ({"constraint": {"kind": "fixed_point"}, "start__velocity": [1, 0, 0]}, "start.velocity is given"),
        ({"load": [{"kind": "damping", "coefficient": -1}]}, "load[0].coefficient is -1: it must not be negative"),
        ({"load": [{"kind": "damping"}]}, "load[0].coefficient is missing"),
        ({"load": [{"kind": "torque"}]}, "load[0] is a torque: give either torque or table"),
        ({"load": [{"kind": "torque", "torque": [1, 0, 0], "frame": "body"}]}, "load[0].frame is 'body'"),
        ({"load": [{"kind": "gravity"}], "body__mass": None}, "body.mass is missing: load[0], gravity, acts on mass"),
        ({"run__duration": 0}, "run.duration is 0: it must be positive"),
        ({"run__duration": math.inf}, "run.duration is inf: it must be finite"),
        ({"run__duration": "a minute"}, "run.duration is 'a minute': it must be a number of seconds"),
        ({"run__samples": 1}, "run.samples is 1: it must be between 2"),
        ({"run__samples": 10.0}, "run.samples is 10.0: it must be a whole number"),
        ({"run__samples": 10**12}, "run.samples is 1000000000000"),
        ({"run__accuracy": 1e-17}, "run.accuracy is 1e-17 rad, finer than an attitude in float64 can be"),
        ({"run__accuracy": 0}, "run.accuracy is 0: it must be positive"),
        ({"run__accuracy": 10}, "run.accuracy is 10 rad"),
        ({"run__model": ""}, "run.model is '': it must be text"),
    ],
)
def test_a_field_that_is_wrong_is_named(changes: dict, words: str) -> None:
    with pytest.raises(UsageError) as caught:
        scene(**changes)
    message = str(caught.value)
    assert message.startswith("the scene: ")
    assert words in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("base", "changes", "message"),
    [
        (PLAIN, {"body__principal_moments": [1, 1, 3]}, "body.principal_moments: .* break the triangle rule"),
        (PLAIN, {"body__principal_moments": [1, 1, -1]}, "body.principal_moments: .* not all positive"),
        (PLAIN, {"body": {"inertia": [[1, 1, 0], [0, 1, 0], [0, 0, 1]]}}, "body.inertia: .* not symmetric"),
        (PLAIN, {"body__principal_moments": [0, 1, 1]}, "smallest principal moment is 0 kg m²"),
        (PLAIN, {"body__principal_moments": [0, 0, 0]}, "the inertia tensor is zero"),
        (TOP, {"body__principal_moments": [0, 0, 0], "constraint__point": [0, 0, 0.04]}, "the inertia tensor is zero"),
    ],
)
def test_what_no_body_can_be_is_refused(base: dict, changes: dict, message: str) -> None:
    with pytest.raises(GeometryError, match=f"^the scene: .*{message}"):
        scene(base, **changes)


@pytest.mark.parametrize(
    ("base", "changes", "message"),
    [
        (TOP, {"body__mass": None, "load": []}, "body.mass is missing: the moments about the fixed point need it"),
        (TOP, {"load": [{"kind": "dissipation", "rate": 1}]}, r"load\[0\] is dissipation, which acts on a free body"),
        (POINT, {"load": [{"kind": "damping", "coefficient": 1}]}, r"load\[0\] is damping: .* takes gravity only"),
        (POINT, {"load": []}, "load needs one of kind = .gravity. for a body whose mass lies on one line"),
        (DISC, {"load": [{"kind": "gravity", "acceleration": [0, 1, -9]}]}, "load needs one of kind .* along −z"),
        (DISC, {"load": [{"kind": "gravity"}, {"kind": "damping", "coefficient": 1}]}, "takes gravity only"),
    ],
)
def test_what_does_not_go_together_is_refused(base: dict, changes: dict, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        scene(base, **changes)


def test_a_fixed_point_beyond_ten_lengths_is_noted() -> None:
    # A bar of 1 kg with moments (ε, ⅟12, ⅟12) kg m²: the ellipsoid with these is 2 √(5/12) = 1.29 m long.
    bar = {"principal_moments": [1e-3, 1 / 12, 1 / 12], "mass": 1.0}
    changes = {"body": bar, "constraint": {"kind": "fixed_point", "point": [12.5, 0, 0]}}
    assert scene(**changes).notes == ()
    changes["constraint"]["point"] = [13.0, 0, 0]
    far = "constraint.point is 13 m from the centre of mass of a body that is about 1.29 m long"
    assert scene(**changes).notes == (f"{far}: it counts in m, along the part axes",)


def test_a_pendulum_may_start_at_rest() -> None:
    assert scene(TOP, start__angular_velocity=[0, 0, 0]).angular_velocity.tolist() == [0, 0, 0]
    with pytest.raises(UsageError, match="is zero, and nothing makes the body turn"):
        scene(TOP, start__angular_velocity=[0, 0, 0], constraint__point=[0, 0, 0.04])  # held at the centre of mass


@pytest.mark.parametrize(
    ("content", "kind", "message"),
    [
        (b"schema = ", ReadError, "it is not TOML: invalid value"),
        (b"[body]\nmass = 1\nmass = 2\n", ReadError, "not TOML"),
        (b"\xff\xfe\x00", ReadError, "it is text in UTF-16: save it as UTF-8"),
        (b"\xff\x00", ReadError, "no text in UTF-8: a scene is a TOML file in UTF-8"),
        (b"", ReadError, "it is empty: write a scene into it"),
        (b"# nothing\n", UsageError, "body is missing"),
        (
            b"[body]\npart = 'nosuch.stl'\n[start]\nangular_velocity=[0,0,1]\n[run]\nduration=1",
            ReadError,
            "no such file",
        ),
    ],
)
def test_a_file_that_cannot_be_read_is_named(tmp_path: Path, content: bytes, kind: type, message: str) -> None:
    file = tmp_path / "scene.toml"
    file.write_bytes(content)
    with pytest.raises(InertiaError, match=message) as caught:
        Scene.load(file)
    assert isinstance(caught.value, kind)
    assert str(tmp_path) in str(caught.value)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=r"nosuch\.toml: there is no such file"):
        Scene.load(tmp_path / "nosuch.toml")


def test_what_a_part_is_wrong_in_is_said_of_the_body(tmp_path: Path) -> None:
    broken = table(body={"part": "broken/missing_face.stl"})
    with pytest.raises(GeometryError, match=r"missing_face\.stl.*boundary loop"):
        Scene.from_dict(broken, path("cube.stl").parent)
    with pytest.raises(UsageError, match="the scene: body: unknown unit 'parsec'"):
        Scene.from_dict(table(body={"part": "cube.stl", "unit": "parsec"}), path("cube.stl").parent)


def test_assumptions_about_a_part_are_noted() -> None:
    example = Scene.from_dict(table(body={"part": "cube.stl"}), path("cube.stl").parent)
    assert [note for note in example.body.notes if "assumed" in note] == [
        "the unit of the part is assumed to be mm",
        "the density of the part is assumed to be 1000 kg/m³",
    ]


def test_a_body_keeps_the_axes_of_moments_that_are_nearly_equal() -> None:
    tensor = np.array([[2.0, 1e-8, 0.0], [1e-8, 2.0, 0.0], [0.0, 0.0, 3.0]])  # axes at 45°, moments 2 ± 1e-8
    body = SceneBody(tensor)
    assert np.abs(body.axes[0, 0]) == 1.0  # equal at the usual tolerance: the part's own axes
    assert np.abs(body.principal_within(0.0).axes[0, 0]) == pytest.approx(math.sqrt(0.5), rel=1e-6)
