"""Every document that is printed obeys the schema of its kind, which knows each of its fields."""

import importlib.util
import json
import re
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

DOCS = Path(__file__).resolve().parent.parent / "docs"
SCHEMAS = {file.name: json.loads(file.read_text(encoding="utf-8")) for file in (DOCS / "schemas").iterdir()}
OTHERS = """
analyse hollow_sphere.stl --material steel --about 1,2,3
analyse ellipsoid.stl --weld 1e-6 --union
check broken/inside_out.stl
check broken/zero_volume.stl
simulate scenes/diver.toml --samples 3
simulate scenes/tippe_top.toml --for 0.1 --samples 3
simulate scenes/explorer_1.toml --for 10 --samples 3
simulate scenes/pendulum.toml --samples 3
simulate scenes/detumbling.toml --for 10 --samples 3
simulate scenes/manoeuvre.toml --explain
simulate scenes/thrown_box.toml --samples 3 --vary start.angular_velocity[1]=0:1:3
assembly assemblies/cubesat.toml
budget assemblies/gripper.toml
budget assemblies/arm.toml
batch assemblies/fan.toml torus.stl broken/truncated.stl -o others.csv --verb check
"""


def list_schemas() -> Any:
    spec = importlib.util.spec_from_file_location("list_schemas", DOCS / "list_schemas.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


LIST = list_schemas()
COMMANDS = [line for line in (LIST.COMMANDS + OTHERS).splitlines() if line and line != "trade scenes/cube.toml"]  # slow


def closed(schema: Any) -> Any:
    """Return a schema that lets no further field pass."""
    if isinstance(schema, list):
        return [closed(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    inside = {name: closed(each) for name, each in schema.items()}
    return inside | {"additionalProperties": False} if isinstance(schema.get("properties"), dict) else inside


def test_every_kind_of_document_has_a_schema_and_a_description() -> None:
    page = (DOCS / "json.md").read_text(encoding="utf-8")
    assert all(f"](schemas/{name})" in page for name in SCHEMAS)
    assert all(f"`{schema['title']}`" in page for schema in SCHEMAS.values())
    headings = re.findall(r"`inertia/([\w-]+)/(\d)`", "".join(re.findall(r"^## .*\n", page, re.MULTILINE)))
    assert {f"{kind}-{version}.schema.json" for kind, version in headings} <= SCHEMAS.keys()


@pytest.mark.parametrize("name", SCHEMAS)
def test_a_schema_is_one(name: str) -> None:
    Draft202012Validator.check_schema(SCHEMAS[name])
    assert SCHEMAS[name]["title"] == f"inertia/{name.partition('.')[0].replace('-1', '/1')}"


@pytest.mark.parametrize("command", COMMANDS)
def test_a_document_has_the_fields_of_its_schema(command: str) -> None:
    for _, document in LIST.documents(command):
        _, kind, version = document["schema"].split("/")
        faults = Draft202012Validator(closed(SCHEMAS[f"{kind}-{version}.schema.json"])).iter_errors(document)
        assert [f"{fault.json_path}: {fault.message[:200]}" for fault in faults] == [], (
            "run python docs/list_schemas.py"
        )


@pytest.mark.parametrize("option", ["--samples 3", "--explain"])
def test_the_mass_of_a_body_may_be_null(option: str, tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    file.write_text("body.principal_moments = [1, 2, 3]\nstart.angular_velocity = [1, 2, 3]\nrun.duration = 1\n")
    test_a_document_has_the_fields_of_its_schema(f"simulate {file} {option}")


def test_a_document_that_lacks_a_field_is_no_such_document() -> None:
    ((_, document),) = LIST.documents("check cube.stl")
    validator = Draft202012Validator(SCHEMAS["check-1.schema.json"])
    assert validator.is_valid(document | {"added": 1})
    for name in document:
        broken = deepcopy(document)
        del broken[name]
        assert not validator.is_valid(broken)
