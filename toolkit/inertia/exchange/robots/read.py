"""A robot's file read by what it is: URDF, MJCF."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from inertia.errors import ReadError, placed
from inertia.exchange.robots.links import Robot
from inertia.exchange.robots.mjcf import read_mjcf
from inertia.exchange.robots.urdf import read_urdf

READERS: dict[str, tuple[bytes, Callable[[Path], Robot]]] = {
    "urdf": (b"<robot", read_urdf),
    "mjcf": (b"<mujoco", read_mjcf),
}
"""Format → what its files hold near their beginning, and its reader."""

_BEGINNING = 65_536  # bytes that are searched for what a file is; licences stand at the top of many


def read_robot(path: str | Path) -> Robot:
    """Read the links of a robot, and what is stated of each.

    Raises `ReadError` where the file is missing, damaged or of another format.
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            beginning = file.read(_BEGINNING)
    except OSError as error:
        raise ReadError(f"cannot read {path}: {error.strerror}") from error
    for mark, reader in READERS.values():
        if mark in beginning:
            try:
                return reader(path)
            except ReadError as error:
                raise placed(error, f"cannot read {path}") from None
    raise ReadError(f"cannot read {path}: it is no robot of a known format ({', '.join(READERS)})")
