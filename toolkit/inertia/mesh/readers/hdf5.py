"""HDF5 files, which MED is and XDMF refers to: what is checked before anything is read from one."""

from __future__ import annotations

import importlib
import importlib.util
from pathlib import Path
from typing import Any

from inertia.errors import ReadError
from inertia.mesh.readers.contents import shown

_SPARSE_FREE, _SPARSE_RATIO = 64 * 2**20, 200
_TOGETHER = "write all of it into one HDF5 file"


def h5py() -> Any:
    """Return the module h5py; raise `ReadError` without it."""
    if importlib.util.find_spec("h5py") is None:
        raise ReadError("MED and XDMF need the package h5py: pip install 'inertia[med]'", code="needs_package")
    return importlib.import_module("h5py")


def check_hdf5(path: Path) -> dict[str, int]:
    """Refuse a file whose data sets are out of all proportion to its size, or lie in other files.

    Returns name → number of items of each data set.
    """
    library = h5py()
    sizes: dict[str, int] = {}
    size = 0

    def add(name: str, item: Any) -> None:
        nonlocal size
        for each in item if isinstance(item, library.Group) else ():
            if isinstance(item.get(each, getlink=True), library.ExternalLink):
                raise ReadError(f"its entry {shown(f'{name}/{each}')} lies in another file: {_TOGETHER}")
        if isinstance(item, library.Dataset):
            if item.external or item.is_virtual:
                raise ReadError(f"its data set {shown(name)} lies in another file: {_TOGETHER}")
            sizes[name] = int(item.size or 0)
            size += sizes[name] * int(item.dtype.itemsize)

    try:
        with library.File(path, "r") as file:
            add("", file)
            file.visititems(add)
    except ReadError:
        raise
    except Exception as error:  # h5py passes on whatever a damaged file leads to
        raise ReadError(f"it is a damaged HDF5 file ({shown(str(error), 80)}): export it again") from None
    limit = max(_SPARSE_FREE, _SPARSE_RATIO * path.stat().st_size)
    if size > limit:
        raise ReadError(
            f"its data sets unpack to {size} bytes, beyond the {limit} allowed: it is damaged", code="too_large"
        )
    return sizes
