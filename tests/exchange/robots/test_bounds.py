"""What is computed of robots' shapes is within its bounds of what rational numbers and fifty digits say."""

import struct
from collections.abc import Callable
from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from mpmath import mp, mpf

import inertia
from inertia.exchange.robots.read import read_robot
from inertia.exchange.robots.tree import robot_tree
from inertia.mass.properties import MassProperties
from inertia_cli.main import main

TETRAHEDRON = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
STAGE = """#usda 1.0
(metersPerUnit = {unit})
def Xform "top"
{{
    {top}
    def Xform "body" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
    {{
        {body}
        def Mesh "mesh" (prepend apiSchemas = ["PhysicsCollisionAPI", "PhysicsMeshCollisionAPI"])
        {{
            point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
            int[] faceVertexCounts = [3, 3, 3, 3]
            int[] faceVertexIndices = [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3]
            uniform token subdivisionScheme = "none"
            {mesh}
        }}
    }}
}}
"""
Point = list[mpf]


def ops(**values: str) -> str:
    """Return transform ops, the outermost first; a name that begins with `undo_` undoes one above it."""
    kinds = {"translate": "double3", "pivot": "double3", "scale": "double3", "matrix": "matrix4d", "orient": "quatf"}
    names = {"pivot": "translate:pivot", "matrix": "transform"}
    lines, order = [], []
    for name, value in values.items():
        plain = name.removeprefix("undo_")
        called = f"xformOp:{names.get(plain, plain)}"
        order.append(f'"{"!invert!" if plain != name else ""}{called}"')
        if plain == name:
            lines.append(f"{kinds.get(plain, 'double3' if len(plain) > 7 else 'double')} {called} = {value}")
    return "\n".join([*lines, f"uniform token[] xformOpOrder = [{', '.join(order)}]"])


def turned(axis: int, degrees: float, point: Point) -> Point:
    """Return a point turned about an axis, with fifty digits."""
    angle = mpf(degrees) * mp.pi / 180
    a, b = point[(axis + 1) % 3], point[(axis + 2) % 3]
    result = list(point)
    result[(axis + 1) % 3] = a * mp.cos(angle) - b * mp.sin(angle)
    result[(axis + 2) % 3] = a * mp.sin(angle) + b * mp.cos(angle)
    return result


def truth(corners: list[Point], mass: mpf) -> tuple[mpf, list[mpf], list[list[mpf]]]:
    """Return mass, centre and tensor about it of a tetrahedron: second moments m/20 (Σ v vᵀ + s sᵀ) about any point."""
    center = [sum(v[k] for v in corners) / 4 for k in range(3)]
    away = [[v[k] - center[k] for k in range(3)] for v in corners]
    second = [[mass / 20 * sum(v[i] * v[j] for v in away) for j in range(3)] for i in range(3)]
    trace = second[0][0] + second[1][1] + second[2][2]
    return mass, center, [[(trace if i == j else 0) - second[i][j] for j in range(3)] for i in range(3)]


def volume(corners: list[Point]) -> mpf:
    a, b, c = ([v[k] - corners[0][k] for k in range(3)] for v in corners[1:])
    crossed = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]]
    return abs(sum(p * q for p, q in zip(a, crossed, strict=True))) / 6


def require_within(properties: MassProperties, true: tuple[mpf, list[mpf], list[list[mpf]]], least: float) -> None:
    """Check that what is off is within the bounds, and that these say something."""
    mass, center, tensor = true
    size = mp.sqrt(sum(k * k for row in tensor for k in row))
    off = (
        abs(mpf(properties.mass) - mass) / mass,
        mp.sqrt(sum((mpf(a) - b) ** 2 for a, b in zip(properties.center_of_mass.tolist(), center, strict=True))),
        mp.sqrt(sum((mpf(properties.inertia[i, j].item()) - tensor[i][j]) ** 2 for i in range(3) for j in range(3)))
        / size,
    )
    error = properties.error
    # The bounds of mass and tensor are relative to what is rounded.
    assert [k <= b for k, b in zip(off, (error.mass, error.center_of_mass, error.inertia), strict=True)] == [True] * 3
    assert (error.mass <= least, error.inertia <= least) == (True, True)


@pytest.fixture(autouse=True)
def fifty_digits() -> object:
    with mp.workdps(50):
        yield


def assembled(file: Path) -> MassProperties:
    return inertia.Assembly.from_dict(robot_tree(read_robot(file))[0]).mass_properties()


@pytest.mark.parametrize("offset", [0.1, 1e3, 1e7])
@pytest.mark.parametrize("hull", [False, True])
def test_a_mesh_of_a_stage_far_from_its_link_keeps_its_digits(tmp_path: Path, offset: float, hull: bool) -> None:
    file = tmp_path / "s.usda"
    mesh = ops(translate=f"({offset}, {offset + 0.1}, {-offset})", rotateXYZ="(10, 20, 30)", scale="(1e-3, 2e-3, 1e-3)")
    mesh += '\nuniform token physics:approximation = "convexHull"' if hull else ""
    file.write_text(STAGE.format(unit=1, top="", body="", mesh=mesh))

    def placed(point: tuple[int, ...]) -> Point:
        scaled = [mpf(k) * mpf(s) for k, s in zip(point, (1e-3, 2e-3, 1e-3), strict=True)]
        for axis, angle in enumerate((10, 20, 30)):
            scaled = turned(axis, angle, scaled)
        return [k + mpf(o) for k, o in zip(scaled, (offset, offset + 0.1, -offset), strict=True)]

    corners = [placed(point) for point in TETRAHEDRON]
    require_within(assembled(file), truth(corners, 1000 * volume(corners)), 1e-15)


@pytest.mark.parametrize(
    ("top", "body", "mesh", "place"),
    [
        (
            ops(translate="(1e6, 2e6, 3e6)", rotateZ="33"),
            ops(rotateX="17"),
            ops(rotateY="-41.5", scale="(0.1, 0.1, -0.3)"),
            lambda p: turned(
                0, 0, [turned(1, -41.5, [mpf(0.1) * p[0], mpf(0.1) * p[1], -mpf(0.3) * p[2]])[k] for k in range(3)]
            ),
        ),
        (
            "",
            ops(translate="(5, 5, 5)", scale="(3, 3, 3)"),  # the axes of a link have no scale, and its shapes do
            ops(pivot="(0.25, 0.5, 0.7)", rotateZYX="(12, 0, 50)", undo_pivot=""),
            lambda p: [
                3 * (k + mpf(o))
                for k, o in zip(
                    turned(0, 12, turned(2, 50, [k - mpf(o) for k, o in zip(p, (0.25, 0.5, 0.7), strict=True)])),
                    (0.25, 0.5, 0.7),
                    strict=True,
                )
            ],
        ),
        (
            "",
            "",
            ops(matrix="((1e-3, 2e-3, 0, 0), (0, 1e-3, 0.7e-3, 0), (3e-4, 0, 1e-3, 0), (100.1, 0, 0.3, 1))"),
            lambda p: [
                mpf(1e-3) * p[0] + mpf(3e-4) * p[2] + mpf(100.1),
                mpf(2e-3) * p[0] + mpf(1e-3) * p[1],
                mpf(0.7e-3) * p[1] + mpf(1e-3) * p[2] + mpf(0.3),
            ],
        ),
    ],
)
def test_transform_ops_are_rational(
    tmp_path: Path, top: str, body: str, mesh: str, place: Callable[[Point], Point]
) -> None:
    """In the axes of the link, in which the audit has it: nothing of where that lies is in it."""
    file = tmp_path / "s.usda"
    file.write_text(STAGE.format(unit=0.01, top=top, body=body, mesh=mesh))
    (geometry,) = read_robot(file).links[0].geometries
    transform = geometry.transform
    assert transform is not None
    for point in TETRAHEDRON:
        mine = [
            sum(mpf(a.numerator) / a.denominator * k for a, k in zip(row, point, strict=True))
            + mpf(t.numerator) / t.denominator
            for row, t in zip(transform.linear, transform.at, strict=True)
        ]
        true = [k / 100 for k in place([mpf(k) for k in point])]
        assert max(abs(a - b) for a, b in zip(mine, true, strict=True)) < mpf(10) ** -45


def test_an_orientation_is_what_openusd_makes_of_it(tmp_path: Path) -> None:
    """Of length 1 up to what float32 rounds: the turn is by 2 arccos of its real part."""
    pytest.importorskip("pxr")
    from pxr import Usd, UsdGeom

    file = tmp_path / "s.usda"
    file.write_text(STAGE.format(unit=1, top="", body="", mesh=ops(orient="(0.8, 0.1, 0.5, 0.3162278)")))
    (geometry,) = read_robot(file).links[0].geometries
    assert geometry.transform is not None
    mine = np.array(geometry.transform.linear, float)
    stage = Usd.Stage.Open(str(file))
    theirs = np.array(UsdGeom.Xformable(stage.GetPrimAtPath("/top/body/mesh")).GetLocalTransformation())[:3, :3].T
    assert np.abs(mine - theirs).max() < 1e-15
    exact = geometry.transform.linear
    gram = [[sum(a * b for a, b in zip(p, q, strict=True)) for q in exact] for p in exact]
    assert max(abs(gram[i][j] - (i == j)) for i in range(3) for j in range(3)) < Fraction(1, 10**50)


@pytest.mark.parametrize("reset", [False, True])
def test_instances_and_stacks_that_are_reset_lie_where_openusd_has_them(tmp_path: Path, reset: bool) -> None:
    from pxr import Usd, UsdGeom

    file = tmp_path / "s.usda"
    mesh = ops(translate="(1, 2, 3)", rotateXZY="(10, 20, 30)")
    mesh = mesh.replace("= [", '= ["!resetXformStack!", ') if reset else mesh
    text = STAGE.format(unit=1, top=ops(rotateZ="20"), body=ops(translate="(7, 8, 9)", rotateX="50"), mesh=mesh)
    inner = text.partition('    def Mesh "mesh"')[2].rpartition("}\n    }\n")[0]
    proto = f'class Xform "proto"\n{{\ndef Scope "scope"\n{{\ndef Mesh "mesh"{inner}}}\n}}\n}}\n'
    use = (
        f'def Xform "one" (instanceable = true\nprepend references = </proto>)\n{{\n{ops(translate="(0, 1, 0)")}\n}}\n'
    )
    text = text.replace(f'    def Mesh "mesh"{inner}}}\n', use).replace("def Xform", f"{proto}def Xform", 1)
    file.write_text(text)
    (geometry,) = read_robot(file).links[0].geometries
    assert geometry.transform is not None
    stage = Usd.Stage.Open(str(file))
    prims = ("/top/body/one/scope/mesh", "/top/body")
    own, body = (np.array(UsdGeom.XformCache().GetLocalToWorldTransform(stage.GetPrimAtPath(k))) for k in prims)
    theirs = own @ np.linalg.inv(body)
    assert np.allclose(np.array(geometry.transform.linear, float), theirs[:3, :3].T, atol=1e-14)
    assert np.allclose(np.array(geometry.transform.at, float), theirs[3, :3], atol=1e-13)


def stl(points: np.ndarray, file: Path) -> list[Point]:
    """Write the tetrahedron of points (4, 3), and return its corners as float32 holds them."""
    stored = np.asarray(points, np.float32)
    records = [struct.pack("<12fH", 0, 0, 0, *stored[list(face)].ravel().tolist(), 0) for face in FACES]
    file.write_bytes(b"\0" * 80 + struct.pack("<I", len(records)) + b"".join(records))
    return [[mpf(k) for k in row] for row in stored.astype(float).tolist()]


MJCF = """<mujoco><asset><mesh name="m" file="m.stl" inertia="{0}" scale="{1}"/></asset>
<worldbody><body><joint/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>"""


@pytest.mark.parametrize("kind", ["exact", "convex"])
@pytest.mark.parametrize("scale", ["1 1 1", "0.001 0.001 0.001", "0.1 0.3 -0.7"])
@pytest.mark.parametrize("offset", [0.0, 1000.0])
def test_meshes_of_mujoco_are_within_their_bounds(tmp_path: Path, kind: str, scale: str, offset: float) -> None:
    """A factor counts as its decimals say: 0.1 is one tenth."""
    points = np.array(TETRAHEDRON) * [0.3, 0.4, 0.5] + [offset, -offset, offset]
    own = stl(points, tmp_path / "m.stl")
    file = tmp_path / "m.xml"
    file.write_text(MJCF.format(kind, scale))
    corners = [[k * mpf(s) for k, s in zip(v, scale.split(), strict=True)] for v in own]
    require_within(assembled(file), truth(corners, 1000 * volume(corners)), 1e-12)


@pytest.mark.parametrize("scale", ["1 1 1", "0.001 -0.001 0.001", "0.1 0.3 -0.7"])
@pytest.mark.parametrize("offset", [0.0, 1000.0])
def test_a_shell_of_mujoco_is_within_its_bounds(tmp_path: Path, scale: str, offset: float) -> None:
    own = stl(np.array(TETRAHEDRON) * [0.3, 0.4, 0.5] + [offset, -offset, offset], tmp_path / "m.stl")
    file = tmp_path / "m.xml"
    file.write_text(MJCF.format("shell", scale))
    corners = [[k * mpf(s) for k, s in zip(v, scale.split(), strict=True)] for v in own]
    areas, seconds, firsts = [], [], []
    for face in FACES:
        a, b, c = (corners[k] for k in face)
        p, q = ([y - x for x, y in zip(a, other, strict=True)] for other in (b, c))
        square = sum(k * k for k in p) * sum(k * k for k in q) - sum(x * y for x, y in zip(p, q, strict=True)) ** 2
        area = 1000 * mp.sqrt(square) / 2  # 1000 kg/m²
        total = [x + y + z for x, y, z in zip(a, b, c, strict=True)]
        areas.append(area)
        firsts.append([area * k / 3 for k in total])
        seconds.append(
            [
                [area / 12 * (sum(v[i] * v[j] for v in (a, b, c)) + total[i] * total[j]) for j in range(3)]
                for i in range(3)
            ]
        )
    mass = sum(areas)
    center = [sum(k) / mass for k in zip(*firsts, strict=True)]
    second = [[sum(s[i][j] for s in seconds) - mass * center[i] * center[j] for j in range(3)] for i in range(3)]
    trace = second[0][0] + second[1][1] + second[2][2]
    tensor = [[(trace if i == j else 0) - second[i][j] for j in range(3)] for i in range(3)]
    require_within(assembled(file), (mass, center, tensor), 1e-7 if offset else 1e-12)


SDF = (
    """<sdf version="1.9"><model name="m"><link name="l"><inertial auto="true">{0}</inertial>{1}</link></model></sdf>"""
)
COLLISION = '<collision name="c{0}">{1}<geometry>{2}</geometry></collision>'
MESH = "<mesh><uri>m.stl</uri><scale>{0}</scale></mesh>"


def test_a_mesh_of_sdformat_is_scaled_by_the_decimals_of_the_file(tmp_path: Path) -> None:
    scale = "0.1 0.3 0.7"
    own = stl(np.array(TETRAHEDRON) * 3, tmp_path / "m.stl")
    file = tmp_path / "m.sdf"
    file.write_text(SDF.format("", COLLISION.format(0, "", MESH.format(scale))))
    corners = [[k * mpf(s) for k, s in zip(v, scale.split(), strict=True)] for v in own]
    require_within(assembled(file), truth(corners, 1000 * volume(corners)), 1e-14)


def test_masses_that_are_shared_out_are_within_their_bounds(tmp_path: Path) -> None:
    """Of 0.7 kg a ball and a mesh in proportion to what they weigh: 4/3 π r³ against the tetrahedron."""
    own = stl(np.array(TETRAHEDRON) * 0.3, tmp_path / "m.stl")
    shapes = COLLISION.format(0, "", MESH.format("0.1 0.3 0.7")) + COLLISION.format(
        1, "", "<sphere><radius>0.01</radius></sphere>"
    )
    file = tmp_path / "m.sdf"
    file.write_text(SDF.format("<mass>0.7</mass>", shapes))
    table, _ = robot_tree(read_robot(file))
    mesh = volume([[k * mpf(s) for k, s in zip(v, ("0.1", "0.3", "0.7"), strict=True)] for v in own])
    ball = 4 * mp.pi * mpf(0.01) ** 3 / 3
    for part, size in zip(table["part"][1:], (mesh, ball), strict=True):
        true = mpf(0.7) * size / (mesh + ball)
        assert abs(part["mass"] - true) <= part["bound"]["mass"] * true
        assert part["bound"]["mass"] < 1e-14
    assert inertia.Assembly.from_dict(table).mass_properties().error.mass < 1e-14


@pytest.mark.parametrize("scale", ["0.1 0.3 0.7", "0.001 -0.001 0.001"])
def test_the_audit_scales_moments_and_not_coordinates(tmp_path: Path, scale: str) -> None:
    """A mesh far from its origin, whose coordinates times a factor would be rounded by more than its size allows."""
    own = stl(np.array(TETRAHEDRON) + 30000, tmp_path / "m.stl")
    corners = [[k * mpf(s) for k, s in zip(v, scale.split(), strict=True)] for v in own]
    mass, center, tensor = truth(corners, 1000 * volume(corners))
    file = tmp_path / "m.urdf"
    rows = " ".join(
        f'i{a}{b}="{float(tensor[i][j])!r}"' for (i, a), (j, b) in product(enumerate("xyz"), repeat=2) if i <= j
    )
    file.write_text(
        f'<robot name="r"><link name="l"><inertial><origin xyz="{" ".join(repr(float(k)) for k in center)}"/>'
        f'<mass value="{float(mass)!r}"/><inertia {rows}/></inertial><visual><geometry>'
        f'<mesh filename="m.stl" scale="{scale}"/></geometry></visual></link></robot>'
    )
    (link,) = inertia.audit(file, densities={"": 1000.0}).links
    assert (link.state, link.computed is not None) == ("consistent", True)
    assert link.computed is not None
    require_within(link.computed, (mass, center, tensor), 1e-13)


def test_the_audit_has_the_digits_of_a_mesh_far_from_its_link(tmp_path: Path) -> None:
    mesh = ops(translate="(1e7, 0, 0)", rotateXYZ="(10, 20, 30)", scale="(1e-3, 1e-3, 1e-3)")
    stated = "float physics:mass = 2\npoint3f physics:centerOfMass = (1e7, 0, 0)\n"
    file = tmp_path / "s.usda"
    file.write_text(STAGE.format(unit=1, top="", body=f"{stated}float3 physics:diagonalInertia = (1, 1, 1)", mesh=mesh))
    computed = inertia.audit(file).links[0].computed
    assert computed is not None
    corners = [[mpf(1e-3) * k for k in point] for point in TETRAHEDRON]
    for axis, angle in enumerate((10, 20, 30)):
        corners = [turned(axis, angle, corner) for corner in corners]
    corners = [[mpf(1e7) + x, y, z] for x, y, z in corners]
    require_within(computed, truth(corners, mpf(2)), 1e-15)


CONE = """#usda 1.0
(metersPerUnit = 1)
def Xform "b" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
{{
    {stated}
    def Cone "g" (prepend apiSchemas = ["PhysicsCollisionAPI"])
    {{
        double height = 2
        double radius = 1
        uniform token axis = "{axis}"
        double3 xformOp:scale = {signs}
        uniform token[] xformOpOrder = ["xformOp:scale"]
    }}
}}
"""


@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
@pytest.mark.parametrize("signs", list(product((1, -1), repeat=3)))
def test_the_centre_of_a_cone_is_mirrored_with_it(tmp_path: Path, axis: str, signs: tuple[int, ...]) -> None:
    """It stands from −h/2 to h/2 along its axis, its base below, and has its centre of mass at −h/4."""
    k = "XYZ".index(axis)
    center = [-0.5 * signs[k] if k == j else 0.0 for j in range(3)]
    mass = 1000 * np.pi * 2 / 3
    beside, along = mass * (3 / 20 + 3 / 80 * 4), mass * 3 / 10
    moments = [along if k == j else beside for j in range(3)]
    file = tmp_path / "s.usda"
    file.write_text(CONE.format(stated="", axis=axis, signs=signs))
    whole = assembled(file)
    assert whole.mass == pytest.approx(mass, rel=1e-15)
    assert whole.center_of_mass == pytest.approx(center, abs=1e-15)
    assert np.allclose(whole.inertia, np.diag(moments), rtol=1e-14, atol=1e-12)
    stated = f"float physics:mass = {mass}\npoint3f physics:centerOfMass = {tuple(center)}\n"
    stated += f"float3 physics:diagonalInertia = {tuple(map(float, moments))}"
    file.write_text(CONE.format(stated=stated, axis=axis, signs=signs))
    assert [link.state for link in inertia.audit(file).links] == ["consistent"]


@pytest.mark.parametrize(
    ("shape", "volume_of", "squares", "height"),
    [
        ("<cone><radius>1</radius><length>2</length></cone>", np.pi * 2 / 3, (0.15, 0.15, 0.15), -0.5),
        ("<cylinder><radius>1</radius><length>2</length></cylinder>", np.pi * 2, (0.25, 0.25, 1 / 3), 0.0),
        ("<sphere><radius>2</radius></sphere>", np.pi * 32 / 3, (0.8, 0.8, 0.8), 0.0),
        ("<ellipsoid><radii>1 2 3</radii></ellipsoid>", np.pi * 8, (0.2, 0.8, 1.8), 0.0),
        ("<box><size>1 2 3</size></box>", 6.0, (1 / 12, 4 / 12, 9 / 12), 0.0),
        (  # a barrel of 2π and a ball of 4π/3; half balls have ∫z² = 2π/15 about their faces and centres 3/8 beyond
            "<capsule><radius>1</radius><length>2</length></capsule>",
            np.pi * 10 / 3,
            ((2 * 0.25 + 4 / 3 * 0.2) * 0.3, (2 * 0.25 + 4 / 3 * 0.2) * 0.3, (2 / 3 + 4 / 3 * (0.2 + 1 + 0.75)) * 0.3),
            0.0,
        ),
    ],
)
def test_primitives_lie_where_their_format_has_them(
    tmp_path: Path,
    shape: str,
    volume_of: float,
    squares: tuple[float, ...],
    height: float,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """On its side at (1, 2, 3): z of the shape along x of the link; the tree that is written lies there too."""
    file = tmp_path / "m.sdf"
    file.write_text(SDF.format("", COLLISION.format(0, f"<pose>1 2 3 0 {np.pi / 2!r} 0</pose>", shape)))
    assert main(["assembly", str(file), "--to-toml", str(tmp_path / "tree.toml")]) == 0
    x, y, z = squares[2], squares[1], squares[0]
    mass = 1000 * volume_of
    for whole in (assembled(file), inertia.Assembly.load(tmp_path / "tree.toml").mass_properties()):
        assert whole.mass == pytest.approx(mass, rel=1e-14)
        assert whole.center_of_mass == pytest.approx([1 + height, 2, 3], rel=1e-14)
        assert np.allclose(whole.inertia, mass * np.diag([y + z, x + z, x + y]), rtol=1e-13, atol=1e-9)


def test_the_tree_that_is_written_keeps_the_bounds(tmp_path: Path) -> None:
    stl(np.array(TETRAHEDRON) + 1000, tmp_path / "m.stl")
    file = tmp_path / "m.xml"
    file.write_text(MJCF.format("shell", "1 1 1"))
    assert main(["assembly", str(file), "--to-toml", str(tmp_path / "tree.toml")]) == 0
    written, direct = inertia.Assembly.load(tmp_path / "tree.toml").mass_properties(), assembled(file)
    assert (written.mass, written.error) == (direct.mass, direct.error)
    assert direct.error.method != "given"
