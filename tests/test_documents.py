"""Documents in TOML: how they are loaded, what their errors say, and that what is written reads the same."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from inertia.documents import Document, FieldError, nearest, number, numbers, require_known, toml_text
from inertia.errors import ReadError, UsageError


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
