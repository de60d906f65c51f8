"""Mended mass properties written into a robot's file: its bytes stay as they are but for the tags that change.

An element that changes has a comment before it that says why. Works on URDF and MJCF.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple
from xml.parsers import expat

from inertia.errors import ReadError, UsageError, visible
from inertia.exchange.robots.links import Robot
from inertia.exchange.writing import number, numbers, printable
from inertia.mass.properties import MassProperties


class Mended(NamedTuple):
    """What a link should state, why in a sentence, and whether the centre of mass may stay as it is written."""

    properties: MassProperties
    reason: str
    center_agrees: bool = False


@dataclass
class _Tag:
    """An element of a file: its name, attributes, the bytes of its start tag, and its children."""

    name: str
    attributes: dict[str, str]
    start: int
    end: int = 0
    children: list[_Tag] = field(default_factory=list)

    def child(self, name: str) -> _Tag | None:
        return next((each for each in self.children if each.name == name), None)


class _Edit(NamedTuple):
    """Bytes `start` to `end` of a file are replaced."""

    start: int
    end: int
    text: str


def mend(robot: Robot, mended: Mapping[str, Mended]) -> bytes:
    """Return a robot's file with the mass properties of some links mended, by their names.

    Raises `UsageError` where the format cannot be written into, and `ReadError` where the file is no longer that robot.
    """
    data = robot.path.read_bytes()
    if robot.format not in _FORMATS:
        raise UsageError(f"files of format {robot.format} are not written into: mend {robot.path} by hand")
    link_tag, edits_of = _FORMATS[robot.format]
    edits: list[_Edit] = []
    done: set[str] = set()
    for tag in _all(_tags(data)):
        name = visible(tag.attributes.get("name", ""))
        inertial = tag.child("inertial")
        if tag.name == link_tag and name in mended and name not in done and inertial is not None:
            done.add(name)
            indent = _indent(data, inertial.start)
            edits += edits_of(data, inertial, mended[name], indent)
    if missing := sorted(set(mended) - done):
        raise ReadError(f"{robot.path} states nothing of {missing[0]!r} itself: mend the file that it includes")
    for edit in sorted(edits, reverse=True):
        data = data[: edit.start] + edit.text.encode() + data[edit.end :]
    return data


def _urdf(data: bytes, inertial: _Tag, mended: Mended, indent: str) -> list[_Edit]:
    properties = mended.properties
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = properties.inertia.tolist()
    values = zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), (xx, xy, xz, yy, yz, zz), strict=True)
    tags = {
        "origin": f'<origin xyz="{numbers(properties.center_of_mass.tolist())}" rpy="0 0 0"/>',
        "mass": f'<mass value="{number(properties.mass)}"/>',
        "inertia": "<inertia " + " ".join(f'{key}="{number(value)}"' for key, value in values) + "/>",
    }
    edits = [_comment(inertial, mended, indent)]
    for name, text in tags.items():
        tag = inertial.child(name)
        if tag is None:
            edits.append(_Edit(inertial.end, inertial.end, f"\n{indent}  {text}"))
        elif name == "origin" and mended.center_agrees and not any(map(float, tag.attributes.get("rpy", "").split())):
            continue
        elif name != "mass" or float(tag.attributes.get("value", "nan")) != properties.mass:
            edits.append(_Edit(tag.start, tag.end, _closed_alike(data, tag, text)))
    return edits


def _mjcf(data: bytes, inertial: _Tag, mended: Mended, indent: str) -> list[_Edit]:
    properties = mended.properties
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = properties.inertia.tolist()
    text = (
        f'<inertial pos="{numbers(properties.center_of_mass.tolist())}" mass="{number(properties.mass)}" '
        f'fullinertia="{numbers((xx, yy, zz, xy, xz, yz))}"/>'
    )
    return [
        _comment(inertial, mended, indent),
        _Edit(inertial.start, inertial.end, _closed_alike(data, inertial, text)),
    ]


_FORMATS = {"urdf": ("link", _urdf), "mjcf": ("body", _mjcf)}


def _comment(inertial: _Tag, mended: Mended, indent: str) -> _Edit:
    return _Edit(inertial.start, inertial.start, f"<!-- mended: {printable(mended.reason)} -->\n{indent}")


def _closed_alike(data: bytes, tag: _Tag, text: str) -> str:
    """Return an empty element's tag as it was: closed in itself, or by an end tag that stays where it is."""
    return text if data[tag.start : tag.end].endswith(b"/>") else text.removesuffix("/>") + ">"


def _indent(data: bytes, start: int) -> str:
    line = data[data.rfind(b"\n", 0, start) + 1 : start]
    return line.decode("ascii", "ignore") if not line.strip() else ""


_START_TAG = re.compile(rb"""<[^\s/>]+(?:[^>"']|"[^"]*"|'[^']*')*>""")


def _tags(data: bytes) -> _Tag:
    """Return the elements of an XML text, each with the place of its start tag in bytes."""
    root = _Tag("", {}, 0)
    stack = [root]
    parser = expat.ParserCreate()
    lead = len(data) - len(data.lstrip())

    def start(name: str, attributes: dict[str, str]) -> None:
        place = parser.CurrentByteIndex + lead
        match = _START_TAG.match(data, place)
        if match is None:
            raise ReadError("its encoding is not one of ASCII, UTF-8 and Latin-1: mend it by hand")
        tag = _Tag(name.rpartition(":")[2], attributes, place, match.end())
        stack[-1].children.append(tag)
        stack.append(tag)

    def end(_name: str) -> None:
        stack.pop()

    parser.StartElementHandler, parser.EndElementHandler = start, end
    try:
        parser.Parse(data[lead:], True)
    except expat.ExpatError as error:
        raise ReadError(f"its XML is damaged ({error}): export it again") from None
    return root


def _all(tag: _Tag) -> list[_Tag]:
    every, stack = [], [tag]
    while stack:
        tag = stack.pop()
        every.append(tag)
        stack.extend(reversed(tag.children))
    return every
