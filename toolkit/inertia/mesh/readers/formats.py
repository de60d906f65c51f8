"""The formats that are read: the extensions of each, how its files begin, and its reader.

What kind a file is, its contents decide, and its name only where they do not.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

from inertia.errors import ReadError
from inertia.mesh.readers.msh import is_mujoco_msh
from inertia.mesh.readers.stl import is_binary_stl, is_text_stl
from inertia.mesh.readers.strangers import UTF_16, stranger


class Format(NamedTuple):
    """A format: its usual extensions, the pattern that its files begin with (None: see `sniff`), and its reader.

    `tree` reads the nodes of a file and their meshes in own axes, where files of that format have them.
    """

    extensions: tuple[str, ...]
    begins: bytes | None
    module: str
    function: str
    tree: str = ""


FORMATS = {
    "stl": Format((".stl",), None, "stl", "read_stl"),
    "obj": Format((".obj",), rb"(?:\s*#[^\n]*\n)*\s*(?:mtllib\s|o\s|g\s|v\s+[-+.\d])", "obj", "read_obj"),
    "ply": Format((".ply",), rb"ply[ \t]*\r?\n|ply\r", "ply", "read_ply"),
    "off": Format((".off",), rb"\s*(?:#[^\n]*\n\s*)*(?:ST)?C?N?4?n?OFF(?![A-Za-z])", "off", "read_off"),
    "glb": Format((".glb",), rb"glTF", "gltf", "read_gltf", "gltf_tree"),
    "gltf": Format((".gltf",), rb"(?s)\s*\{.*\"asset\"\s*:", "gltf", "read_gltf", "gltf_tree"),
    "3mf": Format((".3mf",), rb"PK(?:\x03\x04|\x05\x06)", "three_mf", "read_3mf", "three_mf_tree"),
    "step": Format((".step", ".stp", ".p21"), rb"\s*ISO-10303-21\s*;", "step", "read_step", "step_tree"),
    "dae": Format((".dae",), rb"(?s)\s*<(?:.*<)?COLLADA\b", "collada", "read_collada", "collada_tree"),
    "zae": Format((".zae",), None, "collada", "read_collada", "collada_tree"),
    "3dxml": Format((".3dxml",), None, "three_dxml", "read_3dxml"),
    "xaml": Format((".xaml",), rb"(?s)\s*<.*schemas\.microsoft\.com/winfx/", "xaml", "read_xaml"),
    "vtk": Format((".vtk",), rb"# vtk DataFile", "meshio", "read_with_meshio"),
    "vtu": Format((".vtu",), rb"(?s)\s*<(?:.*<)?VTKFile\b", "meshio", "read_with_meshio"),
    "gmsh": Format(
        (".msh",), rb"(?s)\s*(?:\$Comments\b.*?\$EndComments\s*)?\$(?:MeshFormat|NOD)\b", "gmsh", "read_gmsh"
    ),
    "mujoco": Format((".msh",), None, "msh", "read_mujoco_msh"),  # known by its size; by its name it is Gmsh
    "nastran": Format(
        (".nas", ".bdf", ".fem"), rb"(?si)(?:.*\n)?[ \t]*BEGIN[ \t]+BULK\b", "meshio", "read_with_meshio"
    ),
    "abaqus": Format(
        (".inp",),
        rb"(?i)(?:\s*\*\*[^\n]*\n)*\s*\*(?:HEADING|NODE|PART|PREPRINT|ELEMENT)\b",
        "meshio",
        "read_with_meshio",
    ),
    "med": Format((".med",), rb"\x89HDF\r\n\x1a\n", "meshio", "read_with_meshio"),
    "xdmf": Format((".xdmf", ".xmf"), rb"(?s)\s*<(?:.*<)?Xdmf\b", "meshio", "read_with_meshio"),
    "medit": Format((".mesh",), rb"\s*MeshVersionFormatted\b", "meshio", "read_with_meshio"),
    "netgen": Format((".vol",), rb"(?:\s*#[^\n]*\n)*\s*mesh3d\b", "meshio", "read_with_meshio"),
    "su2": Format((".su2",), rb"(?:\s*%[^\n]*\n)*\s*NDIME\s*=", "meshio", "read_with_meshio"),
    "avsucd": Format(
        (".avs", ".inp"),
        rb"(?:\s*#[^\n]*\n)*\s*\d+(?:[ \t]+\d+){4}\s*\n\s*\d+(?:[ \t]+[-+.\deE]+){3}\s",  # counts, and a node
        "meshio",
        "read_with_meshio",
    ),
}
"""Name of a format → what is known about it; the readers are in `inertia.mesh.readers`, a module each."""

EXTENSIONS = {name: entry.extensions for name, entry in FORMATS.items()}
"""Name of a format → the extensions that its files usually have."""

HEAD = 4096


def sniff(path: Path, head: bytes, size: int, stated: str | None = None) -> str:
    """Return the format of a file that begins with `head` (its first `HEAD` bytes) and has `size` bytes.

    It is the one that is `stated`, if any. Raises `ReadError` where the file is known to be none that is read.
    """
    if stated is not None:
        if re.match(UTF_16, head) and not is_binary_stl(head, size):
            raise ReadError(str(stranger(head)), code="unknown_format")
        return stated
    if is_binary_stl(head, size) or is_text_stl(head):
        return "stl"
    if is_mujoco_msh(head, size):
        return "mujoco"
    text = head.removeprefix(b"\xef\xbb\xbf")
    for name, entry in FORMATS.items():
        if entry.begins is not None and re.match(entry.begins, text):
            return (format_of_zip(path) or "3mf") if name == "3mf" else name
    if (other := stranger(head)) is not None:
        raise ReadError(other, code="unknown_format")
    suffix = format_of_name(path)
    if suffix is None:
        raise ReadError(
            f"neither its contents nor its name tell what it is: these are read: {', '.join(FORMATS)} "
            "(give the format if it is one of them)",
            code="unknown_format",
        )
    return suffix


def format_of_name(path: Path) -> str | None:
    """Return the format that the extension of a file stands for; None where it stands for none."""
    suffix = path.suffix.lower()
    return next((name for name, extensions in EXTENSIONS.items() if suffix in extensions), None)


def format_of_zip(path: Path) -> str | None:
    """Return the format of a zip archive: by its members, else by its name; None where it is none."""
    import zipfile

    try:
        with zipfile.ZipFile(path) as archive:
            members = [name.lower() for name in archive.namelist()]
    except (zipfile.BadZipFile, NotImplementedError, ValueError):  # its reader says what is wrong with it
        members = []
    for name, ending in (("3mf", ".model"), ("3dxml", ".3dxml"), ("zae", ".dae")):
        if any(member.endswith(ending) for member in members):
            return name
    suffix = format_of_name(path)
    return suffix if suffix in ("zae", "3dxml", "3mf") else None
