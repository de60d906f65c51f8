"""VTU as meshio reads it: raw appended data beside the elements that they belong to, and no arrays without numbers.

meshio looks for the array of each raw block by its offset while it writes new offsets, and may take one array for
another. It does not know version 2, which differs from 1 in cells that are not read: polyhedra and those of Lagrange.
Source: "VTK XML Formats", docs.vtk.org; VTK 9, IO/XML/vtkXMLUnstructuredDataReader.cxx.
"""

from __future__ import annotations

import re
from base64 import b64encode
from itertools import pairwise
from xml.etree.ElementTree import Element

import numpy as np

from inertia.errors import ReadError
from inertia.mesh.readers.contents import shown
from inertia.mesh.readers.trimesh import parse_xml, xml_text

_SECOND = re.compile(rb"(<VTKFile\b[^>]*?\bversion\s*=\s*[\"'])2\.[0-3](?=[\"'])")
_APPENDED = re.compile(rb"<AppendedData\b[^>]*>")
_RAW = re.compile(rb"\bencoding\s*=\s*[\"']raw[\"']")
_NO_NUMBERS = re.compile(rb"<Array\b|\btype\s*=\s*[\"'](?:String|Bit)[\"']")
_OFFSET = re.compile(r"\s*\d{1,18}\s*")
_HEADERS = {"UInt32": "u4", "UInt64": "u8"}
_ORDERS = {"LittleEndian": "<", "BigEndian": ">"}


def plain_vtu(data: bytes) -> bytes | None:
    """Return a VTU file of version 1 without raw appended data and arrays of strings or bits; None where it is one."""
    given, data = data, _SECOND.sub(rb"\g<1>1.0", data, count=1)
    tag = _APPENDED.search(data)
    is_raw = tag is not None and _RAW.search(tag[0]) is not None
    if not is_raw and not _NO_NUMBERS.search(data):
        return None if data == given else data
    root = parse_xml(data[: tag.end()] + b"</AppendedData></VTKFile>" if tag is not None and is_raw else data)
    for attributes in [each for name in ("FieldData", "PointData", "CellData") for each in root.iter(name)]:
        for array in list(attributes):
            if array.tag == "Array" or array.get("type") in ("String", "Bit"):
                attributes.remove(array)
    if tag is not None and is_raw:
        _unpack(root, data, tag.end())
    return xml_text(root)


def _unpack(root: Element, data: bytes, begin: int) -> None:
    """Write the raw data that begin at a byte of the file into the arrays whose they are, as base64."""
    stop = data.rfind(b"</AppendedData")
    if stop < begin:
        raise ReadError("its appended data have no end: it was cut short, export it again", code="cut_short")
    lead = re.compile(rb"\s*_").match(data, begin)
    if lead is None:
        raise ReadError("its appended data do not begin with _: it is damaged, export it again")
    stated = root.get("header_type", "UInt32")
    if stated not in _HEADERS:
        raise ReadError(
            f"its header_type is {shown(stated)}, which is not read: save it by UInt32 or UInt64", code="not_read"
        )
    word = np.dtype(_ORDERS.get(root.get("byte_order", ""), "=") + _HEADERS[stated])
    spans = set()

    def words(at: int, count: int, name: str) -> list[int]:
        if at + count * word.itemsize > stop:
            raise _too_short(name)
        found: list[int] = np.frombuffer(data, word, count, at).tolist()
        return found

    for array in root.iter("DataArray"):
        if array.get("format") != "appended":
            continue
        name, offset = array.get("Name", ""), array.get("offset", "")
        if not _OFFSET.fullmatch(offset):
            raise ReadError(f"its array {shown(name)} has the offset {shown(offset)}, not a number: export it again")
        at = lead.end() + int(offset)
        size, count = words(at, 1, name)[0], 1
        is_packed = root.get("compressor") is not None
        if is_packed:  # the number of blocks, the size of each, that of the last, and then of each as packed
            count = 3 + size
            size = sum(words(at, count, name)[3:])
        first = at + count * word.itemsize
        if first + size > stop:
            raise _too_short(name)
        spans.add((at, first + size))
        ends = (at, first, first + size) if is_packed else (at, first + size)
        array.set("format", "binary" if size else "ascii")  # meshio reads no block of none
        array.text = "".join(b64encode(data[a:b]).decode() for a, b in pairwise(ends)) if size else " "
    if any(one[1] > other[0] for one, other in pairwise(sorted(spans))):
        raise ReadError("the offsets of its arrays do not agree with their sizes: it is damaged, export it again")
    root.remove(root.findall("AppendedData")[-1])


def _too_short(name: str) -> ReadError:
    return ReadError(
        f"its array {shown(name)} is longer than its appended data: it was cut short or damaged, export it again",
        code="cut_short",
    )
