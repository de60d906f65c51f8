"""Documents in TOML: how they are loaded, what their errors say, and that what is written reads the same."""

import copy
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from inertia import Job, Scene
from inertia.documents import Document, FieldError, nearest, number, numbers, require_known, toml_text
from inertia.errors import ReadError, UsageError
from inertia_meshes import path


@dataclass(frozen=True)
class Note(Document):
    """A document of one field, which must not be negative."""

    noun: ClassVar[str] = "note"
    version: ClassVar[int] = 3

    value: int
    folder: Path
    text: str | None
    name: str

    @classmethod
    def _from_table(cls, table: Mapping[str, Any], folder: Path, text: str | None, name: str) -> "Note":
        if table["value"] < 0:
            raise FieldError("value", "is negative")
        return cls(table["value"], folder, text, name)

    def to_dict(self) -> dict[str, Any]:
        return {"schema": self.version, "value": self.value}


def test_a_file_knows_its_folder_its_text_and_its_name(tmp_path: Path) -> None:
    file = tmp_path / "a.toml"
    file.write_bytes(b"\xef\xbb\xbfschema = 3\r\nvalue = 5\r\n")
    note = Note.load(file)
    assert (note.value, note.folder, note.name) == (5, tmp_path, str(file))
    assert note.text == "schema = 3\r\nvalue = 5\r\n"
    assert Note.loads(note.to_toml()) == Note(5, Path(), note.to_toml(), "the note")


def test_an_error_names_the_document(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=r"^cannot read .*b\.toml: there is no such file"):
        Note.load(tmp_path / "b.toml")
    with pytest.raises(ReadError, match=r"^cannot read the note: it is not TOML: "):
        Note.loads("value =")
    with pytest.raises(UsageError, match=r"^the note: schema is 2: this version reads schema = 3$"):
        Note.from_dict({"schema": 2, "value": 1})
    with pytest.raises(UsageError, match=r"^c\.toml: value is negative$"):
        Note.from_dict({"value": -1}, name="c.toml")
    (tmp_path / "d.toml").write_bytes(b"\xff\x00")
    with pytest.raises(ReadError, match="no text in UTF-8: a note is a TOML file"):
        Note.load(tmp_path / "d.toml")


def test_a_document_that_is_no_table_is_called_so() -> None:
    for table in (None, 5, "text", []):
        with pytest.raises(UsageError, match=r"^the note: .* is no table: give a dictionary laid out as the file is$"):
            Note.from_dict(table)


@pytest.mark.parametrize("place", [None, 5, {"value": 1}], ids=str)
def test_what_is_no_path_is_not_loaded(place: object) -> None:
    with pytest.raises(UsageError, match=r"^path is a \w+: give the path of a note file; from_dict takes a dictionary"):
        Note.load(place)


def test_a_name_in_another_encoding_is_called_so() -> None:
    with pytest.raises(UsageError, match=r'is "b\\udcff", with the byte 0xff: rename it in UTF-8$'):
        Note.from_dict({"schema": 3, "value": "b\udcff"})


def test_a_field_that_is_none_is_not_stated() -> None:
    body = {"principal_moments": [1, 2, 3], "mass": None}
    start = {"angular_velocity": [0, 0, 1], "attitude": None, "frame": None}
    run = {"duration": 1, "samples": None, "accuracy": None, "model": None}
    scene = Scene.from_dict({"body": body, "start": start, "run": run, "constraint": None, "load": None})
    assert (
        scene.to_toml()
        == Scene.from_dict(
            {"body": {"principal_moments": [1, 2, 3]}, "start": {"angular_velocity": [0, 0, 1]}, "run": {"duration": 1}}
        ).to_toml()
    )
    for section, field in (("start", "angular_velocity"), ("run", "duration")):
        table = {"body": body, "start": start, "run": run}
        table[section] = table[section] | {field: None}
        with pytest.raises(UsageError, match=rf"^the scene: {section}\.{field} is missing: it has to be given$"):
            Scene.from_dict(table)


def test_rows_of_json_leave_out_what_is_null() -> None:
    job = tomllib.loads(path("jobs/fan.toml").read_text(encoding="utf-8"))
    with_nulls = copy.deepcopy(job)
    for name in ("tolerance", "uncertainty", "report", "coefficients"):
        with_nulls.setdefault(name, None)
    for sensor in with_nulls["sensor"]:
        sensor |= {name: sensor.get(name) for name in ("importance", "floor", "runout")}
    for each in with_nulls["run"]:
        each |= {name: each.get(name) for name in ("weights", "indexed", "remark")}
    folder = path("jobs/fan.toml").parent
    assert Job.from_dict(with_nulls, folder).to_toml() == Job.from_dict(job, folder).to_toml()


def test_strings_and_figures_survive_toml() -> None:
    body = {"part": 'a "b"\\c\n\t\x7fé😀.stl', "x": 1e-300, "n": 3, "v": np.array([1.0, 1e22]), "flags": [True, False]}
    text = toml_text({"a b": 'say "x"\n\x7f', "body": body | {"mass": None}, "load": []})
    assert tomllib.loads(text) == {"a b": 'say "x"\n\x7f', "body": body | {"v": [1.0, 1e22]}}
    assert '"a b" = "say \\"x\\"\\n\\u007f"' in text


@pytest.mark.parametrize("value", [1e-320, 1e-61, 1e61, 1.7e308, 10**400])
def test_a_figure_out_of_all_proportion_is_refused(value: float) -> None:
    with pytest.raises(FieldError, match=r"^mass is 1.*: (its size must be between|it must be finite)"):
        number("kg", positive=True)(value, "mass")
    with pytest.raises(FieldError, match=r"^place.* is "):
        numbers((3,), "m")([0.0, value, 0.0], "place")
    with pytest.raises(FieldError, match=r"^radius is 1.*: (its size must be zero, or between|it must be finite)"):
        number("m", negative=False)(value, "radius")


def test_small_figures_beside_others_are_read() -> None:
    assert numbers((2,), "m")([1.0, 1e-320], "place").tolist() == [1.0, 1e-320]
    assert number("degrees")(-1e-100, "angle") == -1e-100
    assert number("m", negative=False)(0, "radius") == 0.0


@pytest.mark.parametrize(
    ("word", "meant"),
    [
        ("Mass", "mass"),
        ("accel", "acceleration"),
        ("rmp", "rpm"),
        ("velocity", None),
        ("position", None),
        ("place", None),
        ("ac", None),
        ("", None),
    ],
)
def test_a_name_is_suggested_where_it_is_misspelled_and_not_where_another_is_meant(
    word: str, meant: str | None
) -> None:
    known = ["mass", "acceleration", "action", "rpm", "angular_velocity", "position_uncertainty", "parent"]
    assert nearest(word, known) == meant


def test_an_unknown_key_is_refused_with_what_it_is_called_here_or_with_all_there_is() -> None:
    with pytest.raises(FieldError, match=r"^part\.Position is unknown: did you mean at\?$"):
        require_known({"Position": 1}, ["at", "position_uncertainty"], "part", {"position": "at"})
    with pytest.raises(FieldError, match=r"^part\.position is unknown: use at, position_uncertainty$"):
        require_known({"position": 1}, ["at", "position_uncertainty"], "part")
