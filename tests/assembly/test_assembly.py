"""Trees of parts against sums in rational arithmetic over their triangles, moved corner by corner."""

import math
from collections.abc import Sequence
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import inertia
from inertia.assembly.document import Assembly
from inertia.errors import GeometryError, InertiaError, ReadError, UsageError
from inertia_meshes import path

Matrix = list[list[Fraction]]
BOX, CONE, HANDLE = path("box.stl"), path("cone.stl"), path("t_handle.stl")


def assembly(*parts: dict[str, Any], folder: Path = Path(), **fields: Any) -> Assembly:
    return Assembly.from_dict({"part": list(parts), **fields}, folder)


def ball(name: str = "ball", **fields: Any) -> dict[str, Any]:
    return {"name": name, "shape": "point", "mass": 1.0, **fields}


def turn(quaternion: Sequence[int], at: Sequence[Fraction]) -> Matrix:
    """Return the placement (3, 4) of a quaternion of whole numbers, x y z w, by the sandwich product."""
    x, y, z, w = (Fraction(k) for k in quaternion)
    size = x * x + y * y + z * z + w * w
    v = (x, y, z)
    cross = [[Fraction(0), -z, y], [z, Fraction(0), -x], [-y, x, Fraction(0)]]
    return [
        [((w * w - x * x - y * y - z * z) * (i == j) + 2 * v[i] * v[j] + 2 * w * cross[i][j]) / size for j in range(3)]
        + [Fraction(at[i])]
        for i in range(3)
    ]


def then(outer: Matrix, inner: Matrix) -> Matrix:
    return [
        [sum((row[k] * inner[k][j] for k in range(3)), row[3] if j == 3 else Fraction(0)) for j in range(4)]
        for row in outer
    ]


def moved(corners: list[Any], placement: Matrix) -> list[Any]:
    return [
        [[sum((row[k] * point[k] for k in range(3)), row[3]) for row in placement] for point in triangle]
        for triangle in corners
    ]


def corners_of(file: Path) -> list[Any]:
    corners = inertia.read(file, unit="mm").triangles.corners().tolist()
    return [[[Fraction(k) / 1000 for k in point] for point in triangle] for triangle in corners]


def summed(parts: list[tuple[list[Any], Fraction]]) -> tuple[Fraction, list[Fraction], list[list[Fraction]]]:
    """Return mass, centre and tensor of solids and their densities, by signed tetrahedra."""
    mass, first = Fraction(0), [Fraction(0)] * 3
    second = [[Fraction(0)] * 3 for _ in range(3)]
    for corners, density in parts:
        for a, b, c in corners:
            volume = density * sum(
                a[i] * (b[j] * c[k] - b[k] * c[j]) for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
            ) / 6  # fmt: skip
            mass += volume
            s = [a[i] + b[i] + c[i] for i in range(3)]
            for i in range(3):
                first[i] += volume * s[i] / 4
                for j in range(3):
                    second[i][j] += volume * (s[i] * s[j] + a[i] * a[j] + b[i] * b[j] + c[i] * c[j]) / 20
    center = [f / mass for f in first]
    central = [[second[i][j] - mass * center[i] * center[j] for j in range(3)] for i in range(3)]
    trace = sum((central[i][i] for i in range(3)), Fraction(0))
    return mass, center, [[trace * (i == j) - central[i][j] for j in range(3)] for i in range(3)]


def assert_within_bounds(
    properties: inertia.MassProperties, parts: list[tuple[list[Any], Fraction]], most: float = 1e-14
) -> None:
    mass, center, tensor = summed(parts)
    error = properties.error
    assert abs(Fraction(properties.mass) - mass) <= Fraction(error.mass) * mass
    off = [float(Fraction(k) - c) for k, c in zip(properties.center_of_mass.tolist(), center, strict=True)]
    assert math.hypot(*off) <= error.center_of_mass
    rows = properties.inertia.tolist()
    apart = math.hypot(*(float(Fraction(rows[i][j]) - tensor[i][j]) for i in range(3) for j in range(3)))
    norm = math.hypot(*(float(k) for row in tensor for k in row))
    assert apart <= error.inertia * norm
    assert error.inertia < 1e-13
    assert error.center_of_mass < most


def test_nested_placements_are_those_of_the_corners_moved_exactly() -> None:
    first, second = (1, 2, 3, 4), (-2, 1, 0, 5)
    whole = assembly(
        {"name": "group", "quaternion": list(first), "at": ["1/3", 20, -7]},
        {"name": "box", "parent": "group", "file": str(BOX), "density": 2700.0, "quaternion": list(second)},
        {"name": "cone", "parent": "box", "file": str(CONE), "density": 7850.0, "at": [0.1, 0, "2/7"]},
        {"name": "far", "file": str(CONE), "density": 1000.0, "at": [1e6, 0, 0]},
    )
    outer = turn(first, [Fraction(1, 3000), Fraction(20, 1000), Fraction(-7, 1000)])
    inner = then(outer, turn(second, [Fraction(0)] * 3))
    deep = then(inner, turn((0, 0, 0, 1), [Fraction(0.1) / 1000, Fraction(0), Fraction(2, 7000)]))
    away = turn((0, 0, 0, 1), [Fraction(1000), Fraction(0), Fraction(0)])
    box, cone = corners_of(BOX), corners_of(CONE)
    near = [(moved(box, inner), Fraction(2700)), (moved(cone, deep), Fraction(7850))]
    assert_within_bounds(whole.mass_properties(), [*near, (moved(cone, away), Fraction(1000))], 1e-11)
    without = Assembly.from_dict({"part": whole.to_dict()["part"][:3]}).mass_properties()
    assert_within_bounds(without, near)


@pytest.mark.parametrize("seed", range(6))
def test_random_trees_are_within_their_bounds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    parts: list[dict[str, Any]] = []
    places: list[Matrix] = []
    oracle = []
    box, cone = corners_of(BOX), corners_of(CONE)
    for k in range(8):
        quaternion = rng.integers(-9, 10, 4).tolist()
        quaternion[3] = quaternion[3] or 1
        at = rng.uniform(-100, 100, 3).tolist()
        own = turn(quaternion, [Fraction(x) / 1000 for x in at])
        parent = int(rng.integers(0, k)) if k and rng.random() < 0.7 else None
        places.append(own if parent is None else then(places[parent], own))
        density = float(rng.uniform(500, 9000))
        file, corners = (BOX, box) if rng.random() < 0.5 else (CONE, cone)
        part = {"name": f"p{k}", "file": str(file), "density": density, "quaternion": quaternion, "at": at}
        parts.append(part if parent is None else part | {"parent": f"p{parent}"})
        oracle.append((moved(corners, places[-1]), Fraction(density)))
    assert_within_bounds(assembly(*parts).mass_properties(), oracle)


def test_a_mirrored_part_is_that_of_the_corners_mirrored() -> None:
    cone = [[[-p[0], p[1], p[2]] for p in (a, c, b)] for a, b, c in corners_of(CONE)]
    whole = assembly({"name": "h", "file": str(CONE), "density": 1000.0, "mirror": "x", "at": [0, 5, 0]})
    place = turn((0, 0, 0, 1), [Fraction(0), Fraction(5, 1000), Fraction(0)])
    assert_within_bounds(whole.mass_properties(), [(moved(cone, place), Fraction(1000))])
    same = assembly({"name": "h", "file": str(CONE), "density": 1000.0, "mirror": [-3, 0, 0], "at": [0, 5, 0]})
    assert same.mass_properties().inertia.tolist() == whole.mass_properties().inertia.tolist()


def test_four_around_an_axis_are_four_quarter_turns() -> None:
    whole = assembly(
        {"name": "h", "file": str(CONE), "density": 1000.0, "at": [40, 0, 3]}
        | {"around": {"count": 4, "axis": [0, 0, 2], "through": [10, 0, 0]}}
    )
    cone, at = corners_of(CONE), turn((0, 0, 0, 1), [Fraction(40, 1000), Fraction(0), Fraction(3, 1000)])
    point, parts = [Fraction(10, 1000), Fraction(0), Fraction(0)], []
    for quarter in ((0, 0, 0, 1), (0, 0, 1, 1), (0, 0, 1, 0), (0, 0, -1, 1)):
        about = then(turn(quarter, point), turn((0, 0, 0, 1), [-k for k in point]))
        parts.append((moved(cone, then(about, at)), Fraction(1000)))
    assert_within_bounds(whole.mass_properties(), parts)


def test_a_ring_of_masses_is_a_ring() -> None:
    whole = assembly(ball(at=[3, 0, 1], around={"count": 7, "axis": "z"}), unit="m").mass_properties()
    assert whole.center_of_mass == pytest.approx([0, 0, 1], abs=1e-50)
    assert whole.inertia == pytest.approx(7 * 9 * np.diag([0.5, 0.5, 1.0]), rel=1e-15, abs=1e-30)
    half = assembly(ball(at=[3, 0, 0], around={"count": 3, "axis": "z", "angle": 180}), unit="m").mass_properties()
    assert half.center_of_mass == pytest.approx([0, 1, 0], abs=1e-15)


def test_rows_of_masses_are_a_grid() -> None:
    whole = assembly(ball(at=[1, 0, 0], rows={"count": [2, 3, 1], "step": ["1/2", -1, 5]}), unit="m")
    points = [[1 + 0.5 * i, -j, 0] for i, j in product(range(2), range(3))]
    expected = inertia.point_masses(points, [1.0] * 6)
    assert whole.mass_properties().inertia.tolist() == expected.inertia.tolist()


@pytest.mark.parametrize(("sequence", "angles"), [("ZXZ", (10, 20, 30)), ("xyz", (-33, 170, 400.5)), ("Y", (77,))])
def test_euler_angles_are_those_of_scipy(sequence: str, angles: tuple[float, ...]) -> None:
    whole = assembly({"name": "h", "file": str(HANDLE), "density": 1.0, "euler": angles, "sequence": sequence})
    alone = inertia.mass_properties(inertia.read(HANDLE, unit="mm"), 1.0)
    rotation = Rotation.from_euler(sequence, angles if len(angles) > 1 else angles[0], degrees=True).as_matrix()
    assert whole.mass_properties().inertia == pytest.approx(rotation @ alone.inertia @ rotation.T, rel=1e-13)


@pytest.mark.parametrize(
    ("shape", "size", "volume", "moments"),
    [
        ("box", [1, 2, 3], 6.0, (13 / 12, 10 / 12, 5 / 12)),
        ("sphere", [2], 32 * math.pi / 3, (1.6, 1.6, 1.6)),
        ("cylinder", [2, 3], 12 * math.pi, (1.75, 1.75, 2.0)),
        ("tube", [2, 1, 3], 9 * math.pi, (2.0, 2.0, 2.5)),
        ("ellipsoid", [1, 2, 3], 8 * math.pi, (2.6, 2.0, 1.0)),
        ("capsule", [1, 3], 13 / 3 * math.pi, (241 / 130, 241 / 130, 61 / 130)),
        ("cone", [2, 3], 4 * math.pi, (0.15 * 4 + 0.0375 * 9, 0.15 * 4 + 0.0375 * 9, 1.2)),
    ],
)
def test_shapes_have_their_closed_forms(
    shape: str, size: list[float], volume: float, moments: tuple[float, ...]
) -> None:
    whole = assembly({"name": "s", "shape": shape, "size": size, "density": 2.0}, unit="m").mass_properties()
    assert whole.volume == pytest.approx(volume, rel=1e-15)
    assert whole.center_of_mass.tolist() == [0, 0, 0]
    assert whole.inertia == pytest.approx(2 * volume * np.diag(moments), rel=1e-14)


def test_what_was_measured_overrides_what_was_computed() -> None:
    tensor = [[2e-6, 1e-7, 0], [1e-7, 3e-6, 0], [0, 0, 4e-6]]
    whole = assembly(
        {"name": "h", "file": str(HANDLE), "density": 1000.0, "mass": 0.25, "center_of_mass": [1, 2, "1/4"]}
        | {"inertia": tensor}
    ).mass_properties()
    assert whole.mass == 0.25
    assert whole.center_of_mass.tolist() == [0.001, 0.002, 0.00025]
    assert whole.inertia.tolist() == tensor


def test_what_was_computed_elsewhere_is_as_sure_as_it_says() -> None:
    """Two bodies a metre apart at the ends of their bounds, by the theorem of Steiner in rational numbers."""
    tensor = np.diag([2.0, 3.0, 4.0])
    bound = {"mass": 1e-6, "center_of_mass": 1e-7, "inertia": 1e-8, "method": "weighed by sums"}
    part = {"shape": None, "mass": 2.0, "center_of_mass": [0.5, 0, 0], "inertia": tensor, "bound": bound}
    one, two = (ball(**part) | {"name": name, "at": at} for name, at in (("a", [0, 0, 0]), ("b", [0, 3, 0])))
    whole = assembly(one, two, unit="m").mass_properties()
    assert whole.error.method == "weighed by sums"
    m, off = 2 * (1 + Fraction(1e-6)), Fraction(1e-7)
    for sign in (1, -1):  # apart, and nearer to each other
        arm = Fraction(3, 2) + sign * off
        true = 2 * (4 * (1 + Fraction(1e-8)) + m * arm**2)
        size = Fraction(whole.error.inertia) * Fraction(float(np.linalg.norm(whole.inertia)))
        assert abs(Fraction(whole.inertia[2, 2].item()) - true) <= size
    assert abs(Fraction(whole.mass) - 2 * m) <= Fraction(whole.error.mass) * Fraction(whole.mass)
    assert whole.error.mass == pytest.approx(1e-6)
    assert 1e-7 <= whole.error.center_of_mass < 1e-5
    assert whole.error.inertia < 1e-5


def test_a_mass_that_is_off_takes_its_tensor_along() -> None:
    """A box of a mass that another program worked out: ∫x² = m x²/12."""
    box = {"name": "b", "shape": "box", "size": [1, 1, 1], "mass": 12.0, "bound": {"mass": 1e-3}}
    error = assembly(box, unit="m").mass_properties().error
    assert 1e-3 <= error.mass < 1.001e-3
    assert 1e-3 <= error.inertia < 4e-3


def test_materials_come_by_globs_and_from_the_file_around(tmp_path: Path) -> None:
    (tmp_path / "inner.toml").write_text(
        '[materials]\n"pin*" = "brass"\n[[part]]\nname = "pin1"\nshape = "box"\nsize = [10, 10, 10]\n'
        '[[part]]\nname = "bolt_m3"\nshape = "box"\nsize = [10, 10, 10]\n'
    )
    (tmp_path / "outer.toml").write_text(
        '[materials]\n"*bolt*" = "steel"\n"*" = "wood of ours"\n[densities]\nsteel = 8000\n"wood of ours" = "600±1"\n'
        '[[part]]\nname = "inner"\nassembly = "inner.toml"\n'
        '[[part]]\nname = "shim"\nshape = "box"\nsize = [10, 10, 10]\n'
    )
    whole = Assembly.load(tmp_path / "outer.toml")
    masses = {line.name: line.basic_mass for line in whole.budget().total.lines()}
    assert masses["pin1"] == pytest.approx(8.5e-3)
    assert masses["bolt_m3"] == pytest.approx(8e-3)
    assert masses["shim"] == pytest.approx(0.6e-3)
    assert whole.mass_properties().mass == pytest.approx(17.1e-3)


def test_an_assembly_in_itself_is_refused(tmp_path: Path) -> None:
    for name, other in (("a", "b"), ("b", "a")):
        (tmp_path / f"{name}.toml").write_text(f'[[part]]\nname = "x"\nassembly = "{other}.toml"\n')
    with pytest.raises(ReadError, match=r"b\.toml: part\[0\]: a\.toml holds itself"):
        Assembly.load(tmp_path / "a.toml").mass_properties()


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1.01]]}, r"part\[0\]\.matrix is no rotation: it is off .* by 0\.02"),
        ({"matrix": [[0.7, -0.7, 0], [0.7, 0.7, 0], [0, 0, 1]]}, "its digits explain 0.003"),
        ({"matrix": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}, "is left-handed: mirror the part"),
        ({"quaternion": [0, 0, 0.7, 0.7]}, "squared length that is off 1 by 0.02"),
        ({"quaternion": [1.5, 2.5, 3.5, 1.25]}, "off 1 by 21, and its digits explain 0.003: divide it by its length"),
        ({"quaternion": [0, 0, 0.7079, 0.707]}, "give more digits"),
        ({"matrix": [[2.5, 0, 0], [0, 2.5, 0], [0, 0, 2.5]]}, "explain 0.003: give the rotation alone without"),
        ({"matrix": [[1, 0.0011, 0], [0, 1, 0], [0, 0, 1]]}, "give more digits, or the rotation alone"),
        ({"quaternion": [0, 0, 0, 0]}, "quaternion is zero"),
        ({"euler": [1, 2, 3]}, "sequence is missing"),
        ({"euler": [1, 2], "sequence": "ZXZ"}, "has 2 angles for the axes 'ZXZ'"),
        ({"euler": [1], "sequence": "Zx"}, "name one to three axes"),
        ({"quaternion": [0, 0, 0, 1], "euler": [1], "sequence": "z"}, "say once how the part is turned"),
        ({"parent": "ghost"}, "there is no part of that name"),
        ({"parent": "ball"}, "hangs on this part itself"),
        ({"size": [1]}, "has 1 lengths: a point has no"),
        ({"at": ["1/0", 0, 0]}, "nothing is divided by zero"),
        ({"at": ["9" * 5000, 0, 0]}, r"part\[0\]\.at\[0\] has 5000 characters: 1000 are the most"),
        ({"at": [0, "9" * 400, 0]}, r"part\[0\]\.at\[1\] is '9+\.\.\.: no length is of that size"),
        ({"shape": None, "mass": None, "bound": {"mass": 0.1}}, r"part\[0\]\.bound is given without mass"),
        ({"bound": {"mass": 1.0}}, r"part\[0\]\.bound\.mass"),
        ({"mass": "0±1"}, r"part\[0\]\.mass is 0\.0: it must be positive"),
        ({"mirror": [0, 0, 0]}, r"mirror is zero"),
        ({"mirror": "x", "center_of_mass": [1, 0, 0]}, r"mirror is given beside center_of_mass as measured"),
        ({"mirror": "x", "shape": None, "inertia": np.eye(3)}, r"mirror is given beside inertia as measured"),
        ({"mirror": "x", "shape": None, "mass": None}, r"mirror is given for a group: mirror its parts"),
        (
            {"mirror": "x", "shape": None, "mass": None, "assembly": "arm.toml"},
            r"mirror is given for another assembly: mirror its parts",
        ),
        ({"rows": {"count": [2000, 2000, 1], "step": [1, 1, 1]}}, "asks for 4000000 copies"),
        ({"quantitty": 2}, "did you mean quantity"),
        ({"position": [1, 2, 3]}, r"part\[0\]\.position is unknown: did you mean at\?"),
        ({"rotation": 3}, r"part\[0\]\.rotation is unknown: did you mean quaternion, matrix or euler\?"),
        ({"angle": 3}, r"part\[0\]\.angle is unknown: use name, parent, file,"),
        ({"scale": "1±0.1"}, "is that of a file, and the part has none"),
        ({"inertia": [[1, 0, 0], [0, 1, 0], [0, 0, 3]]}, "break the triangle rule"),
        ({"mass": None, "density": 1.0}, "a point has a mass and no density"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(fields: dict[str, Any], says: str) -> None:
    with pytest.raises(InertiaError, match=says):
        assembly(ball(**fields)).mass_properties()


def test_parts_on_parts_end_somewhere() -> None:
    links = [ball(f"p{k}", at=[1, 0, 0], **({"parent": f"p{k - 1}"} if k else {})) for k in range(1200)]
    assert assembly(*links[:100]).budget().total.quantity == 1
    with pytest.raises(UsageError, match=r"part\[100\]: p100 is 101 levels deep: 100 are the most"):
        assembly(*links).mass_properties()


def test_copies_of_copies_are_refused_before_they_are_made() -> None:
    rows = {"count": [1000, 1000, 1], "step": [1, 1, 1]}
    with pytest.raises(UsageError, match=r"part\[1\]: ball: 1000000000000 copies are more than 1000000"):
        assembly({"name": "g", "rows": rows}, ball(parent="g", rows=rows)).mass_properties()


def test_names_differ() -> None:
    with pytest.raises(UsageError, match=r"part\[1\]\.name is 'ball', as that of another part"):
        assembly(ball(), ball())


def test_a_broken_file_is_named_with_its_place(tmp_path: Path) -> None:
    broken = path("broken/missing_face.stl")
    with pytest.raises(GeometryError, match=r"part\[1\]: .*missing_face\.stl.*open") as caught:
        assembly(ball(), {"name": "b", "file": str(broken), "density": 1.0}).mass_properties()
    assert str(caught.value).count("missing_face.stl") == 1


def test_what_is_advised_for_a_surface_is_a_field_that_answers() -> None:
    part = {"name": "sheet", "file": str(path("broken/missing_face.stl"))}
    with pytest.raises(
        GeometryError, match=r"close the mesh, or use shell = THICKNESS in the \[\[part\]\] of"
    ) as refused:
        assembly(part).mass_properties()
    assert "shell" not in {remedy.argument for remedy in refused.value.remedies}
    walled = assembly({**part, "shell": 0.5}).mass_properties()
    assert walled.mass > 0


def test_a_file_is_integrated_once(monkeypatch: pytest.MonkeyPatch) -> None:
    count = 0
    analyse = inertia.analyse

    def counted(*arguments: Any, **options: Any) -> Any:
        nonlocal count
        count += 1
        return analyse(*arguments, **options)

    monkeypatch.setattr("inertia.assembly.bodies.analyse", counted)
    parts = [
        {"name": f"h{k}", "file": str(HANDLE), "density": 100.0 + k, "at": [k, 0, 0], "mirror": "xyz"[k % 3]}
        for k in range(9)
    ]
    assembly(*parts).mass_properties()
    assert count == 1


def test_a_rotation_that_float64_made_is_one() -> None:
    for seed in range(60):
        left, _, right = np.linalg.svd(np.random.default_rng(seed).standard_normal((3, 3)))
        rotation = left @ right
        rotation *= np.sign(np.linalg.det(rotation))
        whole = assembly(ball("a", at=[1, 0, 0], parent="g"), ball("b"), {"name": "g", "matrix": rotation.tolist()})
        assert whole.mass_properties().error.inertia < 1e-13


@pytest.mark.parametrize("digits", [3, 4, 6, 9, 12, 15])
def test_a_rotation_rounded_to_its_digits_is_one(digits: int) -> None:
    for seed in range(20):
        rotation = np.round(Rotation.from_quat(np.random.default_rng(seed).standard_normal(4)).as_matrix(), digits)
        assert assembly(ball(matrix=rotation.tolist())).mass_properties().mass == 1.0


def test_a_rotation_of_few_digits_is_within_its_bound_of_the_one_that_was_meant() -> None:
    true = Rotation.from_rotvec([0.3, -0.2, 0.5]).as_matrix()
    part = {"name": "h", "file": str(HANDLE), "density": 1000.0, "at": [50, 0, 0]}
    typed = assembly(part | {"matrix": np.round(true, 5).tolist()}).mass_properties()
    u, _, vt = np.linalg.svd(np.round(true, 5))
    nearest = assembly(part | {"matrix": (u @ vt).tolist()}).mass_properties()
    apart = np.linalg.norm(typed.inertia - nearest.inertia) / np.linalg.norm(nearest.inertia)
    assert 1e-7 < apart < typed.error.inertia < 1e-3
