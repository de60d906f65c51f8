"""MED: kinds of coordinates, units, families, and HDF5 files that are none."""

from pathlib import Path

import numpy as np
import pytest
from tests.mesh.readers.samples import TETRA, TETRA_POINTS, by_meshio, names_of
from tests.mesh.readers.test_cells import written

from inertia.errors import ReadError
from inertia.mesh.part import Cells, Part
from inertia.mesh.read import read

h5py = pytest.importorskip("h5py")


def with_attribute(folder: Path, name: str, value: object, **options: str) -> Part:
    by_meshio(folder, "a.med", "med")
    with h5py.File(folder / "a.med", "r+") as file:
        (mesh,) = file["ENS_MAA"].values()
        mesh.attrs[name] = value
    return read(folder / "a.med", **options)


@pytest.mark.parametrize(("number", "kind"), [(1, "cylindrical"), (2, "spherical"), (3, "of the kind 3")])
def test_coordinates_that_are_not_cartesian_are_refused(number: int, kind: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=f"its coordinates are {kind}, which are not read"):
        with_attribute(tmp_path, "REP", number)


@pytest.mark.parametrize(
    ("axes", "unit"),
    [
        (["m"] * 3, ("m", "file")),
        (["cm", "", ""], ("cm", "file")),
        (["INCONNU"] * 3, ("mm", "assumed")),
        ([""] * 3, ("mm", "assumed")),
    ],
)
def test_the_unit_of_the_axes_is_that_of_the_file(axes: list[str], unit: tuple[str, str], tmp_path: Path) -> None:
    part = with_attribute(tmp_path, "UNI", np.bytes_("".join(f"{axis:16}" for axis in axes)))
    assert (part.unit.name, part.unit_from) == unit


def test_axes_in_different_units_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=r"different units \('m', 'mm'\): write all in one"):
        with_attribute(tmp_path, "UNI", np.bytes_(f"{'m':16}{'m':16}{'mm':16}"))


def test_cells_without_families_are_in_none(tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    mesh = meshio.Mesh(TETRA_POINTS, [("tetra", TETRA[:1]), ("pyramid", [[0, 1, 4, 2, 3]])])
    mesh.cell_data = {"cell_tags": [np.array([-6]), np.array([0])]}
    mesh.point_tags, mesh.cell_tags = {}, {-6: ["steel"]}
    whole = written(tmp_path, "a.med", mesh)
    with h5py.File(tmp_path / "a.med", "r+") as file:
        (step,) = next(iter(file["ENS_MAA"].values())).values()
        del step["MAI/PY5/FAM"]
    part = read(tmp_path / "a.med")
    assert sorted(names_of(part) or ()) == sorted(names_of(whole) or ()) == ["default", "steel"]


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
def test_names_of_groups_are_in_any_language(encoding: str, tmp_path: Path) -> None:
    by_meshio(tmp_path, "a.med", "med")
    with h5py.File(tmp_path / "a.med", "r+") as file:
        (families,) = file["FAS"].values()
        for kinds in file["ENS_MAA"].values():
            (step,) = kinds.values()
            for kind in step["MAI"].values():
                kind.pop("FAM", None)
                kind["FAM"] = np.full(int(kind["NOD"].attrs["NBR"]), -7)
        family = families.create_group("ELEME/FAM_-7")
        family.attrs["NUM"] = -7
        family.create_dataset("GRO/NOM", (1,), dtype="80int8")
        family["GRO"].attrs["NBR"] = 1
        family["GRO/NOM"][0] = np.frombuffer("moitié".encode(encoding).ljust(80, b"\0"), np.int8)
        families.create_group("ELEME/FAM_-8").attrs["NUM"] = -8  # in no group
    assert set(names_of(read(tmp_path / "a.med")) or ()) == {"moitié"}


def test_a_file_without_groups_is_read(tmp_path: Path) -> None:
    by_meshio(tmp_path, "a.med", "med")
    whole = read(tmp_path / "a.med")
    with h5py.File(tmp_path / "a.med", "r+") as file:
        del file["FAS"]
    part = read(tmp_path / "a.med")
    assert isinstance(part.geometry, Cells)
    assert isinstance(whole.geometry, Cells)
    assert np.array_equal(part.geometry.blocks[0].nodes, whole.geometry.blocks[0].nodes)


@pytest.mark.parametrize(
    ("group", "says"),
    [("CGNSLibraryVersion", "a CGNS file"), ("tstt", "an H5M file of MOAB"), ("a", "an HDF5 file without a mesh")],
)
def test_other_hdf5_files_are_called_by_their_name(group: str, says: str, tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a", "w") as file:
        file.create_group(group)
    with pytest.raises(ReadError, match=f"it is {says}.*: export the mesh as MED") as refusal:
        read(tmp_path / "a")
    assert refusal.value.code == "unknown_format"
