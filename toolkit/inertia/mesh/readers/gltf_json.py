"""The JSON of a glTF file: its objects by their places in it, each property of the kind that the format has there.

What stands at a place and may not is refused by that place, as ``meshes[0].primitives[2].indices``; what is never asked
for is not looked at. Source: Khronos, "glTF 2.0 Specification", 2021, § 5.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any, TypeVar

from inertia.errors import ReadError
from inertia.mesh.readers.contents import shown


class Written(float):
    """A number of the JSON, with the decimal that the file writes."""

    def __new__(cls, text: str) -> Written:  # noqa: D102
        number = super().__new__(cls, text)
        number.text = text
        return number

    text: str


T = TypeVar("T")

_NUMBERS = frozenset((int, float, Written))
_MISSING: Any = object()


class JsonObject:
    """An object of the JSON: `place` is where it stands, empty for the whole."""

    __slots__ = ("_fields", "place")

    def __init__(self, value: object, place: str) -> None:
        if type(value) is not dict:
            raise _fault(value, place, "an object")
        self._fields, self.place = value, place

    def __contains__(self, name: str) -> bool:
        return name in self._fields

    def where(self, name: str) -> str:
        """Return the place of a property."""
        return f"{self.place}.{name}" if self.place else name

    def label(self, name: str = "name") -> str | None:
        """Return a name, or whatever stands there, as text; None where there is none."""
        label = self._fields.get(name)
        return None if label is None else str(label)

    def text(self, name: str) -> str:
        """Return text that has to be there."""
        return self._of(name, str, "text", _MISSING)  # type: ignore[no-any-return]

    def choice(self, name: str, known: Mapping[Any, T], default: object = _MISSING) -> T:
        """Return what one of some known values stands for."""
        value = self._fields.get(name, default)
        if not isinstance(value, str | int | float) or isinstance(value, bool) or value not in known:
            raise _fault(value, self.where(name), f"one of {', '.join(map(str, known))}")
        return known[value]

    def whole(self, name: str, default: int = _MISSING) -> int:
        """Return a whole number that is not negative."""
        return _whole(self._fields.get(name, default), self.where(name))

    def wholes(self, name: str) -> list[int]:
        """Return a list of such numbers, empty where there is none."""
        values = self._of(name, list, "a list of whole numbers", [])
        return [_whole(value, f"{self.where(name)}[{k}]") for k, value in enumerate(values)]

    def numbers(self, name: str, count: int) -> list[float] | None:
        """Return so many finite numbers, None where there are none."""
        values = self._fields.get(name)
        if values is None and name not in self._fields:
            return None
        if type(values) is not list or len(values) != count:
            raise _fault(values, self.where(name), f"{count} numbers")
        for k, value in enumerate(values):
            if type(value) not in _NUMBERS or not _is_finite(value):
                raise _fault(value, f"{self.where(name)}[{k}]", "a finite number")
        return values

    def entries(self, name: str, default: Any = _MISSING) -> list[Any]:
        """Return a list of anything."""
        return self._of(name, list, "a list", default)  # type: ignore[no-any-return]

    def object(self, name: str, default: Any = _MISSING) -> JsonObject:
        """Return the object that a property is."""
        return JsonObject(self._of(name, dict, "an object", default), self.where(name))

    def objects(self, name: str, default: Any = _MISSING) -> list[JsonObject]:
        """Return the objects in a list."""
        return [JsonObject(one, f"{self.where(name)}[{k}]") for k, one in enumerate(self.entries(name, default))]

    def _of(self, name: str, kind: type, says: str, default: Any) -> Any:
        value = self._fields.get(name, default)
        if value is _MISSING or not isinstance(value, kind):
            raise _fault(value, self.where(name), says)
        return value


def parse(text: bytes) -> JsonObject:
    """Return the object that a file is, whose numbers know how they are written; raise `ReadError` where it is none."""
    try:
        return JsonObject(json.loads(text, parse_float=Written), "")
    except json.JSONDecodeError as error:
        reason = f"line {error.lineno}, column {error.colno}: {error.msg[:1].lower()}{error.msg[1:]}"
    except UnicodeDecodeError as error:
        raise ReadError(f"its JSON is not UTF-8 at byte {error.start}: export it again", code="encoding") from None
    except RecursionError:
        reason = "its objects are nested too deeply"
    except ReadError:
        raise
    except ValueError:  # the one that Python has for whole numbers of more digits than it reads
        reason = "a number in it has more digits than any length"
    raise ReadError(f"it is not JSON, as glTF is ({reason}): export it again")


def _whole(value: object, place: str) -> int:
    if type(value) is not int or value < 0:
        raise _fault(value, place, "a whole number that is not negative")
    return value


def _is_finite(value: float) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def _fault(value: object, place: str, says: str) -> ReadError:
    if value is _MISSING:
        return ReadError(f"its JSON has no {place}, where {says} must stand: export it again")
    if isinstance(value, dict | list):
        has = "an object" if isinstance(value, dict) else f"a list of {len(value)}"
    else:
        has = shown(value) if isinstance(value, str) else json.dumps(value)[:40]
    return ReadError(f"its JSON has {has} as {place or 'a whole'}, where {says} must stand: export it again")
