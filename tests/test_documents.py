"""Dictionaries as TOML text: read back, they say the same."""

import tomllib

import numpy as np

from inertia.documents import toml_text


def test_strings_and_figures_survive_toml() -> None:
    body = {"part": 'a "b"\\c\n\t\x7fé😀.stl', "x": 1e-300, "n": 3, "v": np.array([1.0, 1e22]), "flags": [True, False]}
    text = toml_text({"a b": 'say "x"\n\x7f', "body": body | {"mass": None}, "load": []})
    assert tomllib.loads(text) == {"a b": 'say "x"\n\x7f', "body": body | {"v": [1.0, 1e22]}}
    assert '"a b" = "say \\"x\\"\\n\\u007f"' in text
