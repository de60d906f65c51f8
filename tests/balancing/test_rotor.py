"""The rotor file: what it may hold, what it means in SI units, and how it is refused."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mass.parts import surface

import inertia
from inertia.balancing.rotor import Key, Rotor, json_schema
from inertia.balancing.unbalance import Unbalance
from inertia.errors import ReadError, UsageError, visible
from inertia_meshes import path, rotors
from inertia_meshes.shapes import box, moved

DOCS = Path(__file__).resolve().parents[2] / "docs"

PLAIN = {
    "body": [{"file": "rotor.stl", "density": 7850}],
    "axis": {"bearing_a": [0, 0, 20], "bearing_b": [0, 0, 280]},
    "service": {"rpm": 3000},
    "tolerance": {"grade": 6.3},
}
DRILLED = {"id": "I", "z": 90, "method": "drill_radial", "radius": 100, "diameters": [8, 10]}
KIT = {"id": "II", "z": 215, "method": "kit", "radius": 80, "angles": [0, 90], "kit": [{"mass_g": 5}]}


def table(**changes: object) -> dict:
    """PLAIN with entries changed; ``section__field`` reaches into a section, None takes an entry away."""
    made = json.loads(json.dumps(PLAIN))
    for key, value in changes.items():
        section, _, field = key.partition("__")
        target, name = (made.setdefault(section, {}), field) if field else (made, section)
        if value is None:
            target.pop(name, None)
        else:
            target[name] = value
    return made


def rotor(**changes: object) -> Rotor:
    return Rotor.from_dict(table(**changes))


def test_lengths_become_metres_and_angles_radians() -> None:
    described = rotor(plane=[DRILLED | {"max_depth": 20, "angle_step": 1, "forbidden": [[350, 10]], "wall": 2}, KIT])
    assert described.shaft is not None
    assert (described.shaft.z_a, described.shaft.z_b) == (0.02, 0.28)
    plane = described.correction_plane(0, math.nan)
    assert (plane.z, plane.radius, plane.max_depth, plane.min_wall) == (0.09, 0.1, 0.02, 0.002)
    assert plane.diameters == (0.008, 0.01)
    assert plane.angle_step == math.radians(1)
    assert (plane.forbidden[0].start, plane.forbidden[0].stop) == (math.radians(350), math.radians(10))
    kit = described.correction_plane(1, math.nan)
    assert kit.angles == (0.0, 0.5 * math.pi)
    assert [(k.name, k.mass) for k in kit.kit] == [("5 g", 0.005)]


def test_a_file_in_inches_describes_the_same_rotor() -> None:
    inches = rotor(unit="in", axis={"bearing_a": [0, 0, 1], "bearing_b": [0, 0, 11]})
    metric = rotor(axis={"bearing_a": [0, 0, 25.4], "bearing_b": [0, 0, 279.4]})
    assert inches.shaft is not None
    assert metric.shaft is not None
    assert inches.shaft.span == pytest.approx(metric.shaft.span, rel=1e-15)


def test_even_angles_are_spelled_out() -> None:
    plane = rotor(plane=[KIT | {"angles": {"count": 4, "offset": 45}}]).correction_plane(0, 0.1)
    np.testing.assert_allclose(np.degrees(plane.angles), [45, 135, 225, 315], atol=1e-12)


def test_a_radius_left_out_is_that_of_the_bodies() -> None:
    lacking = {key: value for key, value in DRILLED.items() if key != "radius"}
    assert rotor(plane=[lacking]).correction_plane(0, 0.123).radius == 0.123


def test_the_zero_mark_is_along_x_where_none_is_given() -> None:
    shaft = rotor().shaft
    assert shaft is not None
    assert shaft.axes[:, 0].tolist() == [1, 0, 0]


@pytest.mark.parametrize(
    ("tolerance", "gmm"),
    [
        ({"grade": 6.3}, 1e3 * 6.3 * 10 / (100 * math.pi)),
        ({"standard": "ISO 21940-11", "grade": 6.3}, 1e3 * 6.3 * 10 / (100 * math.pi)),
        ({"standard": "MIL-STD-167-1", "revision": "A", "grade": 6.3}, 1e3 * 6.3 * 10 / (100 * math.pi)),
        ({"e_um": 5}, 5 * 10),
        ({"grade": 5}, 1e3 * 5 * 10 / (100 * math.pi)),
        ({"grade": "G6.3"}, 1e3 * 6.3 * 10 / (100 * math.pi)),
        ({"standard": "ISO 1940-1", "grade": "G 2.5"}, 1e3 * 2.5 * 10 / (100 * math.pi)),
        ({"standard": "ISO 1940", "grade": 2.5}, 1e3 * 2.5 * 10 / (100 * math.pi)),
        ({"grade": 1.6}, 1e3 * 1.6 * 10 / (100 * math.pi)),
        ({"standard": "ISO 21940-12", "grade": 2.5}, 1e3 * 2.5 * 10 / (100 * math.pi)),
        ({"standard": "ISO 14694", "category": "BV-2"}, 1e3 * 16 * 10 / (100 * math.pi)),
        ({"standard": "ISO 14694", "category": "BV-3"}, 1e3 * 6.3 * 10 / (100 * math.pi)),
        ({"standard": "ISO 14694", "category": "BV-4"}, 1e3 * 2.5 * 10 / (100 * math.pi)),
        ({"standard": "ISO 14694", "category": "BV-5"}, 1e3 * 1 * 10 / (100 * math.pi)),
    ],
)
def test_criteria_with_a_total(tolerance: dict, gmm: float) -> None:
    limits = rotor(tolerance=tolerance).tolerance(Unbalance(10.0, 0.15, 0, 0), (0.02, 0.28))
    assert limits.total == pytest.approx(1e-6 * gmm, rel=1e-14)


@pytest.mark.parametrize(
    ("tolerance", "gmm"),
    [
        ({"standard": "API 617"}, 6350 * 5 / 3000),  # each journal carries half
        ({"standard": "MIL-STD-167-1", "revision": "1974"}, 6350 * 10 / 3000),
        ({"bearing_force": [9, 9]}, 9 / (100 * math.pi) ** 2 * 1e6),
    ],
)
def test_criteria_by_plane(tolerance: dict, gmm: float) -> None:
    limits = rotor(tolerance=tolerance).tolerance(Unbalance(10.0, 0.15, 0, 0), (0.02, 0.28))
    assert limits.permissible == pytest.approx((1e-6 * gmm, 1e-6 * gmm), rel=1e-14)


def test_what_the_shop_holds_is_in_the_files_unit() -> None:
    shop = rotor(unit="in", uncertainty={"depth": 0.004, "angle": 1, "mass": 0.02}).shop
    assert shop.depth.common == pytest.approx(0.004 * 0.0254, rel=1e-15)
    assert (shop.depth.separate, shop.angle.common, shop.mass.separate) == (0.0, math.radians(1), 0.02)
    shop = rotor(uncertainty={"depth": {"common": 0.2, "separate": 0.1}, "mass": {"common": 0.01}}).shop
    assert (shop.depth.common, shop.depth.separate) == pytest.approx((2e-4, 1e-4))
    assert (shop.mass.common, shop.mass.separate) == (0.01, 0.0)
    with pytest.raises(UsageError, match=r"uncertainty\.depth\.separate is -1"):
        rotor(uncertainty={"depth": {"separate": -1}})
    with pytest.raises(UsageError, match=r"uncertainty\.depth is 'x'"):
        rotor(uncertainty={"depth": "x"})
    assert shop.diameter == rotor().shop.diameter


def test_half_a_key_weighs_half() -> None:
    key = {"convention": "H", "width": 8, "height": 7, "length": 40, "floor": 11, "z": 100, "density": 8000}
    (mass,) = rotor(key=[key]).key_masses
    assert mass.mass == pytest.approx(8000 * 8e-3 * 3.5e-3 * 40e-3, rel=1e-14)
    assert (mass.radius, mass.z) == (pytest.approx(0.01275), pytest.approx(0.1))


@pytest.mark.parametrize("name", rotors())
def test_a_sample_survives_a_round_trip(name: str) -> None:
    first = Rotor.load(path(name))
    again = Rotor.loads(first.to_toml())
    assert again.to_dict() == first.to_dict()
    assert again.to_toml() == first.to_toml()


texts = st.text(st.characters(exclude_categories=["Cs"]), min_size=1).filter(
    lambda text: text.strip() and visible(text) == text
)
lengths = st.floats(1e-6, 1e6)


@settings(deadline=None, max_examples=60)
@given(
    name=texts,
    z=st.lists(st.integers(-500, 500), unique=True, max_size=4),
    radius=lengths,
    angles=st.lists(st.floats(0, 359), min_size=1, max_size=5),
    count=st.integers(1, 99),
)
def test_any_rotor_survives_a_round_trip(name: str, z: list, radius: float, angles: list, count: int) -> None:
    places = [{"id": f"{name}{k}", "z": place, "method": "add", "radius": radius} for k, place in enumerate(z)]
    choices = ("free", {"count": count}, angles, {"count": count, "offset": 12.5})
    planes = [plane | {"angles": chosen} for plane, chosen in zip(places, choices, strict=False)]
    first = rotor(plane=planes, report={"part": name}, service__critical_rpm=radius)
    assert Rotor.loads(first.to_toml()).to_dict() == first.to_dict()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bdy": []}, "bdy is unknown: did you mean body?"),
        ({"body": None}, "body is missing"),
        ({"body": []}, "body is missing: it has to be given, or an assembly in its place"),
        ({"body": {"file": "a.stl"}}, "body must be a list of tables: write [[body]]"),
        ({"body": [{"file": "a.stl"}, {"file": "b.stl", "mass": 1}]}, "body[0] says nothing of how heavy it is"),
        ({"body": [{"file": "a.stl"}], "tolerance": {"bearing_force": [1, 1]}}, "body[0] says nothing of how heavy"),
        ({"body": [{"file": "a.stl", "mass": 1, "density": 1}]}, "body[0] has both density and mass"),
        ({"body": [{"file": "a.stl", "dens": 1}]}, "body[0].dens is unknown: did you mean density?"),
        ({"body": [{"density": 1}]}, "body[0].file is missing"),
        ({"body": [{"file": "a.stl", "material": "steal"}]}, "body[0].material is an unknown material 'steal'"),
        ({"unit": "parsec"}, "unit is an unknown unit 'parsec'"),
        ({"schema": 2}, "schema is 2: this version reads schema = 1"),
        ({"axis": {}}, "axis.bearing_a is missing: give the centres of both bearings, or journals"),
        ({"axis__bearing_b": None}, "axis.bearing_b is missing"),
        ({"axis__bearing_b": [0, 0, 20]}, "axis.bearing_a and bearing_b are 0 mm apart"),
        ({"axis__journals": "detect"}, "axis.journals goes with no bearing_a"),
        ({"axis": {"journals": "find"}}, "axis.journals is 'find': use 'detect', or name two regions"),
        ({"axis": {"journals": ["a"]}}, "axis.journals names 1 regions: name two"),
        ({"axis__zero_mark": [0, 0, 1]}, "axis.zero_mark [0.0, 0.0, 1.0] runs along the shaft"),
        ({"axis__bearing_a": [0, 0]}, "axis.bearing_a has 2 entries, not 3"),
        ({"axis__rotation": "left"}, "axis.rotation is 'left': use one of 'ccw', 'cw'"),
        ({"service__rpm": 0}, "service.rpm is 0: it must be positive"),
        ({"service": {"rmp": 3000}}, "service.rmp is unknown: did you mean rpm?"),
        ({"tolerance": None}, "tolerance is missing"),
        ({"tolerance": {}}, "tolerance says nothing: give a grade"),
        ({"tolerance": {"standard": "ISO 14694"}}, "tolerance.category is missing: ISO 14694 goes by a category"),
        ({"tolerance": {"standard": "ISO 14694", "grade": 1}}, "tolerance.grade goes with no ISO 14694"),
        ({"tolerance": {"grade": 1, "category": "BV-3"}}, "tolerance.category goes with no ISO 21940-11"),
        ({"tolerance": {"standard": "ISO 14694", "category": "BV-6"}}, "tolerance.category is 'BV-6'"),
        ({"tolerance": {"grade": 2.5, "e_um": 3}}, "tolerance.e_um goes with no grade"),
        ({"tolerance": {"standard": "ISO 21940-11"}}, "tolerance.grade is missing"),
        ({"tolerance": {"standard": "API 610", "grade": 1}}, "tolerance.grade goes with no API 610"),
        ({"tolerance": {"standard": "MIL-STD-167-1"}}, "tolerance.revision is missing"),
        ({"tolerance": {"standard": "MIL-STD-167-1", "revision": "A"}}, "tolerance.grade is missing"),
        ({"tolerance": {"grade": 1, "revision": "A"}}, "tolerance.revision goes with MIL-STD-167-1 only"),
        ({"plane": [DRILLED, KIT | {"z": 90}]}, "plane[1].z is 90, where plane 'I' is too"),
        ({"plane": [DRILLED, KIT | {"id": "I"}]}, "plane[1].id is 'I', as that of plane[0]"),
        ({"plane": [DRILLED | {"method": "drill"}]}, "plane[0].method is 'drill': use one of 'add'"),
        ({"plane": [DRILLED | {"diameters": None} | {"diameters": []}]}, "plane[0].diameters has 0 entries"),
        ({"plane": [DRILLED | {"diameters": [8, -1]}]}, "plane[0].diameters[1] is -1: it must be positive"),
        ({"plane": [DRILLED | {"max_depth": 99}]}, "plane[0]: a drill of 8 mm reaches"),
        ({"plane": [DRILLED | {"point_angle": 190}]}, "plane[0].point_angle is 190: it must be 180, flat, or less"),
        ({"plane": [DRILLED | {"forbidden": [[0, 360]]}]}, "plane[0].forbidden[0] is [0, 360], the whole turn: leave"),
        ({"plane": [DRILLED | {"forbidden": [[20, 20]]}]}, "plane[0].forbidden[0] ends where it begins, at 20"),
        ({"tolerance": {"bearing_force": [0, 5]}}, "tolerance.bearing_force is [0, 5] N: both must be positive"),
        ({"tolerance": {"grade": "G6.3x"}}, "tolerance.grade is 'G6.3x': it must be a number of mm/s"),
        ({"tolerance": {"grade": "G0"}}, "tolerance.grade is 0.0: it must be positive"),
        ({"plane": [DRILLED | {"forbidden": [[0, 1, 2]]}]}, "plane[0].forbidden[0] has 3 entries, not 2"),
        (
            {"plane": [KIT | {"kit": [{"mass_g": 5}, {"mass": 5}]}]},
            "plane[0].kit[1].mass is unknown: did you",
        ),
        ({"plane": [KIT | {"kit": []}]}, "plane[0]: its kit is empty"),
        ({"plane": [KIT | {"angles": {"count": 0}}]}, "plane[0].angles.count is 0: it must be between 1"),
        ({"plane": [KIT | {"angles": "all"}]}, "plane[0].angles is 'all': use 'free'"),
        ({"plane": [{"id": "I", "z": 1, "method": "drill_axial"}]}, "plane[0].radius is missing"),
        ({"uncertainty": {"density": 1}}, "uncertainty.density is 1: it must be below 1"),
        ({"key": [{"convention": "G"}]}, "key[0].width is missing"),
    ],
)
def test_a_field_that_is_wrong_is_named_in_one_sentence(changes: dict, message: str) -> None:
    with pytest.raises(UsageError) as caught:
        rotor(**changes)
    assert str(caught.value).startswith("the rotor: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_file_that_is_no_toml_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "rotor.toml"
    with pytest.raises(ReadError, match=r"cannot read .*rotor\.toml: there is no such file"):
        Rotor.load(file)
    file.write_bytes(b"\xff\xfe")
    with pytest.raises(ReadError, match="it is text in UTF-16: save it as UTF-8"):
        Rotor.load(file)
    file.write_text("[axis")
    with pytest.raises(ReadError, match="it is not TOML"):
        Rotor.load(file)


def test_the_schema_in_the_documentation_is_current() -> None:
    assert json.loads((DOCS / "rotor.schema.json").read_text()) == json_schema()


def test_the_schema_knows_every_field_and_says_what_it_is() -> None:
    schema = json_schema()
    assert schema["required"] == ["axis", "service", "tolerance"]
    lacking = []

    def visit(node: dict, where: str) -> None:
        for name, field in node.get("properties", {}).items():
            lacking.extend([f"{where}.{name}"] * ("description" not in field and where != ""))
            visit(field, f"{where}.{name}")
        if "items" in node:
            visit(node["items"], where)

    visit(schema, "")
    assert lacking == []
    assert not schema["additionalProperties"]
    assert not schema["properties"]["plane"]["items"]["additionalProperties"]


@pytest.mark.parametrize("name", rotors())
def test_a_sample_obeys_the_schema(name: str) -> None:
    valid(Rotor.load(path(name)).to_dict(), json_schema())


def valid(value: object, schema: dict, where: str = "rotor") -> None:
    """A small validator of what the schema uses."""
    if "oneOf" in schema:
        assert sum(passes(value, one) for one in schema["oneOf"]) == 1, where
        return
    kinds = {"object": dict, "array": list, "string": str, "boolean": bool, "integer": int, "number": (int, float)}
    if "type" in schema:
        assert isinstance(value, kinds[schema["type"]]), where
    assert value in schema.get("enum", [value]), where
    assert value == schema.get("const", value), where
    if isinstance(value, dict):
        properties = schema.get("properties", {})
        others = schema.get("additionalProperties")
        assert set(schema.get("required", ())) <= set(value), where
        assert others or set(value) <= set(properties), where
        for name, entry in value.items():
            valid(entry, properties.get(name, others), f"{where}.{name}")
    if isinstance(value, list):
        assert schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)), where
        for entry in value:
            valid(entry, schema["items"], where)
    if isinstance(value, int | float) and not isinstance(value, bool):
        assert value > schema.get("exclusiveMinimum", -math.inf), where
        assert value >= schema.get("minimum", -math.inf), where


def passes(value: object, schema: dict) -> bool:
    try:
        valid(value, schema)
    except AssertionError:
        return False
    return True


def test_descriptions_hold_no_stray_line_breaks() -> None:
    assert not re.search(r'"description": "[^"]*  ', json.dumps(json_schema()))


KEY = Key(width=8e-3, height=7e-3, length=40e-3, floor=11e-3, angle=math.radians(90), z=0.1, density=7850.0)


@pytest.mark.parametrize(("convention", "height"), [("H", 3.5), ("F", 7.0)])
def test_a_key_has_the_unbalance_of_the_box_that_it_is(convention: str, height: float) -> None:
    bar = moved(box(8, height, 40), 0, 11 + height / 2, 100)
    solid = inertia.mass_properties(surface(bar, unit="mm"), 7850.0)
    (mass,) = KEY.point_masses(convention)
    x, y, z = solid.center_of_mass
    assert (mass.mass, mass.z) == pytest.approx((solid.mass, z), rel=1e-12)
    assert mass.unbalance == pytest.approx(solid.mass * complex(x, y), rel=1e-12)


def test_without_a_key_there_is_no_mass() -> None:
    assert KEY.point_masses("N") == ()


def test_the_halves_of_shaft_and_hub_are_the_key() -> None:
    # The hub's keyway ends where the key does that stands on the shaft's.
    hub = replace(KEY, floor=18e-3, keyway="hub")
    (half,), (upper,), (full,) = KEY.point_masses("H"), hub.point_masses("H"), KEY.point_masses("F")
    assert upper.unbalance == pytest.approx(half.mass * (11e-3 + 0.75 * 7e-3) * 1j, rel=1e-12)
    assert half.unbalance + upper.unbalance == pytest.approx(full.unbalance, rel=1e-12)
    assert hub.point_masses("F")[0].unbalance == pytest.approx(full.unbalance, rel=1e-12)


def test_half_a_key_of_a_hub_lies_inside_its_keyway() -> None:
    key = {"convention": "H", "width": 8, "height": 7, "length": 40, "floor": 23.3, "z": 0, "keyway": "hub"}
    (mass,) = rotor(key=[key]).key_masses
    assert mass.mass * mass.radius == pytest.approx(7850 * 8e-3 * 3.5e-3 * 40e-3 * 21.55e-3, rel=1e-12)


def test_what_is_no_key_or_convention_is_refused() -> None:
    with pytest.raises(UsageError, match=r"'H' \(half key\), 'F' \(full key\) or 'N'"):
        KEY.point_masses("half")
    with pytest.raises(UsageError, match=r"the length of the key is 0\.0"):
        Key(8e-3, 7e-3, 0.0, 11e-3, 0.0, 0.1, 7850.0)
