"""Files that are no meshes, by how they begin: what each is, and what to do about it."""

from __future__ import annotations

import re

_EXPORT = "export the part as STEP, STL or 3MF"
UTF_16 = rb"\xff\xfe|\xfe\xff|(?:[\t\n\r -~]\x00){16}|(?:\x00[\t\n\r -~]){16}"
"""How text in UTF-16 begins, of which no reader takes any; so may the header of a binary STL file."""

_PROLOG = rb"\s*(?:<\?xml[^>]*>\s*)?(?:<!--(?:(?!-->)[\s\S])*-->\s*|<!(?!--)[^>]*>\s*)*"
"""What may stand before the root of an XML document: its declaration, comments and a document type."""
_UNPACK = "unpack it and give the mesh in it"

_KINDS = (
    (rb"version https://git-lfs\.github\.com/spec/", "a pointer of Git LFS, not the file itself", "run `git lfs pull`"),
    (
        _PROLOG + rb"(?i:<(?:!doctype\s+)?(?:html|head|body)\b)",
        "an HTML page",
        "download the file itself, not the page about it",
    ),
    (rb"%PDF-", "a PDF document", _EXPORT),
    (rb"\x89PNG\r\n\x1a\n|\xff\xd8\xff|GIF8[79]a|RIFF....WEBP", "a picture", _EXPORT),
    (rb"\x7fELF|MZ.{58,200}PE\x00\x00", "a program", _EXPORT),
    (rb"#!", "a script", _EXPORT),
    (rb"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "a file of SolidWorks, Inventor or another program that uses OLE", _EXPORT),
    (rb"\*\*(?:PART1|ABCDEFGHIJKLMNOPQRSTUVWXYZ)|PS\x00\x00", "a Parasolid file", _EXPORT),
    (rb"(?s).{72}S {6}1\r?\n", "an IGES file", _EXPORT),
    (rb"Version \d+\.\d+ JT", "a JT file", _EXPORT),
    (rb"AC10\d\d", "a DWG drawing", _EXPORT),
    (rb"\s*0\r?\n\s*SECTION\r?\n", "a DXF drawing", _EXPORT),
    (rb"Kaydara FBX Binary|; FBX ", "an FBX file", _EXPORT),
    (rb"BLENDER", "a Blender file", _EXPORT),
    (rb"\s*\((?:[01] +\"|2 +[23]\))", "a mesh of Fluent", "export the mesh as Gmsh, VTU or MED"),
    (rb"#VRML", "a VRML file", _EXPORT),
    (_PROLOG + rb"<X3D\b", "an X3D file", _EXPORT),
    (_PROLOG + rb"<amf\b", "an AMF file", _EXPORT),
    (rb"#usda|PXR-USDC", "a USD stage", "use it with `inertia audit`, or " + _EXPORT),
    (rb"RRF2", "a recording of Rerun", "give the mesh that it was made of"),
    (rb"7z\xbc\xaf\x27\x1c", "a 7-Zip archive", _UNPACK),
    (rb"Rar!\x1a\x07", "a RAR archive", _UNPACK),
    (rb"\x28\xb5\x2f\xfd", "a file compressed by Zstandard", _UNPACK),
    (UTF_16, "text in UTF-16", "save it as UTF-8"),
    (rb"\x00{512}", "a file of zeros, which was not written to its end", "copy or export it again"),
)


def stranger(head: bytes) -> str | None:
    """Return what a file is that begins with `head` and is no mesh, with the remedy; None where that is not known.

    >>> stranger(b"<!DOCTYPE html>")
    'it is an HTML page: download the file itself, not the page about it'
    """
    for pattern, what, remedy in _KINDS:
        if re.match(pattern, head):
            return f"it is {what}: {remedy}"
    return None
