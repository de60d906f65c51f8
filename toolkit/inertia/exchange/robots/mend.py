"""Mended mass properties written into a robot's file: its bytes stay as they are but for the tags that change.

An element that changes has a comment before it that says why. Works on URDF, MJCF and SDFormat.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import field
from typing import NamedTuple
from xml.parsers import expat

from inertia.errors import ReadError, UsageError, visible
from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.robots.links import Robot
from inertia.exchange.writing import hyphens_apart, number, numbers, printable
from inertia.mass.properties import MassProperties
from inertia.records import dataclass
from inertia.standard_input import file_of


class Mended(NamedTuple):
    """What a link should state, why in a sentence, and whether the centre of mass may stay as it is written."""

    properties: MassProperties
    reason: str
    center_agrees: bool = False


@dataclass
class _Tag:
    """An element of a file: its name, attributes, the bytes of its start tag, where its end tag is, its children."""

    name: str
    attributes: dict[str, str]
    start: int
    end: int = 0
    close: int = 0
    children: list[_Tag] = field(default_factory=list)

    def child(self, name: str) -> _Tag | None:
        return next((each for each in self.children if each.name == name), None)


class _Edit(NamedTuple):
    """Bytes `start` to `end` of a file are replaced."""

    start: int
    end: int
    text: str


def mend(robot: Robot, mended: Mapping[str, Mended]) -> tuple[bytes, dict[str, str]]:
    """Return a robot's file with the mass properties of some links mended, by their names; and why others stay.

    Raises `UsageError` where the format cannot be written into.
    """
    data = file_of(str(robot.path)).read_bytes()
    if robot.format not in _FORMATS:
        raise UsageError(f"files of format {robot.format} are not written into: mend {robot.path} by hand")
    link_tag, edits_of = _FORMATS[robot.format]
    edits: list[_Edit] = []
    done: set[str] = set()
    elsewhere: set[str] = set()
    only_model = f"{robot.name}::" if robot.name else ""  # its name is none of the links'
    for tag, scope in _all(_tags(data)):
        name = visible(f"{scope}{tag.attributes.get('name', '')}").removeprefix(only_model)
        inertial = tag.child("inertial")
        if tag.name != link_tag or name not in mended or name in done:
            continue
        if inertial is None:
            elsewhere.add(name)
        else:
            done.add(name)
            indent = _indent(data, inertial.start)
            edits += edits_of(data, inertial, mended[name], indent)
    frame = "its <inertial> stands in a <frame>: mend it there"
    included = f"no <{link_tag}> of that name stands in the file itself, but in one that it includes: mend it there"
    left = {name: frame if name in elsewhere else included for name in mended if name not in done}
    line_end = b"\r\n" if b"\r\n" in data else b"\n"
    for edit in sorted(edits, reverse=True):
        data = data[: edit.start] + edit.text.encode().replace(b"\n", line_end) + data[edit.end :]
    return data, left


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
        elif name == "origin" and mended.center_agrees and _is_unturned_origin(tag):
            continue
        elif name != "mass" or _figures(tag.attributes.get("value", "")) != [properties.mass]:
            edits.append(_Edit(tag.start, tag.end, _closed_alike(data, tag, text)))
    return edits


def _is_unturned_origin(tag: _Tag) -> bool:
    """Whether the origin of an inertial is three numbers, and its angles are zero or not written."""
    if tag.attributes.keys() - {"xyz", "rpy"}:
        return False
    place, angles = (_figures(tag.attributes.get(key, "0 0 0")) for key in ("xyz", "rpy"))
    return place is not None and len(place) == 3 and angles == [0.0] * 3


def _figures(text: str) -> list[float] | None:
    """Return the numbers in a text; None where one of them is none."""
    try:
        return [float(word) for word in text.split()]
    except ValueError:
        return None


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


def _sdf(data: bytes, inertial: _Tag, mended: Mended, indent: str) -> list[_Edit]:
    properties = mended.properties
    edits = [_comment(inertial, mended, indent)]
    pose, mass, inertia = (inertial.child(name) for name in ("pose", "mass", "inertia"))
    elements = zip(_SDF.order, _SDF.elements(properties.inertia), strict=True)
    if not (mended.center_agrees and _is_unturned(data, pose)):
        place = f"{numbers(properties.center_of_mass.tolist())} 0 0 0"
        edits.append(_said(inertial, pose, "pose", place, indent, data))
    if mass is None or float(_text(data, mass)) != properties.mass:
        edits.append(_said(inertial, mass, "mass", number(properties.mass), indent, data))
    if inertia is None or inertia.close <= inertia.end:
        text = "".join(f"<i{pair}>{number(value)}</i{pair}>" for pair, value in elements)
        edits.append(_said(inertial, inertia, "inertia", text, indent, data))
    else:
        edits += [
            _said(inertia, inertia.child(f"i{pair}"), f"i{pair}", number(value), f"{indent}  ", data)
            for pair, value in elements
        ]
    return edits


def _is_unturned(data: bytes, pose: _Tag | None) -> bool:
    """Whether a pose of an inertial is none, or a shift alone as it is usually written."""
    if pose is None:
        return True
    return not pose.attributes and not any(map(float, _text(data, pose).split()[3:]))


def _said(parent: _Tag, tag: _Tag | None, name: str, text: str, indent: str, data: bytes) -> _Edit:
    """Return the edit after which an element holds a text; where there is none yet, it comes first in its parent."""
    if tag is None:
        return _Edit(parent.end, parent.end, f"\n{indent}  <{name}>{text}</{name}>")
    if tag.attributes or tag.close <= tag.end:  # a format of its own, or closed in itself
        end = data.index(b">", tag.close) + 1 if tag.close > tag.end else tag.end
        return _Edit(tag.start, end, f"<{name}>{text}</{name}>")
    return _Edit(tag.end, tag.close, text)


def _text(data: bytes, tag: _Tag) -> str:
    return re.sub(r"(?s)<!--.*?-->", "", data[tag.end : max(tag.end, tag.close)].decode())


_SDF = CONVENTIONS["sdf"]
_FORMATS = {"urdf": ("link", _urdf), "mjcf": ("body", _mjcf), "sdf": ("link", _sdf)}


def _comment(inertial: _Tag, mended: Mended, indent: str) -> _Edit:
    return _Edit(
        inertial.start, inertial.start, f"<!-- mended: {hyphens_apart(printable(mended.reason))} -->\n{indent}"
    )


def _closed_alike(data: bytes, tag: _Tag, text: str) -> str:
    """Return an empty element's tag as it was: closed in itself, or by an end tag that stays where it is."""
    return text if data[tag.start : tag.end].endswith(b"/>") else text.removesuffix("/>") + ">"


def _indent(data: bytes, start: int) -> str:
    line = data[data.rfind(b"\n", 0, start) + 1 : start]
    return line.decode("ascii", "ignore") if not line.strip() else ""


_ENCODING = "its encoding is not one of ASCII, UTF-8 and Latin-1: mend it by hand"
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
            raise ReadError(_ENCODING, code="encoding")
        tag = _Tag(name.rpartition(":")[2], attributes, place, match.end())
        stack[-1].children.append(tag)
        stack.append(tag)

    def end(_name: str) -> None:
        stack.pop().close = parser.CurrentByteIndex + lead

    parser.StartElementHandler, parser.EndElementHandler = start, end
    try:
        parser.Parse(data[lead:], True)
    except (LookupError, ValueError):  # what expat makes of an encoding that Python does not know, or of several bytes
        raise ReadError(_ENCODING, code="encoding") from None
    except expat.ExpatError as error:
        raise ReadError(f"its XML is damaged ({error}): export it again", code="damaged_xml") from None
    return root


def _all(root: _Tag) -> list[tuple[_Tag, str]]:
    """Return every element, and the names of the models of SDFormat around it: ``model::inner::``."""
    every, stack = [], [(root, "")]
    while stack:
        tag, scope = stack.pop()
        every.append((tag, scope))
        if tag.name == "model":
            scope += f"{tag.attributes.get('name', '')}::"
        stack.extend((child, scope) for child in reversed(tag.children))
    return every
