"""Write docs/schemas/: a JSON Schema of every document that the command prints, from what it prints for many inputs.

    python docs/list_schemas.py

A field is required where every document of its kind has it, and described by its row in docs/json.md.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shlex
import tempfile
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

from inertia_cli.main import main
from inertia_meshes import path

FOLDER = Path(__file__).with_name("schemas")
HOME = path("cube.stl").parent
COMMANDS = """
analyse cube.stl
analyse two_region_bar.vtk --density 1=2700±10 --density 2=7850
analyse two_region_bar.vtk --density 2700 --about 1,2,3 --accuracy 1e-12
analyse box.stl --density 7850±50 --scale 1±0.001 --sigma 0.01 --coverage 2 --about 0,0,1
analyse sphere.stl --chord 0.1 --mass 2 --parts separate
analyse broken/missing_face.stl --repair
analyse broken/missing_face.stl --allow-faults 0.9
analyse broken/overlapping_cubes.stl --union --unit m
analyse broken/missing_face.stl --shell 1 --weld 0.01
check cube.stl
check broken/missing_face.stl --allow-faults 0.9
check broken/overlapping_cubes.stl --allow-faults 1e-9
check broken/flipped_face.stl
check two_region_bar.vtk
audit robots/arm.urdf
simulate scenes/t_handle.toml --samples 3
simulate scenes/cat.toml --samples 4
simulate scenes/heavy_top.toml --samples 5 -o series.csv
simulate scenes/thrown_box.toml --samples 6 -o series.csv --force
simulate scenes/rolling_disc.toml --samples 7
simulate scenes/boom_satellite.toml --for 100 --samples 4
simulate scenes/spinning_top.toml --explain
simulate scenes/cube.toml --explain
simulate scenes/cube.toml --for 1 --samples 4 --vary start.angular_velocity[0]=1±10% --draws 40
trade cube.stl --accuracy 1e-12
trade scenes/cube.toml
balance rotors/disc.toml
balance rotors/two_disc_rotor.toml
balance rotors/bent_wheel.toml
balance rotors/shaft_impeller.toml
balance --grades
balance --grades --rpm 3000
balance measure jobs/fan.toml
balance measure jobs/two_disc_rotor.toml
assembly assemblies/fan.toml
assembly assemblies/gripper.toml --interference
assembly robots/arm.urdf --interference
assembly assemblies/arm.toml
budget assemblies/cubesat.toml
budget assemblies/fan.toml
budget --diff assemblies/fan.toml assemblies/gripper.toml
analyse broken/missing_face.stl
simulate scenes/t_handle.toml --samples -1
batch cube.stl box.stl broken/nan.stl -o rows.csv
batch rotors/disc.toml rotors/two_disc_rotor.toml --verb balance -o lot.csv
"""
NAMES = """
analysis.uncertainty.inputs analysis.uncertainty.components run.invariants run.quantities run-table.parts
run-table.figures run-table.units ensemble.states ensemble.models ensemble.sentences ensemble.quantities ensemble.events
ensemble.quantities.*.percentiles ensemble.quantities.*.largest ensemble.quantities.*.drivers.share
ensemble.quantities.*.drivers.rank ensemble.events.*.first balance.tolerance_planes[].uncertainty_gmm
balance.residual.tolerance_planes[].uncertainty_gmm budget.total.contributors[].share grades.standards[].fields
batch.states batch.exit_codes batch.lot.verdicts batch.lot.variance trade.steps
"""
"""Objects whose keys are names in the input, causes or numbers, not fields."""
NULLS = """
analysis.error.principal_moments[] analysis.error.repair.volume analysis.error.repair.mass
analysis.error.repair.center_of_mass analysis.error.repair.inertia analysis.inertia_about.error analysis.doubts[].place
analysis.uncertainty.principal_axes[] analysis.uncertainty.expanded.principal_axes[] check.findings[].place
audit.links[].stated audit.links[].computed audit.links[].difference audit.links[].triangle_margin
audit.links[].stated.mass audit.links[].stated.center_of_mass audit.links[].stated.inertia
assembly.error.inertia budget-diff.limits[][] budget-diff.changes[].sigma[] budget-diff.changes[].maturity[]
budget-diff.changes[].category[] budget.verdict budget.total.bound.inertia run.body.part run.body.mass
plan.body.part plan.body.mass plan.method
run.quantities.* run.quantities.*[] ensemble.quantities.*.drivers trade.rows[].error trade.accuracy
trade.recommendations[].row trade-scene.accuracy trade-scene.reference
trade-scene.rows[].error trade-scene.recommendations[].row batch.lot
run-table.scene_sha256 run-table.parts.* run-table.figures.* run-table.figures.*[] balance measurement
"""
"""What may be null although no document of these says so; of a balance and a measurement: all that has no value."""


def documents(commands: str = COMMANDS) -> Iterator[tuple[str, Any]]:
    """Yield each command with the document that it prints, and what heads the table that it writes."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        for entry in HOME.iterdir():
            (Path(folder) / entry.name).symlink_to(entry)
        try:
            os.chdir(folder)
            for command in commands.strip().splitlines():
                output = io.StringIO()
                with contextlib.redirect_stdout(output), contextlib.redirect_stderr(io.StringIO()) as errors:
                    main([*shlex.split(command), "--json"])
                if not output.getvalue():
                    raise SystemExit(f"{command}: {errors.getvalue()}")
                yield command, json.loads(output.getvalue())
                if "-o series.csv" in command:
                    yield command, json.loads(Path("series.csv").read_text(encoding="utf-8").splitlines()[0][2:])
        finally:
            os.chdir(before)


def schemas(printed: list[Any]) -> dict[str, dict[str, Any]]:
    """Return the schema of each kind of document among those printed."""
    kinds: dict[str, list[Any]] = {}
    for document in printed:
        kinds.setdefault(document["schema"], []).append(document)
    return {name: _titled(name, _schema(name.split("/")[1], documents)) for name, documents in sorted(kinds.items())}


def _titled(name: str, schema: dict[str, Any]) -> dict[str, Any]:
    rows = _meanings(name)
    properties = {
        field: {"description": rows[field], **entry} if field in rows else entry
        for field, entry in schema["properties"].items()
    }
    properties["schema"] = {"const": name}
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": name}
    return {**head, **schema, "properties": properties}


def _meanings(name: str) -> dict[str, str]:
    """Return what docs/json.md says of the fields of a document."""
    _, _, text = FOLDER.with_name("json.md").read_text(encoding="utf-8").partition(f"## `{name}`\n")
    rows = re.findall(r"^\| (`\w+`(?:, `\w+`)*) \| (.*) \|$", text.partition("\n## ")[0], re.MULTILINE)
    plain = {fields: re.sub(r"\[([^]]*)\]\([^)]*\)|`", r"\1", meaning) for fields, meaning in rows}
    return {field: meaning for fields, meaning in plain.items() for field in re.findall(r"\w+", fields)}


def _schema(where: str, values: list[Any]) -> dict[str, Any]:
    """Return the schema that all these values, met at one place of documents of a kind, obey."""
    some = [value for value in values if value is not None]
    types = sorted({_TYPES[type(value)] for value in some})
    if types == ["integer", "number"]:
        types = ["number"]
    null = len(some) < len(values) or where in _NULLS or ("." in where and where.split(".")[0] in _NULLS)
    names = [*types, *["null"] * null]
    schema: dict[str, Any] = {} if not types else {"type": names[0] if len(names) == 1 else names}
    if where.endswith(".parts") and {"name", "quantity"} <= set(chain.from_iterable(some[0] if some else [()])):
        return {"type": "array", "items": _nested([part for parts in some for part in parts], where)}
    tables = [value for value in some if isinstance(value, dict)]
    if tables and where in _MAPS:
        inside = [each for table in tables for each in table.values()]
        schema["additionalProperties"] = _schema(f"{where}.*", inside)
    elif tables:
        fields = dict.fromkeys(name for table in tables for name in table)
        schema["properties"] = {
            name: _schema(f"{where}.{name}", [table[name] for table in tables if name in table]) for name in fields
        }
        schema["required"] = [name for name in fields if all(name in table for table in tables)]
    lists = [value for value in some if isinstance(value, list)]
    if entries := [each for value in lists for each in value]:
        schema["items"] = _schema(f"{where}[]", entries)
    return schema


def _nested(parts: list[Any], where: str) -> dict[str, Any]:
    """Return the schema of the parts of a tree, which have parts."""
    for part in parts:  # grows as it goes
        parts += part.get("parts", ())
    schema = _schema(f"{where}[]", [{**part, "parts": []} if "parts" in part else part for part in parts])
    schema["properties"]["parts"] = {"$ref": "#/properties/parts"}
    return schema


_MAPS, _NULLS = set(NAMES.split()), set(NULLS.split())
_TYPES = {dict: "object", list: "array", str: "string", bool: "boolean", int: "integer", float: "number"}


def _text(schema: dict[str, Any]) -> str:
    """Return a schema as JSON, a line for each field of the document."""
    lines = [f"  {_json(name)}: {_json(each)}" for name, each in schema["properties"].items()]
    fields = "{\n" + ",\n".join(lines) + "\n }"
    return "{\n" + ",\n".join(
        f" {_json(name)}: {fields if name == 'properties' else _json(each)}" for name, each in schema.items()
    ) + "\n}\n"  # fmt: skip


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for kind, schema in schemas([document for _, document in documents()]).items():
        file = FOLDER / f"{kind.removeprefix('inertia/').replace('/', '-')}.schema.json"
        file.write_text(_text(schema), encoding="utf-8")
