"""MED, of Salome: what meshio passes over in silence, refused or put right before it sees the file.

Source: MED 4.1, "Le format de fichier MED": `REP` is the kind of coordinates, `UNI` their units in 16 characters each.
"""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from inertia.errors import ReadError, UsageError
from inertia.mesh.readers.contents import quietly, shown
from inertia.mesh.readers.hdf5 import check_hdf5, h5py
from inertia.output import temporary_folder
from inertia.units import Unit, length_unit

_MESHES, _FAMILIES = "ENS_MAA", "FAS"
_OTHERS = (
    ("CGNSLibraryVersion", "a CGNS file"),
    ("tstt", "an H5M file of MOAB"),
    ("VTKHDF", "a VTK HDF file"),
)
"""What other HDF5 files have in their root."""

_COORDINATES = {1: "cylindrical", 2: "spherical"}
_WORD = 16


def check_med(path: Path) -> None:
    """Refuse HDF5 files that are not MED, and meshes whose coordinates are not Cartesian."""
    check_hdf5(path)
    with quietly("h5py", "med"), h5py().File(path, "r") as file:
        if _MESHES not in file:
            what = next((what for name, what in _OTHERS if name in file), "an HDF5 file without a mesh of MED")
            raise ReadError(
                f"it is {what}, which is not read: export the mesh as MED, VTU or Gmsh", code="unknown_format"
            )
        for mesh in file[_MESHES].values():
            kind = int(mesh.attrs.get("REP", 0))
            if kind:
                raise ReadError(
                    f"its coordinates are {_COORDINATES.get(kind, f'of the kind {kind}')}, which are not read: write "
                    "Cartesian ones",
                    code="not_read",
                )


def med_unit(path: Path) -> Unit | None:
    """Return the unit of length that all axes of a mesh have; None where they have none, or one that is unknown."""
    with quietly("h5py", "med"), h5py().File(path, "r") as file:
        values = [mesh.attrs.get("UNI", b"") for mesh in file[_MESHES].values()]
        stated = [value.encode() if isinstance(value, str) else bytes(value) for value in values]
    names = {
        name
        for each in stated
        for at in range(0, len(each), _WORD)
        if (name := each[at : at + _WORD].strip(b" \0").decode("latin-1"))
    }
    units = set()
    for name in names:
        with contextlib.suppress(UsageError):
            units.add(length_unit(name))
    if len(units) > 1:
        raise ReadError(
            f"its axes have different units ({', '.join(map(shown, sorted(names)))}): write all in one", code="not_read"
        )
    return units.pop() if units else None


@contextlib.contextmanager
def with_families(path: Path) -> Iterator[Path]:
    """Give the file, or a copy with what meshio needs and a file without groups may lack.

    `FAM` may be left out where it is 0 throughout; meshio takes families for all kinds of cells or for none. It looks
    for the families of a mesh, `FAS`, whether there are any or not.
    """
    with temporary_folder() as folder:
        with quietly("h5py", "med"):
            with h5py().File(path, "r") as file:
                kinds = _kinds_of_cells(file[_MESHES])
                lacking = [name for name, has in kinds.items() if not has] if any(kinds.values()) else []
                nameless = [name for name in file[_MESHES] if f"{_FAMILIES}/{name}" not in file]
            if lacking or nameless:
                path = shutil.copyfile(path, folder / "part.med")
                with h5py().File(path, "r+") as file:
                    for name in lacking:
                        kind = file[_MESHES][name]
                        kind["FAM"] = np.zeros(int(kind["NOD"].attrs["NBR"]), np.int64)
                    for name in nameless:
                        file.create_group(f"{_FAMILIES}/{name}")
        yield path


def families(group: Any) -> dict[int, list[str]]:
    """Return the names of the groups that each family is in, by its number; a name is 80 bytes, of UTF-8 or Latin-1."""
    return {
        int(family.attrs["NUM"]): [_name(row) for row in family["GRO/NOM"][()]] if "GRO" in family else []
        for family in group.values()
    }


def _name(row: Any) -> str:
    text = np.asarray(row).astype(np.uint8).tobytes().partition(b"\0")[0]
    try:
        return text.decode().strip()
    except UnicodeDecodeError:
        return text.decode("latin-1").strip()


def _kinds_of_cells(meshes: Any) -> dict[str, bool]:
    """Return the group of each kind of cells, and whether it has families."""
    kinds: dict[str, bool] = {}

    def add(name: str, item: Any) -> None:
        if name.split("/")[-2:-1] == ["MAI"]:
            kinds[name] = "FAM" in item

    meshes.visititems(add)
    return kinds
