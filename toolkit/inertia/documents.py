"""Documents in TOML: how a scene or a rotor is loaded and written, and the fields of its sections.

A `Document` comes from a file, from its text or from a dictionary of the same layout. A `Section` of it is a frozen
dataclass whose fields are annotated with a reader, which turns what the file, or the caller in Python, gave into what
the models use, and names the field's path where it cannot.
"""

from __future__ import annotations

import inspect
import math
import os
import re
import tomllib
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import MISSING, InitVar, field, fields
from difflib import get_close_matches
from fractions import Fraction
from numbers import Integral
from pathlib import Path
from typing import Any, ClassVar, Self, TypeVar, get_type_hints

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import of_rotation
from inertia.encoding import text_of
from inertia.errors import FieldPath, GeometryError, ReadError, UsageError, Word, placed, visible
from inertia.estimate import Estimate, float_of, is_number
from inertia.records import dataclass
from inertia.standard_input import file_of, reason_of

Read = Callable[[Any, str], Any]

SMALLEST, LARGEST = 1e-60, 1e60
"""The sizes that figures other than zero may have: what is made of them then stays within float64, in any SI unit."""

_ALIKE = 0.65
"""How alike two names are, as `difflib` counts, of which one may be a misspelling of the other."""

_UNIT = 4  # letters of the longest, "_rpm"

_COUNTS = {2: "two numbers", 3: "three numbers", 4: "four numbers"}


class FieldError(UsageError):
    """A field is not usable: its `path`, as ``start.angular_velocity[1]``, and what is the matter with it."""

    code = "field"

    def __init__(self, path: str, *says: Word) -> None:
        super().__init__(FieldPath(path), " ", *says)
        self.path = path

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.path, *self.words[2:])


@dataclass(frozen=True)
class Reader:
    """How a field is read, and the JSON Schema of what it may hold."""

    read: Read
    schema: Mapping[str, Any]

    def __call__(self, value: Any, path: str) -> Any:
        """Return the value as the models use it; raise `FieldError`."""
        return self.read(value, path)


@dataclass(frozen=True, eq=False)
class Section:
    """A section of a file: every field is read by its reader when the section is made; None is left as it is.

    `path` is what errors call the section: its name in the file, if nothing else is given. `_synonyms` are names that
    its fields may be looked for by, and what they are called here.
    """

    section: ClassVar[str]
    _synonyms: ClassVar[Mapping[str, str]] = {}
    path: InitVar[str | None] = field(default=None, kw_only=True)

    def __post_init__(self, path: str | None) -> None:
        where = self.section if path is None else path
        for name, read in readers(type(self)).items():
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, read(value, joined(where, name)))
        self.require_sense(where)

    def require_sense(self, path: str) -> None:
        """Raise `FieldError` where fields contradict each other; `path` is that of the section."""


S = TypeVar("S", bound=Section)


_READERS: dict[type[Section], dict[str, Read]] = {}
"""The readers of the sections that were made: to evaluate annotations takes longer than to make a section."""


def readers(kind: type[Section]) -> dict[str, Read]:
    """Return the reader of each field of a section."""
    if kind not in _READERS:
        hints = get_type_hints(kind, include_extras=True)
        _READERS[kind] = {each.name: hints[each.name].__metadata__[0] for each in fields(kind)}
    return _READERS[kind]


def joined(path: str, name: str) -> str:
    """Return the path of a field; that of the whole file is empty."""
    return f"{path}.{name}" if path else name


def section_of(kind: type[S], table: object, extra: Sequence[str] = (), path: str | None = None) -> S:
    """Make a section from a table of the file.

    Parameters
    ----------
    kind : the section's class
    table : what the file has there
    extra : keys that are known too, but are the caller's
    path : what errors call the section, if not by its name
    """
    where = kind.section if path is None else path
    known = {each.name: each.default is MISSING for each in fields(kind)}
    entries = table_of(table, where)
    require_known(entries, [*known, *extra], where, kind._synonyms)
    for name, required in known.items():
        if required and name not in entries:
            raise FieldError(joined(where, name), "is missing: it has to be given")
    return kind(**{name: value for name, value in entries.items() if name in known}, path=where)


def table_of(value: object, path: str) -> Mapping[str, Any]:
    """Return a table of the file as it is."""
    if not isinstance(value, Mapping):
        if not path:
            raise UsageError(f"{short_repr(value)} is no table: give a dictionary laid out as the file is")
        name = re.sub(r"\[\d+\]", "", path)
        header = f"[[{name}]]" if path.endswith("]") else f"[{name}]"
        raise FieldError(path, f"is {short_repr(value)}: it must be a table, as in {header}")
    return value


def require_known(
    table: Mapping[str, Any], known: Sequence[str], path: str, synonyms: Mapping[str, str] | None = None
) -> None:
    """Refuse a key that is none of `known`, naming the one that it is a synonym or a misspelling of."""
    for key in table:
        if key not in known:
            meant = (synonyms or {}).get(str(key).lower()) or nearest(str(key), known)
            hint = f"use {', '.join(known)}" if meant is None else f"did you mean {meant}?"
            raise FieldError(joined(path, str(key)), f"is unknown: {hint}")


def nearest(word: str, known: Iterable[str]) -> str | None:
    """Return the name of which a word is a misspelling, or the only one that begins so; None where neither is sure.

    A name with further words, as "angle_uncertainty" beside "angle", is that of something else, but for a unit behind
    it. Misspellings begin with the right letter.

    >>> names = ["angle_uncertainty", "at", "region", "density", "mass_g"]
    >>> [nearest(word, names) for word in ("densty", "dens", "mass", "angle", "origin")]
    ['density', 'density', 'mass_g', None, None]
    """
    lower = word.lower()
    names = {name.lower(): name for name in known if name[:1].lower() == lower[:1]}
    alike = [name for name in names if f"_{lower}_" not in f"_{name}_" or len(name) <= len(lower) + _UNIT]
    begun = [name for name in alike if name.startswith(lower)]
    close = get_close_matches(lower, alike, n=1, cutoff=_ALIKE) or (begun if len(begun) == 1 else [])
    return names[close[0]] if close else None


class Document(ABC):
    """What a TOML file describes; `noun` is what its files and its errors call it, `version` that of its layout."""

    noun: ClassVar[str]
    version: ClassVar[int] = 1

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a file, `-` for standard input; the files that it names are looked for beside it.

        Raises `ReadError`, `UsageError`.
        """
        article = "an" if cls.noun[0] in "aeio" else "a"
        try:
            name = os.fspath(path)
        except TypeError:
            raise UsageError(
                f"path is a {type(path).__name__}: give the path of {article} {cls.noun} file; from_dict takes a "
                "dictionary, loads takes text"
            ) from None
        is_table = name.lower().endswith(".csv")
        try:
            text = text_of(
                file_of(name).read_bytes(),
                "save the table as CSV in UTF-8" if is_table else f"{article} {cls.noun} is a TOML file in UTF-8",
            )
        except ReadError as error:
            raise placed(error, f"cannot read {name}") from None
        except OSError as error:
            raise ReadError(f"cannot read {name}: {reason_of(error)}", code="no_file") from None
        if not text.strip():
            raise ReadError(f"cannot read {name}: it is empty: write {article} {cls.noun} into it", code="empty_file")
        return cls.loads(text, Path(path).parent, name)

    @classmethod
    def loads(cls, text: str, folder: str | os.PathLike[str] = ".", name: str | None = None) -> Self:
        """Read the text of a file; the files that it names are in `folder`, and errors call it `name`."""
        called = name or f"the {cls.noun}"
        try:
            table = toml_table(text)
        except ReadError as error:
            raise placed(error, f"cannot read {called}") from None
        return cls.from_dict(table, folder, text=text, name=called)

    @classmethod
    def from_dict(
        cls,
        table: Mapping[str, Any],
        folder: str | os.PathLike[str] = ".",
        *,
        text: str | None = None,
        name: str | None = None,
    ) -> Self:
        """Make it from a dictionary laid out as the file is.

        Parameters
        ----------
        table : the dictionary; a field that is None counts as not stated
        folder : where the files are that it names
        text : the file as it was read
        name : what errors call it; "the scene", "the rotor" without one
        """
        called = name or f"the {cls.noun}"
        try:
            layout_version(cls.version)(table_of(table, "").get("schema", cls.version), "schema")
            if not _is_printable(table):  # as most are, which need no closer look
                _require_printable(table, "")
                table = _without_unstated(table)
            return cls._from_table(table, Path(folder), text, called)
        except (UsageError, GeometryError) as error:
            raise placed(error, called) from None

    @abstractmethod
    def to_dict(self) -> dict[str, Any]:
        """Return a dictionary laid out as the file is; what is at its default may be left out."""

    def to_toml(self) -> str:
        """Return the text of a file that says the same."""
        return toml_text(self.to_dict())

    @classmethod
    @abstractmethod
    def _from_table(cls, table: Mapping[str, Any], folder: Path, text: str | None, name: str) -> Self:
        """Make it from a dictionary whose version is right; errors need not name the document."""


def _is_printable(value: object) -> bool:
    """Whether no text in a table needs to be looked at; most take no more time than this."""
    kind = type(value)
    if kind is str:
        return value.isprintable()  # type: ignore[attr-defined, no-any-return]
    if kind is dict:
        entries = value.items()  # type: ignore[attr-defined]
        return all(type(key) is str and key.isprintable() and _is_printable(entry) for key, entry in entries)
    if kind is list:
        return all(type(entry) is float or _is_printable(entry) for entry in value)  # type: ignore[attr-defined]
    return kind is float or kind is int or kind is bool


def _require_printable(value: object, path: str) -> None:
    """Refuse what steers a terminal or turns text round, in names and in what they hold."""
    if _is_printable(value):
        return
    if isinstance(value, str) and (shown := visible(value)) != value:
        culprit = ord(next(one for one in value if visible(one) != one))
        if 0xDC80 <= culprit <= 0xDCFF:  # what Python makes of bytes of a file's name that are no UTF-8
            raise FieldError(path, f'is "{shown}", with the byte 0x{culprit - 0xDC00:02x}: rename it in UTF-8')
        raise FieldError(path, f'is "{shown}": leave out the control character U+{culprit:04X}')
    if isinstance(value, Mapping):
        for key, entry in value.items():
            where = joined(path, str(key))
            _require_printable(str(key), where)
            _require_printable(entry, where)
    elif isinstance(value, list | tuple):
        for k, entry in enumerate(value):
            _require_printable(entry, f"{path}[{k}]")


def _without_unstated(value: Any) -> Any:
    """Return tables, and lists of them, without the fields that are None, as rows of JSON or of a frame have them."""
    if isinstance(value, Mapping):
        return {key: _without_unstated(entry) for key, entry in value.items() if entry is not None}
    return [_without_unstated(entry) for entry in value] if isinstance(value, list | tuple) else value


def toml_table(text: str) -> dict[str, Any]:
    """Return what a text in TOML says; raise `ReadError` where it is none, or has too much within one another."""
    try:
        return tomllib.loads(text.replace("\r\n", "\n"))
    except tomllib.TOMLDecodeError as error:
        sentence = str(error)
        raise ReadError(f"it is not TOML: {sentence[:1].lower()}{sentence[1:]}", code="not_toml") from None
    except RecursionError:
        raise ReadError("its lists or tables are nested too deeply: write them as the documentation has them") from None


def toml_text(table: Mapping[str, Any]) -> str:
    """Return a dictionary of sections, fields and lists of sections as TOML; what is None or empty is left out.

    >>> print(toml_text({"schema": 1, "body": {"part": "a.stl", "mass": None}, "load": []}))
    schema = 1
    <BLANKLINE>
    [body]
    part = "a.stl"
    <BLANKLINE>
    """
    import tomli_w

    text = tomli_w.dumps({key: value for key, value in plain(table).items() if value not in ({}, [])})
    return "\n".join(map(visible, text.split("\n")))


def number(unit: str, *, positive: bool = False, negative: bool = True, below: float = math.inf) -> Reader:
    """Read a number of some unit: any, none below zero, or positive only; and less than `below`.

    It is at most `LARGEST` in size, and where it cannot be negative, it is zero or at least `SMALLEST`.
    """
    finite = finite_number(unit)
    expected = f"a number of {unit}" if unit else "a number"

    def read(value: Any, path: str) -> float:
        figure: float = finite(value, path)
        if positive and figure <= 0:
            raise FieldError(path, f"is {short_repr(value)}: it must be positive, {expected}")
        if not negative and figure < 0:
            raise FieldError(path, f"is {short_repr(value)}: it must not be negative, {expected}")
        if figure >= below:
            raise FieldError(path, f"is {short_repr(value)}: it must be below {below:g}, {expected}")
        if abs(figure) > LARGEST or ((positive or not negative) and 0 < figure < SMALLEST):
            raise _out_of_proportion(path, value, zero=not positive)
        return figure

    schema: dict[str, Any] = {"type": "number"}
    if positive:
        schema["exclusiveMinimum"] = 0
    elif not negative:
        schema["minimum"] = 0
    if below < math.inf:
        schema["exclusiveMaximum"] = below
    return Reader(read, schema)


def estimate(unit: str) -> Reader:
    """Read a positive number of some unit, or text of it with its standard uncertainty, as ``"7850±50"``."""
    single = number(unit, positive=True)

    def read(value: Any, path: str) -> float:
        if isinstance(value, str):
            try:
                value = Estimate.parse(value)
            except UsageError as error:
                raise FieldError(path, "is no number: ", error.sentence) from None
        estimated = isinstance(value, Estimate)
        figure: float = single(float(value) if estimated else value, path)
        return value if estimated else figure

    return Reader(read, {"oneOf": [single.schema, {"type": "string", "pattern": "±|\\+/?-"}]})


def finite_number(unit: str) -> Reader:
    """Read a finite number of some unit, of any size."""

    def read(value: Any, path: str) -> float:
        if not is_number(value):
            raise FieldError(path, f"is {short_repr(value)}: it must be a number" + (f" of {unit}" if unit else ""))
        figure = float_of(value)
        if not math.isfinite(figure):
            raise FieldError(path, f"is {short_repr(value)}: it must be finite")
        return figure

    return Reader(read, {"type": "number"})


def _out_of_proportion(path: str, value: Any, *, zero: bool = True) -> FieldError:
    sizes = f"{'zero, or ' if zero else ''}between {SMALLEST:g} and {LARGEST:g}"
    return FieldError(path, f"is {short_repr(value)}: its size must be {sizes}: check its unit")


def layout_version(version: int) -> Reader:
    """Read the version of a file's layout, which has to be this one."""

    def read(value: Any, path: str) -> int:
        if value != version or isinstance(value, bool):
            raise FieldError(path, f"is {value!r}: this version reads schema = {version}")
        return version

    return Reader(read, {"const": version})


def integer(least: int, most: int) -> Reader:
    """Read a whole number within bounds."""

    def read(value: Any, path: str) -> int:
        if isinstance(value, bool) or not isinstance(value, Integral):
            raise FieldError(path, f"is {short_repr(value)}: it must be a whole number")
        whole = int(value)
        if not least <= whole <= most:
            raise FieldError(path, f"is {short_repr(whole)}: it must be between {least} and {most}")
        return whole

    return Reader(read, {"type": "integer", "minimum": least, "maximum": most})


def are_in_proportion(value: object, count: int) -> bool:
    """Whether a value is a list of so many numbers, all zero or the largest of them between the limits of size."""
    if type(value) is not list or len(value) != count:
        return False
    if not all((type(k) is float and k == k) or type(k) is int for k in value):
        return False
    largest = max(map(abs, value))
    return bool(largest == 0 or SMALLEST <= largest <= LARGEST)


def numbers(shape: tuple[int, ...], unit: str) -> Reader:
    """Read an array of finite numbers of this shape; an entry that is none is named by its index.

    All are zero, or the size of the largest is between `SMALLEST` and `LARGEST`.
    """
    single = finite_number(unit)
    (count,) = shape if len(shape) == 1 else (0,)
    expected = f"{_COUNTS[shape[-1]]}" if len(shape) == 1 else f"{shape[0]} rows of {_COUNTS[shape[1]]}"
    expected += f", {unit}" if unit else ""

    def read(value: Any, path: str) -> NDArray[np.float64]:
        value = of_rotation(value, shape[-1])
        if count and are_in_proportion(value, count):
            plain = np.array(value, np.float64)
            plain.setflags(write=False)
            return plain
        nested = value.tolist() if isinstance(value, np.ndarray) else value

        def entries(part: Any, lengths: tuple[int, ...], where: str) -> Any:
            if not lengths:
                return single(part, where)
            if not isinstance(part, Sequence) or isinstance(part, str):
                raise FieldError(where, f"is {short_repr(part)}: ", FieldPath(path), f" must be {expected}")
            if len(part) != lengths[0]:
                says = f"has {len(part)} entries, not {lengths[0]}: "
                raise FieldError(where, says, FieldPath(path), f" must be {expected}")
            return [entries(one, lengths[1:], f"{where}[{k}]") for k, one in enumerate(part)]

        array = np.array(entries(nested, shape, path), dtype=np.float64)
        if array.any() and not SMALLEST <= np.abs(array).max() <= LARGEST:
            raise _out_of_proportion(path, nested)
        array.setflags(write=False)
        return array

    schema: dict[str, Any] = {"type": "number"}
    for length in reversed(shape):
        schema = {"type": "array", "items": schema, "minItems": length, "maxItems": length}
    return Reader(read, schema)


def choice(*options: str) -> Reader:
    """Read one of several words."""

    def read(value: Any, path: str) -> str:
        if isinstance(value, str) and value in options:
            return value
        meant = nearest(value, options) if isinstance(value, str) else None
        hint = "" if meant is None else f"; did you mean {meant!r}?"
        raise FieldError(path, f"is {short_repr(value)}: use one of {', '.join(map(repr, options))}{hint}")

    return Reader(read, {"enum": list(options)})


def rows_of(frame: Any) -> Any:
    """Return the rows of a data frame (pandas, polars) as tables without the cells that are empty; else what it is."""
    if hasattr(frame, "to_dicts"):
        rows = frame.to_dicts()
    elif hasattr(frame, "to_dict") and hasattr(frame, "columns"):
        rows = frame.to_dict("records")
    else:
        return frame
    return [{str(name): cell for name, cell in row.items() if not _is_empty(cell)} for row in rows]


def _is_empty(cell: Any) -> bool:
    return cell is None or type(cell).__name__ in ("NAType", "NaTType") or (isinstance(cell, float) and cell != cell)


def _text(value: Any, path: str) -> str:
    if not isinstance(value, str) or not value.strip():
        some = " that is not empty" if isinstance(value, str) else ""
        raise FieldError(path, f"is {short_repr(value)}: it must be text{some}")
    return value


text = Reader(_text, {"type": "string", "minLength": 1})
"""Read some text."""


def _flag(value: Any, path: str) -> bool:
    if not isinstance(value, bool):
        raise FieldError(path, f"is {short_repr(value)}: it must be true or false")
    return value


flag = Reader(_flag, {"type": "boolean"})
"""Read true or false."""


def several(single: Reader, *, least: int = 1) -> Reader:
    """Read a list of at least so many entries; each is named by its index."""

    def read(value: Any, path: str) -> tuple[Any, ...]:
        value = rows_of(value)
        if not isinstance(value, Sequence) or isinstance(value, str):
            raise FieldError(path, f"is {short_repr(value)}: it must be a list")
        if len(value) < least:
            raise FieldError(path, f"has {len(value)} entries: give at least {least}")
        return tuple(single(one, f"{path}[{k}]") for k, one in enumerate(value))

    return Reader(read, {"type": "array", "items": single.schema, "minItems": least})


def table(kind: type[S]) -> Reader:
    """Read a section within the file, or take one that was made."""

    def read(value: Any, path: str) -> S:
        return value if isinstance(value, kind) else section_of(kind, value, path=path)

    return Reader(read, schema_of(kind))


def tables(kind: type[S], *, least: int = 0) -> Reader:
    """Read the sections of a list of tables, ``[[name]]``."""
    entries = several(table(kind), least=least)

    def read(value: Any, path: str) -> tuple[S, ...]:
        if isinstance(value, Mapping):
            raise FieldError(path, f"must be a list of tables: write [[{path}]] in double brackets")
        sections: tuple[S, ...] = entries(value, path)
        return sections

    return Reader(read, entries.schema)


def document_schema(kind: type[Section], title: str) -> dict[str, Any]:
    """Return the JSON Schema of a file whose sections are the fields of `kind`."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": title, **schema_of(kind)}


def schema_of(kind: type[Section]) -> dict[str, Any]:
    """Return the JSON Schema of a section; what the fields are is told as the class's docstring has it."""
    descriptions = _descriptions(kind)
    properties = {}
    for name, read in readers(kind).items():
        schema = dict(read.schema) if isinstance(read, Reader) else {}
        properties[name] = schema | ({"description": descriptions[name]} if name in descriptions else {})
    required = [each.name for each in fields(kind) if each.default is MISSING]
    return {"type": "object", "additionalProperties": False, "properties": properties, "required": required}


def _descriptions(kind: type[Section]) -> dict[str, str]:
    """Return what the list of attributes in a docstring says of each."""
    descriptions: dict[str, str] = {}
    names: list[str] = []
    for line in (inspect.getdoc(kind) or "").partition("----------\n")[2].splitlines():
        if not line.strip():
            break
        if line.startswith(" "):  # a line that goes on
            descriptions |= {name: f"{descriptions[name]} {line.strip()}" for name in names}
            continue
        listing, _, description = line.strip().partition(" : ")
        names = listing.split(", ")
        descriptions |= dict.fromkeys(names, description)
    return descriptions


def plain(value: Any) -> Any:
    """Return a section, or a field, as a file would hold it: fields that are at their default are left out."""
    if isinstance(value, Section):
        entries = {each.name: (getattr(value, each.name), each.default) for each in fields(value)}
        return {
            name: plain(entry)
            for name, (entry, default) in entries.items()
            if entry is not None and (default is MISSING or plain(entry) != plain(default))
        }
    if isinstance(value, Mapping):
        return {key: plain(one) for key, one in value.items() if one is not None}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Fraction):
        return float(value) if float(value) == value else str(value)
    if isinstance(value, Estimate):
        return f"{value}±{value.uncertainty}" if value.uncertainty else float(value)
    return [plain(one) for one in value] if isinstance(value, tuple | list) else value


def short_repr(value: object) -> str:
    """Return a value as a message may quote it: short."""
    quoted = repr(value)
    return quoted if len(quoted) <= 40 else f"{quoted[:37]}..."
