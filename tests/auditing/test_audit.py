"""Whole files audited: what is stated is written with and without mistakes, and the verdict follows."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.auditing.shapes import pair, skewed

import inertia
from inertia.arrays import Float
from inertia.auditing.audit import Audit
from inertia.report.audit.text import audit_text
from inertia_cli.main import main
from inertia_meshes import path

Writer = Callable[..., Path]


def split(corners: Float, times: int) -> Float:
    """Return triangles, each split in four, so many times."""
    for _ in range(times):
        halves = (corners + np.roll(corners, -1, axis=1)) / 2
        a, b, c = corners.transpose(1, 0, 2)
        ab, bc, ca = halves.transpose(1, 0, 2)
        corners = (
            np.stack([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]).transpose(2, 0, 1, 3).reshape(-1, 3, 3)
        )
    return corners


def stl(path: Path, corners: Float) -> inertia.Part:
    lines = ["solid s"]
    for triangle in corners:
        points = "".join(f"vertex {x!r} {y!r} {z!r}\n" for x, y, z in triangle.tolist())
        lines.append(f"facet normal 0 0 0\nouter loop\n{points}endloop\nendfacet")
    path.write_text("\n".join([*lines, "endsolid s", ""]))
    return inertia.read(path, "m")


def inertial(mass: float, center: Float, tensor: Float) -> str:
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = tensor.tolist()
    return (
        f'<inertial><origin xyz="{" ".join(map(repr, center.tolist()))}"/><mass value="{mass!r}"/>'
        f'<inertia ixx="{xx!r}" ixy="{xy!r}" ixz="{xz!r}" iyy="{yy!r}" iyz="{yz!r}" izz="{zz!r}"/></inertial>'
    )


def link(name: str, stated: str, *visual: str, collision: str = "") -> str:
    shapes = "".join(f"<visual><geometry>{each}</geometry></visual>" for each in visual)
    shapes += f"<collision><geometry>{collision}</geometry></collision>" if collision else ""
    return f'<link name="{name}">{stated}{shapes}</link>'


def mesh(name: str) -> str:
    return f'<mesh filename="{name}"/>'


@pytest.fixture
def props(tmp_path: Path) -> inertia.MassProperties:
    parts = [stl(tmp_path / shape.name, shape.corners) for shape in pair()]
    return inertia.mass_properties(parts[0], 7850.0) + inertia.mass_properties(parts[1], 7850.0)


@pytest.fixture
def audited(tmp_path: Path) -> Callable[..., Audit]:
    def run(*links: str, joints: str = "", **options: object) -> Audit:
        path = tmp_path / "robot.urdf"
        path.write_text(f'<robot name="r">{"".join(links)}{joints}</robot>')
        return inertia.audit(path, **options)  # type: ignore[arg-type]

    return run


MESHES = [mesh("upper.stl"), mesh("lower.stl")]


def test_what_is_right_is_consistent(props: inertia.MassProperties, audited: Callable[..., Audit]) -> None:
    audit = audited(link("arm", inertial(props.mass, props.center_of_mass, props.inertia), *MESHES))
    assert audit.verdict == "consistent"
    (arm,) = audit.links
    assert arm.findings == ()
    assert arm.densities == pytest.approx((7850.0, 7850.0), rel=1e-12)
    assert arm.difference is not None
    assert arm.difference.inertia < 1e-14
    assert arm.computed is not None
    assert arm.computed.error.inertia < 1e-12


def test_a_mistake_is_found(props: inertia.MassProperties, audited: Callable[..., Audit]) -> None:
    diagonal = np.diag(props.principal_moments[::-1])
    audit = audited(link("arm", inertial(props.mass, props.center_of_mass, diagonal), *MESHES))
    assert audit.verdict == "inconsistent"
    assert [finding.code for finding in audit.links[0].findings] == ["principal_moments_as_diagonal"]


def test_densities_are_inverted(tmp_path: Path, props: inertia.MassProperties, audited: Callable[..., Audit]) -> None:
    parts = [inertia.read(tmp_path / shape.name, "m") for shape in pair()]
    mixed = inertia.mass_properties(parts[0], 1040.0) + inertia.mass_properties(parts[1], 7850.0)
    stated = inertial(mixed.mass, mixed.center_of_mass, mixed.inertia)
    audit = audited(link("arm", stated, *MESHES))
    assert audit.verdict == "consistent"
    assert audit.links[0].densities == pytest.approx((1040.0, 7850.0), rel=1e-6)
    assert [finding.code for finding in audit.links[0].findings] == ["densities"]
    assert audited(link("arm", stated, *MESHES), densities=7850.0).verdict == "inconsistent"
    named = audited(link("arm", stated, *MESHES), densities={"upper.stl": 1040.0, "": 7850.0})
    assert named.verdict == "consistent"


def test_impossible_tensors_are_unphysical(props: inertia.MassProperties, audited: Callable[..., Audit]) -> None:
    audit = audited(link("arm", inertial(1.0, props.center_of_mass, np.diag([1.0, 1.0, 3.0])), *MESHES))
    assert audit.links[0].state == "unphysical"
    assert audit.links[0].findings[0].code == "unphysical"


@pytest.mark.parametrize("zero", ["0", "0.000", "1e-320"])
def test_a_tensor_of_zeros_is_mended(audited: Callable[..., Audit], zero: str) -> None:
    stated = inertial(0.01, np.zeros(3), np.zeros((3, 3))).replace('="0.0"', f'="{zero}"')
    audit = audited(link("a", stated, '<box size="0.1 0.2 0.3"/>'))
    assert audit.links[0].state == "unphysical"
    mended = audit.robot.path.with_name("mended.urdf")
    mended.write_bytes(audit.fixed())
    assert inertia.audit(mended).links[0].state == "consistent"


def test_placeholders(props: inertia.MassProperties, audited: Callable[..., Audit]) -> None:
    stated = inertial(props.mass, props.center_of_mass, 0.1 * np.eye(3))
    right = inertial(props.mass, props.center_of_mass, props.inertia)
    audit = audited(link("arm", stated, *MESHES), link("a", right, *MESHES), link("b", right, MESHES[0]))
    assert [each.findings[-1].code if each.findings else "" for each in audit.links] == [
        "placeholder",
        "",
        "placeholder",
    ]


def test_links_without_anything_are_unjudged(props: inertia.MassProperties, audited: Callable[..., Audit]) -> None:
    stated = inertial(props.mass, props.center_of_mass, props.inertia)
    audit = audited(link("a", "", *MESHES), link("b", stated), link("c", '<inertial><mass value="0"/></inertial>'))
    assert [(each.state, each.findings[0].code) for each in audit.links] == [
        ("unjudged", "nothing_stated"),
        ("unjudged", "no_geometry"),
        ("unjudged", "nothing_stated"),
    ]
    assert audit.verdict == "undecided"


@pytest.mark.parametrize("content", [None, b"", b"solid s\nfacet"])
def test_a_robot_of_which_a_mesh_cannot_be_read_is_not_consistent(
    content: bytes | None, props: inertia.MassProperties, audited: Callable[..., Audit], tmp_path: Path
) -> None:
    if content is not None:
        (tmp_path / "lost.stl").write_bytes(content)
    right = inertial(props.mass, props.center_of_mass, props.inertia)
    beside = [link("a", right, *MESHES), link("b", right, mesh("lost.stl"))]
    audit = audited(*beside)
    assert ([each.state for each in audit.links], audit.verdict) == (["consistent", "unjudged"], "undecided")
    assert audit_text(audit).splitlines()[0].endswith("undecided: 1 consistent, 1 unjudged")
    assert main(["audit", str(audit.robot.path)]) == 4
    wrong = inertial(props.mass, props.center_of_mass, np.diag(props.principal_moments[::-1]))
    assert audited(*beside, link("c", wrong, *MESHES)).verdict == "inconsistent"


def test_links_with_nothing_to_compare_leave_a_robot_consistent(
    props: inertia.MassProperties, audited: Callable[..., Audit]
) -> None:
    right = inertial(props.mass, props.center_of_mass, props.inertia)
    audit = audited(
        link("a", right, *MESHES), link("b", right), link("c", "", *MESHES), link("d", "", mesh("none.stl"))
    )
    assert [each.state for each in audit.links] == ["consistent", "unjudged", "unjudged", "unjudged"]
    assert audit.verdict == "consistent"


def test_the_findings_of_all_links_say_their_links(
    props: inertia.MassProperties, audited: Callable[..., Audit]
) -> None:
    right = inertial(props.mass, props.center_of_mass, props.inertia)
    audit = audited(link("a", right, *MESHES), link("b", right), link("c", right, mesh("none.stl")))
    assert [(each.link, each.code) for each in audit.findings] == [("b", "no_geometry"), ("c", "mesh_unusable")]
    assert audit.findings == tuple(finding for each in audit.links for finding in each.findings)


@pytest.mark.parametrize("beside", ["", '<box size="1 1 1"/></geometry></collision><collision><geometry>'])
def test_what_collides_and_cannot_be_weighed_is_named(
    beside: str, props: inertia.MassProperties, audited: Callable[..., Audit]
) -> None:
    stated = inertial(props.mass, props.center_of_mass, props.inertia)
    (only,) = audited(link("a", stated, collision=f"{beside}{mesh('none.stl')}")).links
    assert (only.state, [each.code for each in only.findings]) == ("unjudged", ["mesh_unusable"])
    assert only.findings[0].sentence.startswith("none.stl: there is no such file")


@pytest.mark.parametrize(
    ("shape", "mass", "moments"),
    [
        ('<box size="0.2 0.4 0.6"/>', 3.0, [3 / 12 * 0.52, 3 / 12 * 0.4, 3 / 12 * 0.2]),
        ('<sphere radius="0.3"/>', 2.0, [0.4 * 2 * 0.09] * 3),
        ('<cylinder radius="0.1" length="0.6"/>', 5.0, [5 / 12 * (0.03 + 0.36)] * 2 + [0.025]),
    ],
)
def test_primitives(audited: Callable[..., Audit], shape: str, mass: float, moments: list[float]) -> None:
    audit = audited(link("a", inertial(mass, np.zeros(3), np.diag(moments)), shape))
    assert audit.verdict == "consistent"
    assert audit.links[0].difference is not None
    assert audit.links[0].difference.inertia < 1e-14


def moments_of_shell(kind: str) -> list[float]:
    """Return the moments of a shell of 1 kg by the formulas of textbooks, or as what grows by no thickness."""
    if kind == "sphere":
        return [2 / 3 * 0.2**2] * 3
    if kind == "cylinder":  # barrel and two discs, by their areas
        barrel, disc = 2 * 0.1 * 0.6, 0.1**2
        total = barrel + 2 * disc
        across = barrel * (0.1**2 / 2 + 0.6**2 / 12) + 2 * disc * (0.1**2 / 4 + 0.3**2)
        return [across / total, across / total, (barrel * 0.1**2 + disc * 0.1**2) / total]
    if kind == "box":  # the derivative of the solid by its thickness, as between two boxes
        moments = [
            np.prod(sides) / 12 * (np.sum(sides**2) - sides**2)
            for sides in (np.array([0.2, 0.4, 0.6]) + 2 * sign * 1e-5 for sign in (1, -1))
        ]
        volumes = [np.prod(np.array([0.2, 0.4, 0.6]) + 2 * sign * 1e-5) for sign in (1, -1)]
        return ((moments[0] - moments[1]) / (volumes[0] - volumes[1])).tolist()
    # A barrel with two half spheres, the centre of each at half the radius beyond its rim.
    barrel, half = 2 * np.pi * 0.1 * 0.5, 2 * np.pi * 0.1**2
    across = barrel * (0.1**2 / 2 + 0.5**2 / 12) + 2 * half * (5 / 12 * 0.1**2 + (0.25 + 0.05) ** 2)
    along = barrel * 0.1**2 + 2 * half * 2 / 3 * 0.1**2
    return [each / (barrel + 2 * half) for each in (across, across, along)]


@pytest.mark.parametrize(
    ("kind", "sizes"),
    [
        ("sphere", 'radius="0.2"'),
        ("cylinder", 'radius="0.1" length="0.6"'),
        ("box", 'size="0.2 0.4 0.6"'),
        ("capsule", 'radius="0.1" length="0.5"'),
    ],
)
def test_a_shell_of_a_primitive_is_weighed_in_closed_form(audited: Callable[..., Audit], kind: str, sizes: str) -> None:
    moments = 3.7 * np.array(moments_of_shell(kind))
    (shell,) = audited(link("a", inertial(3.7, np.zeros(3), np.diag(moments)), f"<{kind} {sizes}/>")).links
    assert shell.findings[0].code == "shell_for_solid"
    assert shell.findings[0].residual < 1e-8
    # ⅔ m r² is m ((2r)² + (2r)²)/12 as well.
    assert [finding.code for finding in shell.findings[1:]] == (["alike"] if kind == "sphere" else [])


@pytest.mark.parametrize("times", [3, 4])
def test_a_hollow_ball_of_facets_is_said_to_be_like_a_box(
    tmp_path: Path, audited: Callable[..., Audit], times: int
) -> None:
    corners = split(
        np.array([[[x, 0, 0], [0, y, 0], [0, 0, z]] for x in (1, -1) for y in (1, -1) for z in (1, -1)]), times
    )
    corners /= np.linalg.norm(corners, axis=2, keepdims=True)
    inwards = np.einsum("ij,ij->i", corners.sum(axis=1), np.cross(*np.diff(corners, axis=1).transpose(1, 0, 2))) < 0
    corners[inwards] = corners[inwards][:, ::-1]
    stl(tmp_path / "ball.stl", corners)
    (ball,) = audited(link("a", inertial(1.37, np.zeros(3), 1.37 * 2 / 3 * np.eye(3)), mesh("ball.stl"))).links
    assert {ball.findings[0].code, ball.findings[1].code} == {"hull_for_mesh", "alike"}
    assert "thin shells" in ball.findings[1].sentence


@pytest.mark.parametrize("mass", [1e-290, 1e-300, 1e-307])
def test_a_difference_is_relative_however_little_a_link_weighs(audited: Callable[..., Audit], mass: float) -> None:
    """Of a ball: ⅖ m r², here stated as m r² itself, so that 60 % are missing."""
    ball = link("a", inertial(mass, np.zeros(3), np.eye(3) * (mass * 0.01)), '<sphere radius="0.1"/>')
    box = link("b", inertial(6000.0, np.zeros(3), 500.0 * np.diag([13, 10, 5])), '<box size="1 2 3"/>')
    small, usual = audited(ball, box).links
    assert small.state == "inconsistent"
    assert small.difference is not None
    assert small.difference.inertia == pytest.approx(0.6, rel=1e-12)
    assert usual.state == "consistent"


def test_what_leaves_float64_is_unjudged_and_the_other_links_are_judged(audited: Callable[..., Audit]) -> None:
    box = link("b", inertial(6000.0, np.zeros(3), 500.0 * np.diag([13, 10, 5])), '<box size="1 2 3"/>')
    tiny = inertial(5e-324, np.zeros(3), 5e-324 * np.eye(3))
    small, usual = audited(link("a", tiny, '<sphere radius="0.1"/>'), box).links
    assert (small.state, [finding.code for finding in small.findings]) == ("unjudged", ["undecided"])
    assert "with the stated mass of 4.94066e-324 kg the comparison leaves float64" in small.findings[0].sentence
    assert usual.state == "consistent"


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1e-200, 1e-100, 1e-40, 1e-12, 1e12, 1e40, 1e100, 1e200])
@pytest.mark.parametrize("mass", [5e-324, 1e-300, 1.0, 1e300])
@pytest.mark.parametrize("moment", [0.0, 5e-324, 1.0, 1e300])
def test_no_size_is_a_fault_of_the_program(
    audited: Callable[..., Audit], size: float, mass: float, moment: float
) -> None:
    shapes = [f'<box size="{size!r} {2 * size!r} {3 * size!r}"/>', f'<sphere radius="{size!r}"/>']
    stated = inertial(mass, np.array([size, 0.0, 0.0]), moment * np.diag([1.0, 0.9, 0.8]))
    for each in audited(link("a", stated, *shapes), link("b", stated, shapes[0])).links:
        assert each.state != "consistent"


def test_a_capsule_is_a_cylinder_and_a_ball(audited: Callable[..., Audit]) -> None:
    radius, length, density = 0.1, 0.5, 1000.0
    barrel, half = np.pi * radius**2 * length * density, 2 / 3 * np.pi * radius**3 * density
    along = barrel * radius**2 / 2 + 2 * half * 2 / 5 * radius**2
    # Of a half ball about its own centre, 3r/8 from its face: 83/320 m r².
    across = barrel * (radius**2 / 4 + length**2 / 12)
    across += 2 * half * (83 / 320 * radius**2 + (length / 2 + 3 / 8 * radius) ** 2)
    stated = inertial(barrel + 2 * half, np.zeros(3), np.diag([across, across, along]))
    audit = audited(link("a", stated, f'<capsule radius="{radius}" length="{length}"/>'))
    assert audit.links[0].difference is not None
    assert audit.links[0].difference.inertia < 1e-14


def test_open_meshes_are_mended_or_replaced_aloud(tmp_path: Path, audited: Callable[..., Audit]) -> None:
    shape = skewed()
    part = stl(tmp_path / "upper.stl", shape.corners)
    right = inertia.mass_properties(part, 7850.0)
    stated = inertial(right.mass, right.center_of_mass, right.inertia)
    stl(tmp_path / "open.stl", split(shape.corners, 3)[1:])
    (mended,) = audited(link("a", stated, mesh("open.stl"))).links
    assert [finding.code for finding in mended.findings] == ["mesh_mended"]
    assert "open.stl: open" in mended.findings[0].sentence
    assert "repaired: holes filled: 1 (of 3 edges" in mended.findings[0].sentence
    assert "that leaves it open to" in mended.findings[0].sentence
    assert mended.state == "consistent"
    assert 0 < mended.room < 0.02
    assert mended.room < mended.computed.error.inertia < 1.2 * mended.room  # the mass is stated
    stl(tmp_path / "gaping.stl", split(shape.corners, 3)[4:])
    (exactly,) = audited(link("a", stated, mesh("gaping.stl"))).links
    assert exactly.room > 0.02
    assert exactly.state == "consistent"  # so it was computed, from this very mesh
    (nearly,) = audited(
        link("a", inertial(right.mass, right.center_of_mass, right.inertia * 1.01), mesh("gaping.stl"))
    ).links
    assert nearly.state == "unjudged"  # the hole may have been closed otherwise
    assert "the meshes leave it open" in nearly.findings[0].sentence
    stl(tmp_path / "sheet.stl", shape.corners[:1])
    (hopeless,) = audited(link("a", stated, mesh("sheet.stl"))).links
    assert (hopeless.state, hopeless.findings[0].code) == ("unjudged", "mesh_unusable")
    (replaced,) = audited(link("a", stated, mesh("sheet.stl"), collision=mesh("upper.stl"))).links
    assert replaced.state == "consistent"
    assert replaced.findings[0].code == "collision_weighed"


def test_fixed_joints_are_lumped(props: inertia.MassProperties, audited: Callable[..., Audit]) -> None:
    stated = inertial(props.mass, props.center_of_mass, props.inertia)
    links = link("a", stated, *MESHES), link("b", stated, *MESHES)
    joints = (
        '<joint name="j" type="fixed"><parent link="a"/><child link="b"/><origin xyz="0 1 0" rpy="0.3 0 0"/></joint>'
    )
    audit = audited(*links, joints=joints, lump=True)
    (whole,) = audit.links
    assert whole.state == "consistent"
    assert whole.stated is not None
    turn = np.array([[1, 0, 0], [0, np.cos(0.3), -np.sin(0.3)], [0, np.sin(0.3), np.cos(0.3)]])
    other = props.expressed_in(turn.T, -turn.T @ [0, 1, 0])
    assert whole.stated.inertia == pytest.approx((props + other).inertia, rel=1e-12)


def test_links_in_any_order_are_lumped_with_what_they_hang_from(audited: Callable[..., Audit]) -> None:
    """Two trees of links with no extent, of which the places are products of 4 × 4 matrices."""
    rng = np.random.default_rng(7)
    names = [f"l{k}" for k in range(60)]
    frames, joints, roots = [np.eye(4), np.eye(4)], [], [0, 1]
    for k in range(2, len(names)):
        above, turn, place = int(rng.integers(k)), float(rng.uniform(-3, 3)), rng.uniform(-1, 1, 3)
        c, s = np.cos(turn), np.sin(turn)
        own = np.block([[np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]), place[:, None]], [0, 0, 0, 1]])
        frames.append(frames[above] @ own)
        roots.append(roots[above])
        origin = f'<origin xyz="{" ".join(map(repr, place.tolist()))}" rpy="0 0 {turn!r}"/>'
        parent = f'<parent link="{names[above]}"/><child link="{names[k]}"/>'
        joints.append(f'<joint name="j{k}" type="fixed">{parent}{origin}</joint>')
    masses = rng.uniform(1, 2, len(names))
    order = rng.permutation(len(names)).tolist()
    links = [link(names[k], inertial(float(masses[k]), np.zeros(3), np.eye(3))) for k in order]
    audit = audited(*links, joints="".join(joints), lump=True)
    assert [each.name for each in audit.links] == [names[k] for k in order if k < 2]
    for each in audit.links:
        own = [k for k in range(len(names)) if names[roots[k]] == each.name]
        mass = masses[own].sum()
        assert each.stated is not None
        assert each.stated.mass == pytest.approx(mass, rel=1e-14)
        center = sum(masses[k] * frames[k][:3, 3] for k in own) / mass
        assert each.stated.center == pytest.approx(center, abs=1e-13)


def test_arguments_are_checked(tmp_path: Path, audited: Callable[..., Audit]) -> None:
    with pytest.raises(inertia.UsageError, match="between 0 and 1"):
        inertia.audit(tmp_path / "x.urdf", tolerance=2.0)
    stl(tmp_path / "upper.stl", skewed().corners)
    stated = inertial(1.0, np.zeros(3), np.eye(3))
    boxed = link("a", stated, mesh("upper.stl"), '<box size="1 1 1"/>')
    with pytest.raises(inertia.UsageError, match="no density is given for box 2: give one by that name"):
        audited(boxed, densities={"upper.stl": 1.0})
    for others in ({}, {"": 1.0}, {"upper.stl": 1.0, "": 2.0}):
        says = r"^no mesh or shape of robot\.urdf is called 'uper': there are upper\.stl, box 2$"
        with pytest.raises(inertia.UsageError, match=says):
            audited(boxed, densities={**others, "uper": 1.0})


def test_mistakes_are_mended_and_nothing_else_changes(
    tmp_path: Path, props: inertia.MassProperties, audited: Callable[..., Audit]
) -> None:
    right = inertial(props.mass, props.center_of_mass, props.inertia)
    wrong = inertial(props.mass, props.center_of_mass, np.diag(props.principal_moments[::-1]))
    odd = inertial(props.mass, props.center_of_mass, props.inertia + 0.3 * np.trace(props.inertia) * np.diag([3, 1, 2]))
    noise = "<!-- kept:  as it is -->\r\n\t<gazebo  reference='x' ></gazebo >"
    audit = audited(link("a", right, *MESHES), noise, link("b", wrong, *MESHES), noise, link("c", odd, *MESHES))
    assert [each.state for each in audit.links] == ["consistent", "inconsistent", "inconsistent"]
    before, after = audit.robot.path.read_bytes().decode(), audit.fixed().decode()
    inertial_of_b = before[before.index('<link name="b">') + 15 :].partition("<visual>")[0]
    kept_before, kept_after = before.split(inertial_of_b), after.split("</inertial>")
    assert after.startswith(kept_before[0])
    assert after.endswith(kept_before[1])
    assert "<!-- mended: the principal moments, descending, are written as ixx, iyy, izz" in kept_after[1]
    (tmp_path / "robot.urdf").write_text(after)
    assert [each.state for each in inertia.audit(tmp_path / "robot.urdf").links] == [
        "consistent",
        "consistent",
        "inconsistent",
    ]


def test_what_cannot_be_mended_does_not_keep_the_rest_from_it(
    tmp_path: Path, props: inertia.MassProperties, capsys: pytest.CaptureFixture[str]
) -> None:
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = props.inertia.tolist()
    place = " ".join(map(repr, props.center_of_mass.tolist()))
    turned = f'<inertial pos="{place}" mass="{props.mass!r}" fullinertia="{xx} {yy} {zz} {-xy} {-xz} {-yz}"/>'
    far = " ".join(map(repr, (1e3 * props.center_of_mass).tolist()))
    elements = " ".join(repr(1e6 * each) for each in (xx, yy, zz, xy, xz, yz))
    mm = f'<inertial pos="{far}" mass="{props.mass!r}" fullinertia="{elements}"/>'
    odd = f'<inertial pos="{place}" mass="{props.mass!r}" diaginertia="{3.3 * xx} {3 * xx} {2.9 * xx}"/>'
    geoms = '<geom type="mesh" mesh="u"/><geom type="mesh" mesh="l"/>'
    (tmp_path / "more.xml").write_text(f'<mujoco><body name="other"><joint/>{turned}{geoms}</body></mujoco>')
    robot, fixed = tmp_path / "r.xml", tmp_path / "fixed.xml"
    assets = '<mesh name="u" file="upper.stl" inertia="exact"/><mesh name="l" file="lower.stl" inertia="exact"/>'
    robot.write_text(
        f"""<mujoco><asset>{assets}</asset><default><geom contype="0" conaffinity="0"/></default><worldbody>
        <body name="signs"><joint/>{turned}{geoms}</body>
        <body name="framed"><joint/><frame>{turned}</frame>{geoms}</body>
        <body name="unit"><joint/>{mm}{geoms}</body>
        <body name="odd"><joint/>{odd}{geoms}</body>
        <include file="more.xml"/></worldbody></mujoco>"""
    )
    assert main(["audit", str(robot), "--fix", str(fixed)]) == 5
    said = [line.partition("fixed.xml: ")[2] for line in capsys.readouterr().err.splitlines()]
    assert said[0] == "framed stays as it is: its <inertial> stands in a <frame>: mend it there"
    assert said[1].startswith("odd stays as it is: it differs from solids of one density")
    assert said[2].startswith("other stays as it is: no <body> of that name stands in the file itself, but in one that")
    assert fixed.read_text().count("<!-- mended: ") == 2
    assert "<!-- mended: centre and tensor are in millimetres -->" in fixed.read_text()
    states = {link.name: link.state for link in inertia.audit(fixed).links}
    assert states == {
        "signs": "consistent", "framed": "unphysical", "unit": "consistent", "odd": "inconsistent",
        "other": "unphysical",
    }  # fmt: skip


@pytest.mark.parametrize(("products", "sign"), [("elements", -1), ("integrals", 1)])
def test_products_of_the_wrong_kind_are_named_by_what_the_field_is_for(
    tmp_path: Path, props: inertia.MassProperties, products: str, sign: int
) -> None:
    wrong = props.inertia * np.where(np.eye(3) > 0, 1, sign)
    stl(tmp_path / "both.stl", np.concatenate([shape.corners for shape in pair()]))
    (tmp_path / "list.toml").write_text(
        f"[[part]]\nname = 'a'\nmass = {props.mass!r}\ncenter_of_mass = {props.center_of_mass.tolist()}\n"
        f"inertia = {wrong.tolist()}\nproducts = '{products}'\nmesh = 'both.stl'\n"
    )
    (link,) = inertia.audit(tmp_path / "list.toml").links
    kinds = ["positive integrals (∫xy dm)", "tensor elements (−∫xy dm)"]
    given, wanted = kinds if products == "elements" else kinds[::-1]
    assert link.findings[-1].sentence == f"the products are {given} where the field wants {wanted}"


def test_a_mass_in_grams_is_mended(props: inertia.MassProperties, audited: Callable[..., Audit]) -> None:
    audit = audited(link("a", inertial(1e3 * props.mass, props.center_of_mass, props.inertia), *MESHES))
    assert [finding.sentence for finding in audit.links[0].findings] == ["the mass is in grams"]
    assert audit.links[0].mended is not None
    assert audit.links[0].mended.mass == pytest.approx(props.mass, rel=1e-14)
    assert audit.links[0].mended.inertia == pytest.approx(props.inertia, rel=1e-12)


def test_another_density_is_named(props: inertia.MassProperties, audited: Callable[..., Audit]) -> None:
    water = props.with_mass(props.mass * 1000.0 / 7850.0)
    audit = audited(link("a", inertial(water.mass, water.center_of_mass, water.inertia), *MESHES), densities=7850.0)
    (finding,) = audit.links[0].findings
    assert finding.code == "other_density"
    assert "1000 kg/m³ (the default of many programs, or water)" in finding.sentence
    assert audit.links[0].mended is not None
    assert audit.links[0].mended.mass == pytest.approx(props.mass, rel=1e-14)


def test_fixed_joints_in_a_circle_are_refused(props: inertia.MassProperties, audited: Callable[..., Audit]) -> None:
    stated = inertial(props.mass, props.center_of_mass, props.inertia)
    joints = "".join(
        f'<joint name="{one}" type="fixed"><parent link="{one}"/><child link="{other}"/></joint>'
        for one, other in ("ab", "ba", "bc")
    )
    links = [link(name, stated, *MESHES) for name in "abc"]
    with pytest.raises(inertia.ReadError, match="hangs from itself"):
        audited(*links, joints=joints, lump=True)
    assert "hangs from itself" in audited(*links, joints=joints).robot.notes[0]


def test_the_round_moments_of_a_sphere_are_no_placeholder(audited: Callable[..., Audit]) -> None:
    stated = inertial(0.06, np.zeros(3), 9.6e-6 * np.eye(3))  # 2/5 · 0.06 kg · (20 mm)²
    (toe,) = audited(link("toe", stated, '<sphere radius="0.0165"/>', collision='<sphere radius="0.02"/>')).links
    assert [finding.code for finding in toe.findings] == ["hull_for_mesh"]


def test_a_mesh_whose_bodies_overlap_is_not_united(tmp_path: Path, audited: Callable[..., Audit]) -> None:
    corners = skewed().corners
    stl(tmp_path / "both.stl", np.concatenate([corners, corners + 0.003]))
    (both,) = audited(link("a", inertial(1.0, corners.mean(axis=(0, 1)), 0.01 * np.eye(3)), mesh("both.stl"))).links
    assert both.state == "unjudged"
    assert "overlapping bodies" in both.findings[0].sentence


COLLADA = """<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.01" name="centimeter"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 30 0 0 0 20 0 0 0 10</float_array><technique_common>
<accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 1 2 3 0 3 2</p></triangles>
</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s"><node id="n">
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""


@pytest.mark.parametrize(("scale", "state"), [("1 1 1", "consistent"), ("0.01 0.01 0.01", "inconsistent")])
def test_a_scale_beside_a_unit_of_the_mesh_s_own_file_is_said_and_named(tmp_path: Path, scale: str, state: str) -> None:
    """By hand: a tetrahedron of 0.3, 0.2 and 0.1 m, ∫x² = V a²/10 about the corner, (3/80) V a² about the centre."""
    (tmp_path / "a.dae").write_text(COLLADA)
    squares = 0.4 * 3 / 80 * np.array([0.09, 0.04, 0.01])
    xx, yy, zz = squares.sum() - squares
    xy, xz, yz = (0.4 / 80 * a * b for a, b in ((0.3, 0.2), (0.3, 0.1), (0.2, 0.1)))
    (tmp_path / "r.urdf").write_text(
        f'''<robot name="r"><link name="a"><inertial><origin xyz="0.075 0.05 0.025"/><mass value="0.4"/>
        <inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="{xy}" ixz="{xz}" iyz="{yz}"/></inertial>
        <visual><geometry><mesh filename="a.dae" scale="{scale}"/></geometry></visual></link></robot>'''
    )
    (link,) = inertia.audit(tmp_path / "r.urdf").links
    codes = [finding.code for finding in link.findings]
    assert link.state == state
    assert ("unit_and_scale" in codes) == ("unit_scale" in codes) == (state == "inconsistent")
    assert link.mended is None


def test_a_list_of_parts_in_step_is_audited_on_their_true_shapes(tmp_path: Path) -> None:
    """A ball of radius 25 mm: 2/5 m r², which its triangles miss by a part in three thousand."""
    pytest.importorskip("OCP")
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
    from tests.mesh.readers.kernel_solids import write_step

    write_step(BRepPrimAPI_MakeSphere(25.0).Shape(), tmp_path / "ball.step")
    (tmp_path / "list.toml").write_text(
        "[[part]]\nname = 'ball'\nmass = 0.5\ncenter_of_mass = [0, 0, 0]\nmesh = 'ball.step'\n"
        "inertia = [[1.25e-4, 0, 0], [0, 1.25e-4, 0], [0, 0, 1.25e-4]]\n"
    )
    (link,) = inertia.audit(tmp_path / "list.toml").links
    assert link.state == "consistent"
    assert link.difference.inertia < 1e-12


@pytest.mark.parametrize("written", [".4g", ".3e", ".6g", ".8f", ".17g"])
@pytest.mark.parametrize("product", ["0", "1e-20", "0.000000", "-1.2345678901234567e-19"])
def test_right_numbers_of_thin_plates_are_physical_however_they_are_rounded(
    audited: Callable[..., Audit], written: str, product: str
) -> None:
    """By m/12 (b² + c²) and so on, where the rounding of each moment is its own."""
    rng = np.random.default_rng(3)
    links = []
    for k in range(10):
        x, y, z = rng.uniform(0.05, 0.5), rng.uniform(0.05, 0.5), 0.001
        mass = 2700 * x * y * z
        moments = [mass / 12 * (y * y + z * z), mass / 12 * (x * x + z * z), mass / 12 * (x * x + y * y)]
        xx, yy, zz = (f"{each:{written}}" for each in moments)
        stated = f'<inertial><origin xyz="0 0 0"/><mass value="{mass:{written}}"/><inertia ixx="{xx}" iyy="{yy}" '
        stated += f'izz="{zz}" ixy="{product}" ixz="0" iyz="0"/></inertial>'
        links.append(link(f"plate{k}", stated, f'<box size="{x} {y} {z}"/>'))
    assert {each.state for each in audited(*links).links} == {"consistent"}


@pytest.mark.parametrize("place", ["0 0 0", "0.0 -0.0 0.0", "0.000 0.000 0.000"])
def test_what_a_hull_allows_is_no_matter_of_how_zero_is_typed(audited: Callable[..., Audit], place: str) -> None:
    """A cube of 0.1 m holds its mass within 0.05 m of its centre, root mean square along an axis."""
    stated = inertial(1.0, np.zeros(3), np.diag([0.51, 0.52, 0.53])).replace("0.0 0.0 0.0", place)
    assert place in stated
    (cube,) = audited(link("a", stated, '<box size="0.1 0.1 0.1"/>')).links
    assert cube.findings[0].code == "outside_hull"
    assert "allows 50 mm at most" in cube.findings[0].sentence


def test_a_centre_typed_as_zero_lies_outside_a_hull_that_is_far_away(audited: Callable[..., Audit]) -> None:
    far = '<box size="0.1 0.1 0.1"/></geometry><origin xyz="0.4 0 0"/><geometry>'
    stated = '<inertial><origin xyz="{}"/><mass value="1"/><inertia ixx="1" iyy="1.1" izz="1.2" {}/></inertial>'
    products = 'ixy="0.01" ixz="0.02" iyz="0.03"'
    typed, coarse = audited(
        link("a", stated.format("0 0 0", products), far), link("b", stated.format("0.3 0 0", products), far)
    ).links
    assert typed.findings[0].sentence == "the centre of mass lies 350 mm outside the convex hull of the meshes"
    assert coarse.findings[0].sentence.endswith("(as written; rounding to so few digits explains it)")


def test_what_no_mistake_explains_is_mended_only_where_no_body_has_it(audited: Callable[..., Audit]) -> None:
    """A cover of 0.1 m with a motor of 5 kg that hangs 0.3 m beside it and has no mesh; and a tensor of nothing."""
    motor = inertial(5.0, np.array([0.3, 0.0, 0.0]), np.diag([0.010, 0.013, 0.016]) + 0.001 * (1 - np.eye(3)))
    broken = inertial(5.0, np.zeros(3), np.diag([0.004, 0.006, 0.0125]) + 0.0005 * (1 - np.eye(3)))
    cover = '<box size="0.1 0.1 0.1"/>'
    audit = audited(link("motor", motor, cover), link("broken", broken, cover))
    assert [[finding.code for finding in each.findings[:2]] for each in audit.links] == [
        ["outside_hull", "unexplained"],
        ["unphysical", "unexplained"],
    ]
    assert [each.mended is None for each in audit.links] == [True, False]
    assert motor.encode() in audit.fixed()
    assert broken.encode() not in audit.fixed()
    (why,) = audit.unmended
    assert why.startswith("motor stays as it is: it differs from solids of one density")


@pytest.mark.parametrize(
    ("scale", "unit"),
    [
        ("1 1 1", "m"),
        ("0.001 0.001 0.001", "mm"),
        ("0.001 -0.001 0.001", "mm"),
        ("0.03 0.03 0.03", "(0.03 m)"),
        ("0.001 0.001 0.002", "(unit of its file)"),
    ],
)
def test_findings_of_a_mesh_are_in_the_unit_that_its_scale_makes_of_its_file(
    tmp_path: Path, audited: Callable[..., Audit], scale: str, unit: str
) -> None:
    corners = skewed().corners[:, ::-1]
    stl(tmp_path / "inside.stl", corners)
    first, *others = np.unique(corners.reshape(-1, 3), axis=0)
    volume = abs(np.linalg.det(np.array(others) - first)) / 6
    part = f'<mesh filename="inside.stl" scale="{scale}"/>'
    (only,) = audited(link("a", inertial(1.0, np.zeros(3), np.eye(3)), part)).links
    (sentence,) = (each.sentence for each in only.findings if each.code == "mesh_mended")
    assert f"the volume is {-volume:.4g} {unit}³ around" in sentence


def test_meshes_of_one_name_are_told_apart_by_their_folders(
    tmp_path: Path, props: inertia.MassProperties, audited: Callable[..., Audit]
) -> None:
    parts = [inertia.read(tmp_path / shape.name, "m") for shape in pair()]
    mixed = inertia.mass_properties(parts[0], 1040.0) + inertia.mass_properties(parts[1], 7850.0)
    for shape in pair():
        folder = tmp_path / shape.name.removesuffix(".stl")
        folder.mkdir()
        (tmp_path / shape.name).rename(folder / "mesh.stl")
    stated = inertial(mixed.mass, mixed.center_of_mass, mixed.inertia)
    robot = link("arm", stated, mesh("upper/mesh.stl"), mesh("lower/mesh.stl"))
    found = audited(robot).links[0].findings[0].sentence
    assert found.startswith("densities of upper/mesh.stl 1040, lower/mesh.stl 7850 kg/m³ reproduce it")
    for densities in ({"upper/mesh.stl": 1040.0, "mesh.stl": 7850.0}, {"upper/mesh.stl": 1040.0, "": 7850.0}):
        (arm,) = audited(robot, densities=densities).links
        assert (arm.state, arm.densities) == ("consistent", (1040.0, 7850.0))
    with pytest.raises(inertia.UsageError, match=r"is called 'per/mesh\.stl'"):
        audited(robot, densities={"per/mesh.stl": 1.0})


def test_shapes_of_links_that_are_lumped_are_called_after_them(audited: Callable[..., Audit]) -> None:
    nothing = inertial(1.0, np.zeros(3), np.eye(3))
    joint = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>'
    links = [link(name, nothing, '<box size="1 1 1"/>') for name in "abc"]
    lumped, alone = audited(*links, joints=joint, lump=True).links
    assert [shape.name for shape in lumped.shapes] == ["a/box 1", "b/box 1"]
    assert [shape.name for shape in alone.shapes] == ["box 1"]


def test_a_density_with_an_uncertainty_is_refused(audited: Callable[..., Audit]) -> None:
    box = link("a", inertial(1.0, np.zeros(3), np.eye(3)), '<box size="1 1 1"/>')
    for density in (inertia.Estimate.parse("960±50"), {"box 1": inertia.Estimate.parse("960±50")}):
        with pytest.raises(inertia.UsageError, match="of 960 kg/m³ has an uncertainty"):
            audited(box, densities=density)


def test_what_mujoco_counts_of_a_mesh_by_its_legacy_rule_is_named(tmp_path: Path) -> None:
    """The figures are those that MuJoCo compiles of a torus, as a model that it saves states them."""
    mujoco = pytest.importorskip("mujoco")
    asset = f'<mujoco><asset><mesh name="m" file="{path("torus.stl")}" scale="0.001 0.001 0.001"/></asset><worldbody>'
    geom = '<geom type="mesh" mesh="m"/></body></worldbody></mujoco>'
    model = mujoco.MjModel.from_xml_string(f'{asset}<body name="a">{geom}')
    mass, *figures = (values[1] for values in (model.body_mass, model.body_ipos, model.body_iquat, model.body_inertia))
    place, turn, moments = (" ".join(map(repr, each.tolist())) for each in figures)
    stated = f'<inertial mass="{float(mass)!r}" pos="{place}" quat="{turn}" diaginertia="{moments}"/>'
    file = tmp_path / "saved.xml"
    file.write_text(f'{asset}<body name="a">{stated}{geom}')
    (body,) = inertia.audit(file).links
    assert body.state == "inconsistent"
    assert body.findings[0].sentence == "it is what MuJoCo's legacy rule counts of the meshes"
    assert body.findings[0].remedy == 'write inertia="exact" in their <mesh>'
