"""Budgets: uncertainties against differences of the exact sums and against draws, allowances, limits."""

import math
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.benchmarks.budget_draws import ratios_of

import inertia
from inertia.assembly.budget import Budget
from inertia.assembly.document import Assembly
from inertia.assembly.limits import Limit
from inertia.errors import ReadError, UsageError
from inertia.report.budget.html import budget_html
from inertia.report.budget.text import budget_text
from inertia_meshes import assemblies, path

HANDLE = str(path("t_handle.stl"))
ELEMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def budget_of(*parts: dict[str, Any], **fields: Any) -> Budget:
    return Assembly.from_dict({"part": list(parts), **fields}).budget()


def figures(*parts: dict[str, Any], **fields: Any) -> np.ndarray:
    """Return mass, centre of mass and tensor of the whole, as ten numbers."""
    properties = Assembly.from_dict({"part": list(parts), **fields}).mass_properties()
    elements = [properties.inertia[k] for k in ELEMENTS]
    return np.array([properties.mass, *properties.center_of_mass, *elements])


REST = {"name": "rest", "shape": "box", "size": [50, 40, 30], "mass": 0.3, "at": [3, -2, 7]}
TURNED = {"euler": [10, 20, 30], "sequence": "ZXZ", "at": [20, 30, -10]}
GROUP = {"name": "group", "at": [1, 2, 3], "euler": [25, 50], "sequence": "xz"}


@pytest.mark.parametrize(
    ("field", "value", "u", "others"),
    [
        ("density", 7850.0, 40.0, {}),
        ("mass", 0.2, 0.01, {}),
        ("mass", 0.2, 0.01, {"inertia": [[2e-5, 1e-6, 0], [1e-6, 3e-5, 0], [0, 0, 4e-5]]}),
        ("mass", 0.2, 0.01, {"center_of_mass": [1, 2, 3]}),
        ("density", 7850.0, 40.0, {"mirror": "y", "around": {"count": 3, "axis": [1, 2, 0]}}),
        ("density", 7850.0, 40.0, {"quantity": 4, "parent": "group"}),
    ],
)
def test_a_common_input_changes_the_whole_as_differences_do(
    field: str, value: float, u: float, others: dict[str, Any]
) -> None:
    part = {"name": "h", "file": HANDLE, **TURNED, **others}
    around = (REST, GROUP)
    sigma = budget_of(part | {field: inertia.Estimate(value, u)}, *around).total.sigma
    assert sigma.labels == (f"{field} of h",)
    step = 1e-4 * u
    low, high = (figures(part | {field: value + k * step}, *around) for k in (-1, 1))
    expected = (high - low) / 2e-4
    assert sigma.changes[0, :10] == pytest.approx(expected, rel=1e-6, abs=1e-9 * np.abs(expected[4:]).max())


@pytest.mark.parametrize("scale", [2, 0.001, "1.1±0.001", "0.999±0.002"])
def test_a_scale_that_is_not_one_is_refused(scale: float | str) -> None:
    part = {"name": "h", "file": HANDLE, "density": 7850.0}
    with pytest.raises(
        UsageError, match=r"part\[0\].scale is .*: coordinates are taken as stored, .* unit or stretch$"
    ):
        Assembly.from_dict({"part": [part | {"scale": scale}]})
    one = Assembly.from_dict({"part": [part | {"scale": 1}]}).mass_properties()
    assert one.mass == Assembly.from_dict({"part": [part]}).mass_properties().mass


def test_a_scale_changes_the_whole_as_a_larger_file_does() -> None:
    part = {"name": "h", "file": HANDLE, "density": 7850.0, "at": [20, 30, -10], "euler": [30], "sequence": "y"}
    sigma = budget_of(part | {"scale": "1±0.01"}, REST).total.sigma
    h = inertia.read(HANDLE, unit="mm")
    base = inertia.mass_properties(h, 7850.0)
    rotation = Rotation.from_euler("y", 30, degrees=True).as_matrix()
    rest = Assembly.from_dict({"part": [REST]}).mass_properties()

    def scaled(s: float) -> np.ndarray:
        one = inertia.MassProperties(base.mass * s**3, 0.0, base.center_of_mass * s, base.inertia * s**5)
        whole = one.expressed_in(rotation.T, -rotation.T @ np.array([0.02, 0.03, -0.01])) + rest
        return np.array([whole.mass, *whole.center_of_mass, *(whole.inertia[k] for k in ELEMENTS)])

    expected = 0.01 * (scaled(1 + 1e-5) - scaled(1 - 1e-5)) / 2e-5
    assert sigma.changes[0, :10] == pytest.approx(expected, rel=1e-6, abs=1e-9 * np.abs(expected[4:]).max())


def test_a_displaced_centre_and_tensor_change_the_whole_as_differences_do() -> None:
    tensor = np.array([[2e-5, 1e-6, 0], [1e-6, 3e-5, 0], [0, 0, 4e-5]])
    part = {"name": "r", "mass": 0.2, "center_of_mass": [1.0, 2.0, 3.0], "inertia": tensor.tolist(), **TURNED}
    uncertain = part | {"center_of_mass_uncertainty": 0.5, "inertia_uncertainty": 1e-6}
    sigma = budget_of(uncertain, REST).total.sigma
    variance = np.zeros(10)
    for k in range(3):
        ends = []
        for sign in (-1, 1):
            center = [1.0, 2.0, 3.0]
            center[k] += sign * 0.5e-3
            ends.append(figures(part | {"center_of_mass": center}, REST))
        variance += ((ends[1] - ends[0]) / 2e-3) ** 2
    for i, j in ELEMENTS:
        step = np.zeros((3, 3))
        step[i, j] = step[j, i] = 1e-8
        low, high = (figures(part | {"inertia": (tensor + sign * step).tolist()}, REST) for sign in (-1, 1))
        variance += ((high - low) / 2e-2) ** 2
    assert sigma.all[:10] == pytest.approx(np.sqrt(variance), rel=1e-5)


@pytest.mark.parametrize(
    "others",
    [
        {"density": 2000.0},
        {"mass": 0.3},
        {"density": 2000.0, "mirror": [1, 2, 0]},
        {"mass": 0.3, "inertia": [[2e-5, 1e-6, 0], [1e-6, 3e-5, 0], [0, 0, 4e-5]]},
    ],
)
def test_a_surface_that_lies_outwards_changes_the_whole_as_a_larger_tetrahedron_does(
    others: dict[str, Any], tmp_path: Path
) -> None:
    """All faces of a tetrahedron by t outwards: the same from the centre of its inscribed sphere, times 1 + t/r."""
    corners = np.array([[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [5.0, 20.0, 0.0], [2.0, 3.0, 40.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    sides = [np.linalg.norm(np.cross(corners[b] - corners[a], corners[c] - corners[a])) / 2 for a, b, c in faces]
    opposite = corners[[3, 2, 0, 1]]
    middle = np.array(sides) @ opposite / sum(sides)
    radius = abs(np.linalg.det(corners[1:] - corners[0])) / 2 / sum(sides)

    def file(by: float) -> str:
        name = tmp_path / f"{by}.obj"
        lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in ((corners - middle) * (1 + by / radius) + middle).tolist()]
        name.write_text("\n".join([*lines, *(f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()), ""]))
        return str(name)

    part = {"name": "b", "unit": "mm", "parent": "group"} | others
    sigma = budget_of(part | {"file": file(0), "surface_uncertainty": 0.05}, REST, GROUP).total.sigma
    low, high = (figures(part | {"file": file(by)}, REST, GROUP) for by in (-1e-3, 1e-3))
    expected = 0.05 * (high - low) / 2e-3
    assert sigma.labels == ("surface of b",)
    assert np.abs(expected[1:4]).max() > 0
    assert sigma.changes[0, :10] == pytest.approx(expected, rel=1e-6, abs=1e-8 * np.abs(expected[4:]).max())


def test_what_a_nested_file_limits_and_allows_is_said_not_to_count(tmp_path: Path) -> None:
    ball = '[[part]]\nname = "p"\nshape = "point"\nmass = 1\n'
    (tmp_path / "a.toml").write_text(ball + '[[limit]]\nwhat = "mass"\nmax = 0.5\n')
    (tmp_path / "b.toml").write_text(ball + '[allowances.x]\nactual = 0.1\n[[limit]]\nwhat = "mass"\nmax = 0.5\n')
    (tmp_path / "c.toml").write_text(ball)
    whole = Assembly.from_dict({"part": [{"name": k, "assembly": f"{k}.toml"} for k in "abc"]}, tmp_path)
    assert whole.budget().notes == (
        "a.toml: its limit counts where it is asked about by itself, not here",
        "b.toml: its allowances and limit count where it is asked about by itself, not here",
    )
    assert whole.budget().verdict is None


def test_a_part_that_is_called_as_a_material_varies_by_itself() -> None:
    box = {"shape": "box", "size": [100, 100, 100]}
    parts = [box | {"name": "steel", "density": "7850±40"}, box | {"name": "b", "material": "steel", "at": [200, 0, 0]}]
    sigma = budget_of(*parts, densities={"steel": "7850±30"}).total.sigma
    assert sigma.labels == ("density of steel (part)", "density of steel (material)")
    assert sigma.mass == pytest.approx(0.05)


def test_a_part_that_is_called_as_one_of_another_file_or_as_a_scale_varies_by_itself(tmp_path: Path) -> None:
    (tmp_path / "n.toml").write_text('[[part]]\nname = "p"\nshape = "point"\nmass = "1±0.1"\n')
    point = {"name": "p (n.toml)", "shape": "point", "mass": "1±0.1"}
    nested = Assembly.from_dict({"part": [{"name": "a", "assembly": "n.toml"}, point]}, tmp_path).budget().total.sigma
    assert nested.mass == pytest.approx(math.hypot(0.1, 0.1))
    handle = {"file": HANDLE, "density": 1000.0, "scale": "1±0.01"}
    one = budget_of(handle | {"name": "A"}).total.sigma
    both = budget_of(handle | {"name": "A"}, handle | {"name": "B", "scale_of": "A"}).total.sigma
    assert both.labels == ("scale of A (part)", "scale of A (scale_of)")
    assert both.mass == pytest.approx(math.hypot(one.mass, one.mass))


@pytest.mark.parametrize(
    ("text", "line"), [("name;mass;shape\nbox;1,5;point\n", 2), ('name,shape,mass\n\na,point,"1,5±0,1"\n', 3)]
)
def test_a_decimal_comma_in_a_bill_is_refused_with_what_to_write(text: str, line: int) -> None:
    with pytest.raises(ReadError) as caught:
        Assembly.loads(text, name="bill.csv")
    says = str(caught.value)
    assert says.startswith(f"cannot read bill.csv: line {line} has '1,5")
    assert "as its mass, with a comma: write 1.5" in says


@pytest.mark.parametrize(
    ("delimiter", "cell", "says"),
    [
        (",", "1,500", "write 1500 if it parts thousands, else 1.500"),
        ("\t", "12,500±0,010", "write 12.500±0.010, with a decimal point"),
        (",", "12,500±1,000", "write 12500±1000 if it parts thousands, else 12.500±1.000"),
        (";", "1,500", "write 1.500, with a decimal point"),
        (",", "0,500", "write 0.500, with a decimal point"),
        (",", "1500,250", "write 1500.250, with a decimal point"),
        (";", "1,234,567", "write 1234567"),
        (",", "1,234.5", "write 1234.5"),
    ],
)
def test_a_comma_that_may_part_thousands_is_refused_with_both(delimiter: str, cell: str, says: str) -> None:
    text = f'name{delimiter}shape{delimiter}mass\na{delimiter}point{delimiter}"{cell}"\n'
    with pytest.raises(
        ReadError, match=f"line 2 has '{re.escape(cell)}' as its mass, with a comma: {re.escape(says)}$"
    ):
        Assembly.loads(text, name="bill.csv")


def test_a_bill_s_brackets_within_brackets_are_no_list() -> None:
    with pytest.raises(UsageError, match=r"part\[0\]\.center_of_mass is '\[\[.*must be three numbers"):
        Assembly.loads(f"name,mass,center_of_mass\na,1,{'[' * 3000}\n", name="bill.csv")


@pytest.mark.parametrize("comment", ["# export", "#\texport", "#,parts, 2026", '"#",parts', "# name"])
@pytest.mark.parametrize("delimiter", ",;\t")
def test_comments_stand_before_the_columns_of_a_bill(comment: str, delimiter: str) -> None:
    text = f"{comment}\n\nname;shape;mass\n#1;point;2\n".replace(";", delimiter)
    for name in ("bill.csv", "-"):
        (part,) = Assembly.loads(text, name=name).fields.part
        assert (part.name, part.mass) == ("#1", 2)


def test_a_column_of_numbers_in_a_bill_is_no_comment() -> None:
    for name in ("bill.csv", "-"):
        with pytest.raises(UsageError, match=r"part\[0\]\.# is unknown: use name"):
            Assembly.loads("#,name,mass\n1,bolt,2\n", name=name)


def test_a_bill_may_list_lists() -> None:
    text = "name;shape;size;at;material\nbox, large;box;[10,20,30];[1, 2, 0];steel\n"
    assert Assembly.loads(text, name="bill.csv").fields.part[0].name == "box, large"


@pytest.mark.parametrize("name", assemblies())
def test_uncertainties_of_the_samples_are_those_of_draws(name: str) -> None:
    ratios = ratios_of(Assembly.load(path(name)), 4000)
    assert len(ratios) >= 5
    # 4,000 draws tell a standard deviation to 1.1 %; products of two uncertain places are of the second order.
    assert all(0.9 < ratio < 1.05 for ratio in ratios.values()), ratios


def test_noise_of_vertices_is_that_of_the_analysis() -> None:
    for weight in ({"density": 7850.0}, {"mass": 0.05}):
        sigma = budget_of({"name": "h", "file": HANDLE, "sigma": 0.05, **weight}).total.sigma
        analysis = inertia.analyse(inertia.read(HANDLE, unit="mm"), sigma=0.05, **weight)
        assert analysis.uncertainty is not None
        assert sigma.mass == pytest.approx(analysis.uncertainty.mass, rel=1e-9, abs=1e-20)
        assert sigma.center_of_mass == pytest.approx(analysis.uncertainty.center_of_mass, rel=1e-7)
        assert sigma.inertia == pytest.approx(analysis.uncertainty.inertia, rel=1e-7)


def draws_of_places(count: int, seed: int, position: float, angle: float) -> np.ndarray:
    """Draw the places of three boxes on a group, with numpy alone."""
    rng = np.random.default_rng(seed)
    tensor = 0.2 / 12 * np.diag([0.03**2 + 0.01**2, 0.04**2 + 0.01**2, 0.04**2 + 0.03**2])
    mass, first, second = 0.6, np.zeros((count, 3)), np.zeros((count, 3, 3))
    out = Rotation.from_rotvec(angle * rng.normal(size=(count, 3))) * Rotation.from_euler("xz", [25, 50], degrees=True)
    base = np.array([0.001, 0.002, 0.003]) + position * rng.normal(size=(count, 3))
    for k in range(3):
        turn = Rotation.from_rotvec([0, 0, 2 * np.pi * k / 3])
        at = turn.apply([0.05, 0, 0.01]) + position * rng.normal(size=(count, 3))
        own = out * Rotation.from_rotvec(angle * rng.normal(size=(count, 3))) * turn
        center = base + out.apply(at) + own.apply([0.004, 0.005, 0.006])
        rows = own.as_matrix()
        first += 0.2 * center
        second += rows @ (np.trace(tensor) / 2 * np.eye(3) - tensor) @ rows.transpose(0, 2, 1)
        second += 0.2 * center[:, :, None] * center[:, None]
    c = first / mass
    central = second - mass * c[:, :, None] * c[:, None]
    i = np.trace(central, axis1=1, axis2=2)[:, None, None] * np.eye(3) - central
    return np.column_stack([np.full(count, mass), c, *(i[:, j, k] for j, k in ELEMENTS)])


def test_places_and_angles_are_those_of_draws() -> None:
    tensor = 0.2 / 12 * np.diag([0.03**2 + 0.01**2, 0.04**2 + 0.01**2, 0.04**2 + 0.03**2])
    wrong = {"position_uncertainty": 0.02, "angle_uncertainty": 0.1}
    part = {"name": "b", "parent": "group", "mass": 0.2, "inertia": tensor.tolist(), "center_of_mass": [4, 5, 6]}
    part |= {"at": [50, 0, 10], "around": {"count": 3, "axis": "z"}} | wrong
    sigma = budget_of(GROUP | wrong, part).total.sigma
    draws = draws_of_places(6000, 5, 2e-5, math.radians(0.1))
    assert sigma.all[1:10] == pytest.approx(draws.std(axis=0)[1:], rel=0.05)
    assert sigma.labels == ("position of b", "angle of b", "position of group", "angle of group")


INNER = """
[[part]]
name = "p"
at = [10, 20, 5]
mass = "1±0.05"
center_of_mass = [30, -10, 20]
position_uncertainty = 0.1
angle_uncertainty = 0.2
[[part]]
name = "q"
parent = "p"
shape = "point"
mass = 0.5
at = [-20, 10, 30]
position_uncertainty = 0.1
angle_uncertainty = 0.2
"""
FRONT = {"name": "front", "at": [50, 0, 0], "around": {"count": 4, "axis": "z"}}
REAR = {"name": "rear", "at": [20, 30, -100], "euler": [40], "sequence": "x"}


@pytest.mark.parametrize("between", [False, True])
def test_places_in_a_file_that_several_parts_name_are_each_uncertain_by_itself(tmp_path: Path, between: bool) -> None:
    (tmp_path / "inner.toml").write_text(INNER)
    for name in ("front", "rear"):
        (tmp_path / f"{name}.toml").write_text('[[part]]\nname = "n"\nassembly = "inner.toml"\n')
    parts = [part | {"assembly": f"{part['name'] if between else 'inner'}.toml"} for part in (FRONT, REAR)]
    whole = Assembly.from_dict({"part": parts}, tmp_path)
    sigma = whole.budget().total.sigma
    places = [f"{what} of {name} (inner.toml)" for name in "qp" for what in ("position", "angle")]
    assert sigma.labels == ("mass of p (inner.toml)", *places)
    assert len(sigma.changes) == 1 + 4 * 3 * 5  # the mass is common to all five
    assert sigma.mass == pytest.approx(5 * 0.05)
    assert sigma.shares()[1:].sum(axis=0)[1:10] == pytest.approx(1 - sigma.shares()[0, 1:10])
    # 4,000 draws tell a standard deviation to 1.1 %.
    ratios = ratios_of(whole, 4000)
    assert len(ratios) == 10
    assert all(0.95 < ratio < 1.05 for ratio in ratios.values()), ratios


def test_a_limit_on_parts_of_one_file_is_judged_by_the_place_of_each(tmp_path: Path) -> None:
    (tmp_path / "n.toml").write_text(
        'unit = "mm"\n[[part]]\nname = "p"\nshape = "point"\nmass = 1\nposition_uncertainty = 1\n'
    )
    wings = [{"name": f"wing {x}", "assembly": "n.toml", "at": [x, 0, 0]} for x in (100, -100)]
    whole = Assembly.from_dict({"part": wings, "limit": [{"what": "inertia.zz", "max": 0.02001}]}, tmp_path).budget()
    assert whole.total.sigma.center_of_mass == pytest.approx(1e-3 / math.sqrt(2))
    assert whole.limits[0].uncertainty == pytest.approx(math.sqrt(2) * 2 * 0.1 * 1e-3)
    assert whole.verdict == "undecided"


def test_noise_of_a_mesh_is_common_to_its_parts_of_several_densities(tmp_path: Path) -> None:
    cube = path("cube.stl")
    (tmp_path / "n.toml").write_text(f"[[part]]\nname = 'p'\nfile = '{cube}'\nunit = 'mm'\nsigma = 0.05\n")
    densities = {"a": 2700.0, "b": 1234.5}
    for name, density in densities.items():
        (tmp_path / f"{name}.toml").write_text(
            f'[materials]\np = "m"\n[densities]\nm = {density}\n[[part]]\nname = "n"\nassembly = "n.toml"\n'
        )
    parts = [{"name": name, "assembly": f"{name}.toml"} for name in densities]
    sigma = Assembly.from_dict({"part": parts}, tmp_path).budget().total.sigma
    together = inertia.analyse(inertia.read(cube, unit="mm"), sum(densities.values()), sigma=0.05).uncertainty
    assert together is not None
    assert sigma.labels == ("vertices of p (n.toml)",)
    assert sigma.mass == pytest.approx(together.mass)
    assert sigma.center_of_mass == pytest.approx(together.center_of_mass)
    assert sigma.inertia == pytest.approx(together.inertia)


def test_a_place_in_a_nested_file_is_uncertain_in_its_unit(tmp_path: Path) -> None:
    (tmp_path / "inner.toml").write_text(
        'unit = "in"\n[[part]]\nname = "p"\nshape = "point"\nmass = 1\nposition_uncertainty = 1\n'
    )
    whole = Assembly.from_dict({"part": [{"name": "n", "assembly": "inner.toml"}]}, tmp_path)
    assert whole.budget().total.sigma.center_of_mass == pytest.approx([0.0254] * 3)


def test_parts_of_files_of_one_name_vary_by_themselves(tmp_path: Path) -> None:
    parts = []
    for side in ("left", "right"):
        (tmp_path / side).mkdir()
        (tmp_path / side / "arm.toml").write_text('[[part]]\nname = "p"\nshape = "point"\nmass = "3±0.3"\n')
        parts.append({"name": side, "assembly": f"{side}/arm.toml"})
    sigma = Assembly.from_dict({"part": [*parts, {**parts[0], "name": "again"}]}, tmp_path).budget().total.sigma
    assert sigma.labels == ("mass of p (left/arm.toml)", "mass of p (right/arm.toml)")
    assert sigma.mass == pytest.approx(math.hypot(0.6, 0.3))


def test_parts_of_one_material_vary_together_and_others_do_not() -> None:
    parts = [{"name": f"p{k}", "shape": "box", "size": [100, 100, 100], "at": [200 * k, 0, 0]} for k in range(4)]
    common = budget_of(*(p | {"material": "oak"} for p in parts), densities={"oak": "700±10"}).total.sigma
    apart = budget_of(*(p | {"density": "700±10"} for p in parts)).total.sigma
    assert common.labels == ("density of oak",)
    assert common.mass == pytest.approx(0.04)
    assert apart.mass == pytest.approx(0.02)
    assert common.center_of_mass == pytest.approx(0, abs=1e-16)
    assert apart.center_of_mass[0] > 1e-4


def test_the_whole_is_not_sure_of_what_a_part_is_sure_of() -> None:
    whole = budget_of(REST, {"name": "b", "shape": "point", "mass": "0.1±0.01", "at": [30, 0, 0]})
    rest, ball = whole.total.children
    assert rest.sigma.mass == 0
    assert ball.sigma.mass == pytest.approx(0.01)
    assert ball.sigma.center_of_mass == pytest.approx(0, abs=1e-18)
    assert whole.total.sigma.center_of_mass[0] > 0


def test_allowances_come_from_the_nearest_that_states_one() -> None:
    box = {"shape": "box", "size": [10, 10, 10], "mass": 1.0}
    whole = budget_of(
        {"name": "g", "category": "harness", "maturity": "layout"},
        box | {"name": "cable", "parent": "g"},
        box | {"name": "plug", "parent": "g", "maturity": "released", "category": "electronics"},
        box | {"name": "clip", "parent": "g", "allowance": 0.5},
        box | {"name": "loose"},
        box | {"name": "odd", "category": "optics", "maturity": "concept"},
        allowances={"optics": {"concept": 0.9}},
    )
    shares = {line.name: line.allowance for line in whole.total.lines()}
    expected = {"cable": 0.35, "plug": 0.08, "clip": 0.5, "loose": 0.0, "odd": 0.9, "g": 0.93}
    assert {name: shares[name] for name in expected} == pytest.approx(expected)
    assert whole.total.predicted_mass == pytest.approx(5 + 0.93 + 0.9)
    assert whole.notes == ("1 parts state no maturity and have no allowance: loose",)


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"maturity": "relesed"}, r"part\[0\]\.maturity is 'relesed': did you mean 'released'\?"),
        ({"maturity": "released", "category": "string"}, r"part\[0\]\.category is 'string': use one of"),
    ],
)
def test_a_word_that_the_table_has_not_is_refused(fields: dict[str, Any], says: str) -> None:
    with pytest.raises(UsageError, match=says):
        budget_of(REST | fields)


def test_a_word_of_a_nested_file_is_refused_with_that_file(tmp_path: Path) -> None:
    (tmp_path / "inner.toml").write_text('[[part]]\nname = "p"\nshape = "point"\nmass = 1\ncategory = "string"\n')
    nested = Assembly.from_dict({"part": [{"name": "n", "assembly": "inner.toml"}]}, tmp_path)
    with pytest.raises(UsageError, match=r"inner\.toml: part\[0\]\.category is 'string'"):
        nested.budget()


def test_an_allowance_above_the_mass_itself_is_said() -> None:
    words = "its mass growth allowance is 1500 % of its basic mass: allowances are parts of it, 0.15 for 15 %"
    by_part = budget_of(REST | {"allowance": 15})
    by_table = budget_of(REST | {"category": "x", "maturity": "released"}, allowances={"x": {"released": 15}})
    assert [whole.notes for whole in (by_part, by_table)] == 2 * [(f"rest: {words}",)]
    assert budget_of(REST | {"allowance": 1}).notes == ()


def test_a_row_without_maturities_says_so() -> None:
    with pytest.raises(UsageError, match="none, as that row is empty"):
        budget_of(REST | {"maturity": "released"}, allowances={"other": {}})


@pytest.mark.parametrize(
    ("low", "high", "u", "verdict"),
    [
        (None, 2.0, 0.0, "pass"),
        (None, 1.0, 0.0, "pass"),
        (None, 0.9, 0.0, "fail"),
        (None, 1.1, 0.1, "undecided"),
        (None, 1.2, 0.1, "pass"),
        (None, 0.9, 0.1, "undecided"),
        (None, 0.8, 0.1, "fail"),
        (0.0, 3.0, 0.4, "pass"),
        (0.9, 1.3, 0.1, "undecided"),
    ],
)
def test_a_limit_is_judged_by_the_interval_of_95_percent(
    low: float | None, high: float | None, u: float, verdict: str
) -> None:
    assert Limit("mass", 1.0, low, high, u, 0.0).verdict == verdict


@pytest.mark.parametrize(
    ("masses", "what", "limit", "verdict"),
    [
        ((0.1, 0.2), "mass", {"max": 0.3}, "pass"),
        ((0.1,) * 10, "mass", {"min": 1.0, "max": 1.0}, "pass"),
        ((1.0,), "mass", {"max": 1.0}, "pass"),
        ((1.0, 1.0), "inertia.yy/inertia.zz", {"min": 1.0}, "pass"),
        ((0.1, 0.2), "mass", {"max": 0.2999999999999}, "fail"),
        ((0.1, "0.2±0.001"), "mass", {"max": 0.3}, "undecided"),
    ],
)
def test_what_equals_a_limit_in_decimals_is_within_it(
    masses: tuple[float | str, ...], what: str, limit: dict[str, float], verdict: str
) -> None:
    points = [{"name": f"p{k}", "shape": "point", "mass": mass, "at": [k, 0, 0]} for k, mass in enumerate(masses)]
    assert budget_of(*points, limit=[{"what": what, **limit}]).verdict == verdict


@pytest.mark.parametrize(
    ("mass", "limit"),
    [
        (1.0, {"max": 0.9999999}),
        (1.0, {"max": 1.0}),
        (0.1, {"min": 0.1000000000001}),
        (1234567.0, {"max": 1234568.0}),
        ("0.9804001±0.01", {"max": 1.0}),
        ("0.9804±0.01", {"max": 1.0}),
        ("1.019601±0.01", {"max": 1.0}),
        ("3±0.001", {"min": 3.00196, "max": 3.1}),
        ("1±1e-14", {"max": 0.99999999999}),
    ],
)
def test_figures_of_a_limit_say_what_its_verdict_says(mass: float | str, limit: dict[str, float]) -> None:
    point = {"name": "p", "shape": "point", "mass": mass, "at": [0.74, 0, 0]}
    whole = budget_of(point, limit=[{"what": "mass", **limit}])
    (line,) = re.findall(r"Limit +mass (.*)", budget_text(whole))
    (row,) = re.findall(
        r'<th scope="row">mass</th><td class="left">kg</td><td>(.*?)</td><td>(.*?)</td><td>(.*?)</td>',
        budget_html(whole),
    )
    for least, value, largest in (
        row,
        [(re.search(sign, line) or [""] * 2)[1] for sign in (r"≥ (\S+)", r" kg: (.*?) kg", r"≤ (\S+)")],
    ):
        size, reach = (Fraction(k) for k in f"{value.removesuffix(' (95 %)')} ± 0".split(" ± ")[:2])
        ends = [Fraction(largest) - size] if largest else []
        margin = min([*ends, size - Fraction(least)] if least else ends)
        assert ("pass" if margin >= reach else "fail" if margin < -reach else "undecided") == whole.verdict


def test_a_report_on_one_point_says_that_its_tensor_is_zero() -> None:
    page = budget_html(budget_of({"name": "p", "shape": "point", "mass": 1.0}))
    assert "m; the tensor is zero." in page
    assert "inf" not in page


def test_long_names_stand_above_their_figures_and_fit_beside_their_bars() -> None:
    name = 3 * "left_front_wheel_steering_actuator_housing_link_"
    whole = budget_of(
        {"name": name, "shape": "point", "mass": "1±0.1"}, {"name": "p", "shape": "point", "mass": "2±0.1"}
    )
    lines = budget_text(whole).splitlines()
    at = lines.index(f"  {name}")
    assert lines[at + 1].split()[:2] == ["1", "1"]
    assert lines[lines.index(f"mass of {name}") + 1].split()[0] == "50.0"
    assert max(len(line) for line in lines if name not in line) <= 120
    labels = re.findall(r"<text[^>]*>([^<]*)</text>", budget_html(whole))
    assert {len(each) for each in labels if each.startswith("mass of left")} == {28}


def test_limits_are_on_what_the_file_names() -> None:
    point = {"name": "p", "shape": "point", "mass": "1±0.01", "at": [20, 0, 0], "allowance": 0.1}
    whole = budget_of(
        REST,
        point,
        limit=[
            {"what": "mass", "max": 1.5},
            {"what": "basic_mass", "max": 1.31},
            {"what": "center_of_mass.x", "min": 10, "max": 20},
            {"what": "inertia.zz/inertia.xx", "max": 1.0},
            {"what": "principal.1", "min": 1e-9},
        ],
    )
    total = whole.total
    mass, basic, x, ratio, least = whole.limits
    assert (mass.value, mass.uncertainty) == (pytest.approx(1.4), pytest.approx(0.011))
    assert (basic.verdict, mass.verdict, x.verdict, ratio.verdict, least.verdict) == (
        "undecided",
        "pass",
        "pass",
        "fail",
        "pass",
    )
    assert x.value == pytest.approx(total.center_of_mass[0])
    assert x.low == pytest.approx(0.01)
    assert ratio.value == pytest.approx(total.inertia[2, 2] / total.inertia[0, 0])
    step = 1e-6

    def ratio_at(m: float) -> float:
        values = figures(REST, point | {"mass": m})
        return float(values[6] / values[4])

    assert ratio.uncertainty == pytest.approx(0.01 * abs(ratio_at(1 + step) - ratio_at(1 - step)) / 2 / step, rel=1e-5)
    assert whole.verdict == "fail"


@pytest.mark.parametrize(
    ("what", "says"),
    [
        ("inertia.yx", "did you mean inertia.xy?"),
        ("mass/inertia.ZX", "did you mean inertia.xz?"),
        ("predicted_mass", "did you mean mass?"),
        ("basic_mas", "did you mean basic_mass?"),
        ("com.z", "did you mean center_of_mass.z?"),
        ("centre_of_mass.x", "did you mean center_of_mass.x?"),
        *(
            (what, "use mass, basic_mass, ")
            for what in ("center_of_mass.r", "inertia", "principal.4", "volume", "mass.x")
        ),
    ],
)
def test_a_limit_on_what_is_not_known_is_refused_with_the_same_quantity_or_with_all(what: str, says: str) -> None:
    one = what.rpartition("/")[2]
    with pytest.raises(UsageError, match=re.escape(f"limit[0].what is {one!r}: {says}")):
        budget_of(REST, limit=[{"what": what, "max": 1}])


def test_principal_moments_are_uncertain_as_differences_say() -> None:
    parts = [REST | {"euler": [10, 20, 30], "sequence": "ZXZ"}, {"name": "p", "shape": "point", "at": [20, 9, 1]}]
    limits = [{"what": f"principal.{k}", "max": 1.0} for k in (1, 2, 3)]
    whole = budget_of(parts[0], parts[1] | {"mass": "0.1±0.01"}, limit=limits)
    ends = [
        Assembly.from_dict({"part": [parts[0], parts[1] | {"mass": m}]}).mass_properties().principal_moments
        for m in (0.1 - 1e-6, 0.1 + 1e-6)
    ]
    expected = 0.01 * np.abs(ends[1] - ends[0]) / 2e-6
    assert [limit.uncertainty for limit in whole.limits] == pytest.approx(expected.tolist(), rel=1e-5)


def sawe_parts() -> list[dict[str, Any]]:
    """Return the example of SAWE paper 3360's formulas that the R package massProps prints in its read-me."""

    def part(
        name: str, parent: str, mass: float, at: list[float], tensor: list[float], u: list[float]
    ) -> dict[str, Any]:
        def matrix(six: list[float]) -> list[list[float]]:
            xx, yy, zz, xy, xz, yz = six
            return [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]

        stated = {"name": name, "parent": parent, "mass": f"{mass}±{u[0]}", "center_of_mass": at}
        stated |= {"inertia": matrix(tensor), "inertia_uncertainty": matrix(u[2:])}
        return stated | ({"center_of_mass_uncertainty": u[1]} if u[1] else {})

    places = [[x, y, z] for x in (1, -1) for y in (1, -1) for z in (1, -1)]
    own = [4, 4, 4, -0.1, -0.1, 0.1], [0.2, 0.1, 0.4, 0.4, 0.4, 0.01, 0.01, 0.01]
    return [
        {"name": "A.1"},
        {"name": "A.2", "parent": "A.1"},
        {"name": "A.3", "parent": "A.1"},
        part("C.1", "A.1", 5, [0, 0, 0], [80, 80, 75, -4, -24, -24], [0.5, 0, 8, 8, 7.5, 0.4, 2.4, 2.4]),
        *(part(f"P.{k}", "A.2" if k < 5 else "A.3", 2, at, *own) for k, at in enumerate(places, 1)),
    ]


def test_the_roll_up_is_that_of_the_example_of_sawe_paper_3360() -> None:
    whole = budget_of(*sawe_parts(), unit="m")
    lines = {line.name: line for line in whole.total.lines()}
    top, left = lines["A.1"], lines["A.2"]
    assert (top.basic_mass, left.basic_mass) == (21, 8)
    assert top.center_of_mass == pytest.approx(0, abs=1e-15)
    assert left.center_of_mass == pytest.approx([1, 0, 0], abs=1e-15)
    assert [top.inertia[k] for k in ELEMENTS] == pytest.approx([144, 144, 139, -4.8, -24.8, -23.2])
    assert [left.inertia[k] for k in ELEMENTS] == pytest.approx([32, 24, 24, -0.4, -0.4, 0.4])
    assert (top.sigma.mass, left.sigma.mass) == (pytest.approx(0.7549834), pytest.approx(0.4))
    assert top.sigma.center_of_mass == pytest.approx(0.03809524, rel=1e-6)
    assert left.sigma.center_of_mass == pytest.approx([0.05, 0.07071068, 0.07071068])
    u_top, u_left = ([line.sigma.inertia[k] for k in ELEMENTS] for line in (top, left))
    assert u_left == pytest.approx([1.6, 1.2, 1.2, 0.4004997, 0.4004997, 0.6931089], rel=1e-6)
    # Rolled up level by level, as the example is, yy and zz are 8.275264 and 7.792946: that masses and centres of A.2
    # and A.3 are off together is lost. Straight from the parts they are √(64 + 8 · 0.64) and √(56.25 + 8 · 0.64).
    yy, zz = math.sqrt(64 + 5.12), math.sqrt(56.25 + 5.12)
    assert u_top == pytest.approx([8.313844, yy, zz, 1.0586784, 2.5924506, 2.5924506], rel=1e-6)
