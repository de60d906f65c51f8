"""What geoms of MJCF weigh against what MuJoCo compiles: shells, meshes that are not convex, inline and replicated."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import inertia
from inertia.exchange.robots.links import Primitive
from inertia.exchange.robots.mjcf_masses import legacy, shell
from inertia.exchange.robots.read import read_robot
from inertia.exchange.robots.tree import robot_tree, unweighed
from inertia.mass.properties import MassProperties
from inertia_cli.main import main
from inertia_meshes import path

ANGLE = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)]
SIDES = [(k, (k + 1) % 6, (k + 1) % 6 + 6) for k in range(6)] + [(k, (k + 1) % 6 + 6, k + 6) for k in range(6)]
ENDS = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
CORNERS = [(x, y, z) for z in (0, 0.5) for x, y in ANGLE]
FACES = [*SIDES, *((a, c, b) for a, b, c in ENDS), *((a + 6, b + 6, c + 6) for a, b, c in ENDS)]


def model(inside: str, before: str = "") -> str:
    return f'<mujoco>{before}<worldbody><body name="a"><freejoint/>{inside}</body></worldbody></mujoco>'


def weighed(file: Path) -> tuple[MassProperties, tuple[str, ...]]:
    tree, notes = robot_tree(read_robot(file))
    return inertia.Assembly.from_dict(tree).mass_properties(), notes


def compare(whole: MassProperties, file: Path, accuracy: float) -> None:
    mujoco: Any = pytest.importorskip("mujoco")
    compiled = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(compiled)
    mujoco.mj_kinematics(compiled, data)
    mujoco.mj_comPos(compiled, data)
    center = np.average(data.xipos, axis=0, weights=compiled.body_mass)
    tensor = np.zeros((3, 3))
    for mass, moments, turn, at in zip(
        compiled.body_mass, compiled.body_inertia, data.ximat.reshape(-1, 3, 3), data.xipos, strict=True
    ):
        d = at - center
        tensor += turn @ np.diag(moments) @ turn.T + mass * (d @ d * np.eye(3) - np.outer(d, d))
    assert whole.mass == pytest.approx(compiled.body_mass.sum(), rel=accuracy)
    np.testing.assert_allclose(whole.center_of_mass, center, atol=accuracy * (1 + np.abs(center).max()))
    np.testing.assert_allclose(whole.inertia, tensor, atol=accuracy * np.linalg.norm(tensor))


@pytest.mark.parametrize("scale", ["1 1 1", "0.5 2 -1"])
@pytest.mark.parametrize("weight", ['density="10"', 'mass="3"', 'mass="3" pos="0.1 0.2 0.3" euler="10 20 30"'])
@pytest.mark.parametrize(
    ("mesh", "convex"),
    [("tetrahedron.stl", True), ("torus.stl", False), ("hollow_sphere.stl", False), ("angle", False)],
)
def test_a_mesh_weighs_by_default_what_mujoco_counts_of_it(
    tmp_path: Path, mesh: str, convex: bool, weight: str, scale: str
) -> None:
    corners = np.array(CORNERS)[FACES] if mesh == "angle" else inertia.read(path(mesh)).triangles.corners()
    vertices, faces = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (faces.reshape(-1, 3) + 1).tolist()]
    (tmp_path / "m.obj").write_text("\n".join(lines))
    file = tmp_path / "a.xml"
    asset = '<asset><mesh name="m" file="m.obj" scale="{}" {}/></asset>'
    file.write_text(model(f'<geom type="mesh" mesh="m" {weight}/>', asset.format(scale, "")))
    whole, notes = weighed(file)
    compare(whole, file, 1e-5)
    file.write_text(model(f'<geom type="mesh" mesh="m" {weight}/>', asset.format(scale, 'inertia="exact"')))
    exact, none = weighed(file)
    compare(exact, file, 1e-5)
    assert none == ()
    off = np.linalg.norm(whole.inertia - exact.inertia) / np.linalg.norm(exact.inertia)
    if convex:
        assert (off < 1e-12, notes) == (True, ())
    else:
        assert off > 1e-3
        assert "a/m.obj: its mesh is not convex, and MuJoCo's legacy inertia counts" in notes[0]
        assert 'write inertia="exact" in its <mesh>' in notes[0]
        if "density" in weight:
            assert f"counts {whole.mass:.4g} kg where it encloses {exact.mass:.4g} kg" in notes[0]


def test_a_mesh_counted_twice_for_its_centre_alone_has_the_centre_of_mujoco(tmp_path: Path) -> None:
    sides = [(0, 0), (99, 0), (99, 59), (40, 59), (40, 150), (0, 150)]
    vertices = " ".join(f"{x / 1000} {y / 1000} {z}" for z in (0, 0.14) for x, y in sides)
    faces = " ".join(f"{a} {b} {c}" for a, b, c in FACES)
    file = tmp_path / "a.xml"
    asset = f'<asset><mesh name="m" vertex="{vertices}" face="{faces}"/></asset>'
    file.write_text(model('<geom type="mesh" mesh="m"/>', asset))
    whole, notes = weighed(file)
    compare(whole, file, 1e-6)
    # Of two boxes, by areas.
    left, foot = 40 * 150, 59 * 59
    center = np.array([(left * 20 + foot * 69.5) / (left + foot), (left * 75 + foot * 29.5) / (left + foot), 70])
    away = float(np.linalg.norm(1e3 * whole.center_of_mass - center))
    assert away > 0.1
    assert f"about a centre of mass that is {away:.3g} mm off" in notes[0]


def test_both_are_what_exact_numbers_have() -> None:
    mpmath: Any = pytest.importorskip("mpmath")
    corners = np.array(CORNERS)[FACES] * [1, 3, 0.1] + [7, 1, 1 / 3]
    counted = legacy(corners)
    assert counted is not None
    with mpmath.workdps(60):
        exact = [[mpmath.matrix(corner) for corner in triangle] for triangle in corners.tolist()]

        def dot(u: Any, v: Any) -> Any:
            return sum(u[k] * v[k] for k in range(3))

        def normal(a: Any, b: Any, c: Any) -> Any:
            (x, y, z), (p, q, r) = b - a, c - a
            return mpmath.matrix([y * r - z * q, z * p - x * r, x * q - y * p])

        normals = [normal(*triangle) for triangle in exact]
        middles = [(a + b + c) / 3 for a, b, c in exact]
        areas = [mpmath.sqrt(dot(n, n)) for n in normals]
        apex = sum((a * m for a, m in zip(areas, middles, strict=True)), mpmath.zeros(3, 1)) / sum(areas)
        volumes = [abs(dot(m - apex, n)) / 6 for m, n in zip(middles, normals, strict=True)]
        ends = [v * (apex + 3 * m) / 4 for v, m in zip(volumes, middles, strict=True)]
        center = sum(ends, mpmath.zeros(3, 1)) / sum(volumes)
        volumes = [abs(dot(m - center, n)) / 6 for m, n in zip(middles, normals, strict=True)]
        second = mpmath.zeros(3, 3)
        for volume, triangle in zip(volumes, exact, strict=True):
            arms = [corner - center for corner in triangle]
            for arm in (*arms, arms[0] + arms[1] + arms[2]):
                second += volume * (arm * arm.T) / 20
        total = sum(volumes)
        tensor = (second[0, 0] + second[1, 1] + second[2, 2]) * mpmath.eye(3) - second
        off = max(abs(counted.center[k] - center[k]) for k in range(3))
        astray = mpmath.mnorm(mpmath.matrix(counted.inertia.tolist()) - tensor, "f") / mpmath.mnorm(tensor, "f")
        assert abs(counted.volume - total) / total < counted.error.mass < 1e-7
        assert off < counted.error.center_of_mass < 1e-9
        assert astray < counted.error.inertia < 1e-6


def test_of_the_sample_torus_as_much_more_is_counted_as_is_said() -> None:
    counted = legacy(inertia.read(path("torus.stl"), unit="m").triangles.corners())
    assert counted is not None
    assert counted.volume / counted.encloses == pytest.approx(1.86, abs=5e-3)


@pytest.mark.parametrize("scale", [1e-150, 1e150])
def test_what_float64_cannot_hold_is_not_counted(scale: float) -> None:
    assert legacy(np.array(CORNERS)[FACES] * scale) is None


SHELLS = [("sphere", "0.1"), ("capsule", "0.1 0.2"), ("cylinder", "0.1 0.2"), ("box", "0.1 0.2 0.3")]


@pytest.mark.parametrize("weight", ['density="10"', 'mass="3"', 'mass="3" pos="0.1 0.2 0.3" euler="10 20 30"'])
@pytest.mark.parametrize(("kind", "size"), [*SHELLS, ("ellipsoid", "0.1 0.2 0.3"), ("ellipsoid", "3 0.2 0.1")])
def test_shells_weigh_what_mujoco_has_them_weigh(tmp_path: Path, kind: str, size: str, weight: str) -> None:
    file = tmp_path / "a.xml"
    shape = f'<geom type="{kind}" size="{size}" shellinertia="true" {weight}/>'
    file.write_text(model(f'<geom type="box" size="0.1 0.1 0.1"/>{shape}'))
    whole, notes = weighed(file)
    assert notes == ()
    compare(whole, file, 1e-5 if kind == "ellipsoid" else 1e-14)  # there it is a difference of two that are near


def test_a_shell_is_the_limit_of_a_thin_wall() -> None:
    area, moments = shell(Primitive("capsule", (0.1, 0.4)))
    outer, inner = (Primitive("capsule", (0.1 + k, 0.4)) for k in (1e-6, -1e-6))
    assert area == pytest.approx((outer.volume - inner.volume) / 2e-6, rel=1e-9)
    assert moments[0] == moments[1] > moments[2]


@pytest.mark.parametrize(
    ("inside", "says"),
    [
        ('<geom type="capsule" size="0.1 1e200" shellinertia="true" mass="1"/>', r"size\[1\] is 2e\+200"),
        ('<geom type="ellipsoid" size="1e-200 1 1" shellinertia="true" mass="1"/>', r"size\[0\] is 1e-200"),
        ('<replicate count="4" offset="1e308 0 0"><geom size="1"/></replicate>', "frame, pos is 'inf 0.0 0.0'"),
    ],
)
def test_what_float64_cannot_hold_is_said(tmp_path: Path, inside: str, says: str) -> None:
    file = tmp_path / "a.xml"
    file.write_text(model(inside))
    with pytest.raises(inertia.InertiaError, match=says):
        weighed(file)


@pytest.mark.parametrize("attributes", ["", 'scale="1 2 -3" refpos="0.1 0.2 0.3"', 'refquat="0.5 -0.1 0.7 0.3"'])
@pytest.mark.parametrize("faces", [True, False])
@pytest.mark.parametrize("filling", ["legacy", "exact", "convex", "shell"])
def test_a_mesh_in_the_model_weighs_what_mujoco_has_it_weigh(
    tmp_path: Path, attributes: str, faces: bool, filling: str
) -> None:
    file = tmp_path / "a.xml"
    vertices, around = (" ".join(str(k) for row in rows for k in row) for rows in (CORNERS, FACES))
    mesh = f'<mesh name="m" vertex="{vertices}" inertia="{filling}" {attributes}'
    faced = f' face="{around}"' if faces else ""
    file.write_text(model('<geom type="mesh" mesh="m" pos="1 0 0"/>', f"<asset>{mesh}{faced}/></asset>"))
    whole, notes = weighed(file)
    compare(whole, file, 1e-5)
    assert len(notes) == (faces and filling == "legacy")


@pytest.mark.parametrize(
    ("mesh", "says"),
    [
        ('vertex="0 0 0 1"', "mesh 'm', vertex holds 4 numbers"),
        ('vertex="0 0 0 1 0 0 0 1 0 0 0 1" face="0 1"', "mesh 'm', face holds 2 numbers"),
        ('vertex="0 0 0 1 0 0 0 1 0 0 0 1" face="0 1 4"', "face names a vertex that is not there: there are 4"),
        ('vertex="0 0 0 1 0 0 0 1 0 0 0 1" face="0 1 -1"', "face names a vertex that is not there"),
    ],
)
def test_vertices_and_faces_that_are_none_are_refused(tmp_path: Path, mesh: str, says: str) -> None:
    file = tmp_path / "a.xml"
    file.write_text(model("", f'<asset><mesh name="m" {mesh}/></asset>'))
    with pytest.raises(inertia.ReadError, match=says):
        read_robot(file)


REPLICAS = """
<mujoco><default><default class="q"><geom density="300"/></default></default><worldbody>
  <body name="b" pos="1 2 3"><joint/><geom size="0.1"/>
    <replicate count="4" offset="1 0 0.5" euler="10 20 90"><geom type="box" size="0.1 0.2 0.3" pos="0 1 0"/></replicate>
  </body>
  <replicate count="12" offset="0 5 0" euler="0 0 40" sep="-">
    <body name="r" pos="1 0 0"><joint name="j"/><geom name="g" size="0.1"/>
      <replicate count="2" offset="0 0 1" childclass="q">
        <geom type="capsule" size="0.1 0.2" euler="30 0 0"/>
      </replicate>
    </body>
  </replicate>
</worldbody></mujoco>
"""


def test_replicas_lie_where_mujoco_puts_them(tmp_path: Path) -> None:
    file = tmp_path / "a.xml"
    file.write_text(REPLICAS)
    whole, notes = weighed(file)
    assert notes == ()
    compare(whole, file, 1e-13)
    compiled = pytest.importorskip("mujoco").MjModel.from_xml_path(str(file))
    links = read_robot(file).links
    assert [link.name for link in links] == [compiled.body(k).name for k in range(1, compiled.nbody)]
    joints = [link.joint.name for link in links[1:] if link.joint is not None]
    assert joints == [compiled.joint(k).name for k in range(1, compiled.njnt)]


def test_replicas_of_replicas_end(tmp_path: Path) -> None:
    file = tmp_path / "a.xml"
    file.write_text(model('<replicate count="1000">' * 4 + "<geom/>" + "</replicate>" * 4))
    with pytest.raises(inertia.ReadError, match="more than 100000 elements are made by replicate"):
        read_robot(file)


FITTED = '<asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>'


@pytest.mark.parametrize(
    ("inside", "before", "says"),
    [
        ('<geom type="box" mesh="m"/>', FITTED, "link a, m is left out: a box fitted to a mesh is not read"),
        ('<composite type="cable"/>', "", "composite is not read: what it makes is left out"),
        ('<replicate count="2" quat="1 1 0 0"><geom size="1"/></replicate>', "", "replicate is not read"),
        ('<geom type="mesh" mesh="m" shellinertia="true" mass="2"/>', FITTED, "MuJoCo loads no mesh with shellinertia"),
    ],
)
@pytest.mark.parametrize("command", ["assembly", "budget"])
def test_what_weighs_and_is_not_read_leaves_a_partial_answer(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str, inside: str, before: str, says: str
) -> None:
    file = tmp_path / "a.xml"
    file.write_text(model(f'<geom type="box" size="0.1 0.2 0.3"/>{inside}', before))
    assert says in " ".join(unweighed(read_robot(file)))
    assert main([command, str(file)]) == 4
    printed = capsys.readouterr()
    assert "48 kg" in " ".join(printed.out.split())
    assert "the total is not that of the whole" in printed.err
    assert says in printed.err
    file.write_text(model(inside, before))
    code = main([command, str(file)])
    printed = capsys.readouterr()
    assert (code, printed.out, says in printed.err) == (4, "", True)


def test_a_cause_that_keeps_all_of_a_robot_from_weighing_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for shape, says in (
        ("<mesh><uri>m.stl</uri><scale>2</scale></mesh>", "scale is '2': it must be 3 numbers"),
        ("<polyline><point>0 0</point><height>1</height></polyline>", "'polyline' is no shape that can be weighed"),
    ):
        file = tmp_path / "a.sdf"
        collision = f'<collision name="c"><geometry>{shape}</geometry></collision>'
        link = f'<link name="l"><inertial auto="true"/>{collision}</link>'
        file.write_text(f'<sdf version="1.9"><model name="m">{link}</model></sdf>')
        assert main(["assembly", str(file)]) == 4
        assert says in capsys.readouterr().err


BODIES = """
    <body name="a"><freejoint/><geom size="0.01"/>
      <body name="b" pos="1 0 0"><joint/><geom type="sphere" size="0.3"/><geom type="box" size="0.1 0.1 1"/></body>
      <body name="c" pos="0 1 2"><inertial mass="1" pos="0.1 0 0" diaginertia="0.1 0.2 0.25" euler="10 20 30"/></body>
    </body>
    <body name="d" pos="0 0 3"><inertial mass="3" pos="0 0 0" fullinertia="1 1 1 0.3 0.2 0.1"/></body>
    <body name="e" pos="5 0 0" euler="10 20 30"/>"""


@pytest.mark.parametrize("least", ['boundmass="2" boundinertia="0.8"', 'boundmass="2"', 'boundmass="0.01"'])
@pytest.mark.parametrize("total", ["", ' settotalmass="7"'])
def test_bodies_have_the_least_that_mujoco_raises_them_to(tmp_path: Path, least: str, total: str) -> None:
    file = tmp_path / "a.xml"
    file.write_text(f"<mujoco><compiler {least}{total}/><worldbody>{BODIES}</worldbody></mujoco>")
    whole, _ = weighed(file)
    compare(whole, file, 1e-9)
    assert unweighed(read_robot(file)) == ()


def test_a_mesh_that_may_have_to_be_raised_leaves_a_partial_answer(tmp_path: Path) -> None:
    file = tmp_path / "a.xml"
    mesh = f'<asset><mesh name="m" file="{path("tetrahedron.stl")}"/></asset>'
    file.write_text(model('<geom type="mesh" mesh="m"/>', f'<compiler boundmass="2"/>{mesh}'))
    assert "link a weighs by a mesh or a surface" in unweighed(read_robot(file))[0]


def test_moments_that_mujoco_gives_a_body_without_mass_leave_a_partial_answer(tmp_path: Path) -> None:
    file = tmp_path / "a.xml"
    bodies = '<body name="a"><body name="b"><joint/><geom type="box" size="0.1 0.2 0.3" mass="1"/></body></body>'
    file.write_text(f'<mujoco><compiler boundinertia="0.3"/><worldbody>{bodies}</worldbody></mujoco>')
    assert [sentence.partition(",")[0] for sentence in unweighed(read_robot(file))] == ["link a has no mass"]
    assert main(["assembly", str(file)]) == 4


def test_a_total_mass_of_bodies_without_any_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "a.xml"
    file.write_text('<mujoco><compiler settotalmass="5"/><worldbody><body name="a"/></worldbody></mujoco>')
    assert main(["assembly", str(file)]) == 2
    assert "a.xml: it has no part with a mass" in capsys.readouterr().err
