"""What kind of file it is: by its contents where they decide it, else by its name."""

from __future__ import annotations

import re
from pathlib import Path

from inertia.errors import ReadError
from inertia.mesh.readers.off import OFF_HEADER
from inertia.mesh.readers.stl import is_binary_stl, is_text_stl

EXTENSIONS = {
    "stl": (".stl",),
    "obj": (".obj",),
    "ply": (".ply",),
    "off": (".off",),
    "glb": (".glb",),
    "gltf": (".gltf",),
    "3mf": (".3mf",),
    "step": (".step", ".stp", ".p21"),
    "vtk": (".vtk",),
    "vtu": (".vtu",),
    "gmsh": (".msh",),
    "nastran": (".nas", ".bdf", ".fem"),
    "abaqus": (".inp",),
    "med": (".med",),
    "xdmf": (".xdmf", ".xmf"),
    "medit": (".mesh",),
    "netgen": (".vol",),
    "su2": (".su2",),
    "avsucd": (".avs",),
}
"""The formats that are read, and the extensions that files of each usually have."""

HEAD = 4096

_MAGIC = {
    b"glTF": "glb",
    b"PK\x03\x04": "3mf",
    b"PK\x05\x06": "3mf",
    b"\x89HDF\r\n\x1a\n": "med",
    b"# vtk DataFile": "vtk",
}
_PATTERNS = (
    (re.compile(rb"ply[ \t]*\r?\n|ply\r"), "ply"),
    (re.compile(rb"\s*ISO-10303-21\s*;"), "step"),
    (re.compile(rb"\s*(?:\$Comments\b.*?\$EndComments\s*)?\$MeshFormat\b", re.DOTALL), "gmsh"),
    (re.compile(rb"\s*<(?:.*<)?VTKFile\b", re.DOTALL), "vtu"),
    (re.compile(rb"\s*<(?:.*<)?Xdmf\b", re.DOTALL), "xdmf"),
    (re.compile(rb"\s*\{.*\"asset\"\s*:", re.DOTALL), "gltf"),
    (re.compile(rb"\s*MeshVersionFormatted\b"), "medit"),
    (re.compile(rb"(?:\s*#[^\n]*\n)*\s*mesh3d\b"), "netgen"),
    (re.compile(rb"(?:\s*%[^\n]*\n)*\s*NDIME\s*="), "su2"),
    (
        re.compile(rb"(?:\s*\*\*[^\n]*\n)*\s*\*(?:HEADING|NODE|PART|PREPRINT|ELEMENT)\b", re.IGNORECASE),
        "abaqus",
    ),
    (re.compile(rb"(?:.*\n)?[ \t]*BEGIN BULK\b", re.DOTALL), "nastran"),
    (re.compile(rb"(?:\s*#[^\n]*\n)*\s*(?:mtllib\s|o\s|g\s|v\s+[-+.\d])"), "obj"),
    (OFF_HEADER, "off"),
)
"""How files begin that have no magic number, the surest first."""


def sniff(path: Path, head: bytes, size: int) -> str:
    """Return the format of a file that begins with `head` (its first `HEAD` bytes) and has `size` bytes."""
    if is_binary_stl(head, size):
        return "stl"
    for magic, name in _MAGIC.items():
        if head.startswith(magic):
            return name
    if is_text_stl(head):
        return "stl"
    text = head.removeprefix(b"\xef\xbb\xbf")
    for pattern, name in _PATTERNS:
        if pattern.match(text):
            return name
    suffix = path.suffix.lower()
    for name, extensions in EXTENSIONS.items():
        if suffix in extensions:
            return name
    raise ReadError(
        f"neither its contents nor its name tell what it is: these are read: {', '.join(EXTENSIONS)} "
        "(give the format if it is one of them)"
    )
