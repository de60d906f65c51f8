"""What a slicer says of the volumes in a 3MF archive, which the format does not: which are no part of the body.

PrusaSlicer and those like it write the volumes of an object as one mesh, and the runs of triangles of each beside the
model, Slic3r 1.3 into the mesh; Bambu Studio and OrcaSlicer write them as the components of the object, Cura as objects
that have its settings among their metadata. Modifiers and supports are no part of the body.
Source: Ultimaker, libSavitar, Scene.cpp, and Cura, 3MFWriter and resources/definitions/fdmprinter.def.json; Slic3r 1.3,
IO/TMF.cpp.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple
from xml.etree.ElementTree import Element

from inertia.errors import ReadError
from inertia.mesh.readers.contents import shown
from inertia.mesh.readers.trimesh import parse_xml

SETTINGS = ("model.config", "model_settings.config")
"""How the names of the files end."""

ALL = 0, 10**18
"""The first and the last triangle of a mesh that is such a volume as a whole."""

_CURA = ("infill_mesh", "cutting_mesh", "support_mesh", "anti_overhang_mesh")
_BODY = ("ModelPart", "normal_part")
_CUT = ("NegativeVolume", "negative_part")


class Helpers(NamedTuple):
    """Volumes that are no part of the body: (object, first triangle, last), and (object, which of its components)."""

    runs: set[tuple[str, int, int]]
    components: set[tuple[str, str]]


def helpers(settings: Iterable[bytes]) -> Helpers:
    """Return the volumes that are modifiers or supports; one that is cut out of the others is refused."""
    found = Helpers(set(), set())
    for text in settings:
        if not text.lstrip().startswith(b"<"):
            continue
        for owner in parse_xml(text).iter("object"):
            name = owner.get("id", "")
            for volume, kind in _volumes(owner):
                if kind in _CUT:
                    raise ReadError(
                        f"a slicer cuts a volume out of its object {shown(name)} ({kind}), which the mesh does not "
                        "have: export the part with the cut made",
                        code="not_read",
                    )
                if kind in _BODY:
                    continue
                if volume.tag == "part":
                    found.components.add((name, volume.get("id", "")))
                else:
                    found.runs.add((name, *run_of(volume.attrib, "firstid", "lastid")))
    return found


def is_helper(setting: str) -> bool:
    """Say whether a setting of Cura, where it is true of a mesh, makes that a modifier or a support."""
    return setting.startswith("cura:") and setting.rpartition(":")[2] in _CURA


def run_of(attributes: Mapping[str, str], first: str, last: str) -> tuple[int, int]:
    """Return the first and the last triangle of a volume, which the attributes of these names give."""
    return _place(attributes, first), _place(attributes, last)


def _volumes(owner: Element) -> Iterator[tuple[Element, str]]:
    """Yield the volumes of an object, and what each is."""
    for part in owner.iter("part"):
        yield part, part.get("subtype", "normal_part")
    for volume in owner.iter("volume"):
        says = {each.get("key"): each.get("value") for each in volume.iter("metadata")}
        old = "ParameterModifier" if says.get("modifier") == "1" else "ModelPart"
        yield volume, says.get("volume_type") or old


def _place(attributes: Mapping[str, str], name: str) -> int:
    text = attributes.get(name, "")
    if not text.isascii() or not text.isdigit() or len(text) > 18:
        raise ReadError(f"a slicer's settings have {shown(text)} as {name}, where a number must stand: export it again")
    return int(text)
