"""The tree that a mesh, scene or STEP file carries as an assembly laid out as its file is: names, placements, meshes.

That of a robot's file has its links, at given positions of its joints.
Placements of nodes are applied in moments: the turn and the shift of a node become those of a part or group. What
scales, mirrors or shears is handed down to the meshes below it as their `stretch`, which no group can have.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from inertia.assembly.frames import is_rotation, is_unit
from inertia.errors import InertiaError, ReadError, UsageError, placed, visible
from inertia.mass.moments import dot
from inertia.mesh.geometry.cell_shapes import volume_blocks
from inertia.mesh.part import Cells, Part
from inertia.mesh.read import read, read_tree
from inertia.mesh.readers.contents import plural, was
from inertia.mesh.readers.formats import format_of_name, sniff
from inertia.mesh.tree import ONE, Matrix, MeshTree, Motion, determinant, rotation, times, unique
from inertia.standard_input import NAME as STANDARD_INPUT
from inertia.standard_input import file_of

_ROBOTS = (".urdf", ".xml", ".mjcf", ".xacro", ".sdf", ".world", ".usd", ".usda", ".usdc", ".usdz")
_LISTS = ("csv", "toml")  # of parts, which are no robots here but an assembly's
_BEGINNING = 65_536  # bytes of standard input that are searched for what it is


class Outline(NamedTuple):
    """An assembly laid out as its file is, what had to be decided, in sentences, and the tree that was read.

    `left_out` says what has a mass and is not in it, in sentences, which are among the notes.
    """

    table: dict[str, Any]
    notes: tuple[str, ...]
    tree: MeshTree | None = None
    left_out: tuple[str, ...] = ()


def carried(path: Path) -> Literal["robot", "meshes"] | None:
    """Return what a file is that `outline` reads, by its name, or by the contents of standard input.

    None of an assembly file or a bill of materials, and of what has no such name.
    """
    if str(path) != STANDARD_INPUT:
        return "robot" if path.suffix.lower() in _ROBOTS else "meshes" if format_of_name(path) is not None else None
    from inertia.exchange.robots.read import format_of

    spooled = file_of(STANDARD_INPUT)
    with spooled.open("rb") as file:
        head = file.read(_BEGINNING)
    if format_of(head) not in (None, *_LISTS):
        return "robot"
    try:
        sniff(spooled, head, spooled.stat().st_size)
    except ReadError:
        return None
    return "meshes"


def outline(path: Path, folder: Path, unit: str | None = None, joints: Mapping[str, float] | None = None) -> Outline:
    """Return a file as an assembly.

    It has a part for each node of a file that places its meshes (glTF, 3MF, Collada, STEP), for each region of
    another, or for each link of a robot; lengths, as rational numbers, are in the unit of the file.

    Parameters
    ----------
    folder : that the file of the assembly will be in
    unit : of the coordinates, as of `inertia.read`; of a robot none
    joints : of a robot by name, rad, or m of one that slides; of all others 0, or ``ref`` of MJCF
    """
    if carried(path) == "robot":
        if unit:
            raise UsageError(f"{path} is a robot, whose lengths are in metres: it takes no unit")
        return _of_robot(path, joints or {})
    if joints:
        raise UsageError(f"{path} is no robot, and has no joints: it takes no positions of them")
    file = relative(path, folder)
    tree = read_tree(path, unit)
    if tree is not None and tree.meshes:
        parts, notes = _parts(tree, {"file": file} | ({"unit": unit} if unit else {}))
        named = next(iter(tree.meshes.values())).unit.name
        table = {"schema": 1, "name": visible(path.stem), "unit": named, "part": parts}
        return Outline(table, (*tree.notes, *notes), tree)
    part = read(path, unit)
    own = {} if part.unit_from == "file" else {"unit": part.unit.name}
    names, rest = _regions_with_mass(part)
    regions = [{"name": name, "file": file, "region": name} | own for name in names]
    alone = {"name": visible(path.stem), "file": file} | own
    notes = (f"{plural(rest, 'element')} in no region {was(rest)} left out",) if names and rest else ()
    return Outline({"schema": 1, "name": visible(path.stem), "unit": part.unit.name, "part": regions or [alone]}, notes)


def _of_robot(path: Path, joints: Mapping[str, float]) -> Outline:
    from inertia.exchange.robots.read import read_robot
    from inertia.exchange.robots.tree import robot_tree, unweighed

    robot = read_robot(path)
    try:
        return Outline(*robot_tree(robot, joints), left_out=unweighed(robot))
    except InertiaError as error:
        raise placed(error, str(path)) from None


def _regions_with_mass(part: Part) -> tuple[list[str], int]:
    """Return the regions that have triangles, or volume where there are cells, and how many of these are in none."""
    if part.regions is None:
        return [], 0
    index = part.regions.index
    if isinstance(part.geometry, Cells):
        solid = volume_blocks(part.geometry)
        index = np.concatenate([index[first : first + len(block.nodes)] for first, block in solid] or [index])
    own = set(np.unique(index).tolist())
    return [name for k, name in enumerate(part.regions.names) if k in own], int((index < 0).sum())


def relative(path: Path, folder: Path) -> str:
    """Return how a file in or beneath a folder names another; the whole path of one elsewhere."""
    whole, base = path.resolve(), folder.resolve()
    return whole.relative_to(base).as_posix() if whole.is_relative_to(base) else whole.as_posix()


def rounded(table: Any) -> Any:
    """Return a table with the float64 nearest to each of its rational numbers, for people to read."""
    if isinstance(table, Mapping):
        return {key: rounded(value) for key, value in table.items()}
    if isinstance(table, list | tuple):
        return [rounded(value) for value in table]
    if isinstance(table, Fraction):
        return int(table) if table.denominator == 1 and abs(table) < 2**53 else float(table)
    return table


def _parts(tree: MeshTree, common: Mapping[str, str]) -> tuple[list[dict[str, Any]], tuple[str, ...]]:
    nodes = tree.nodes
    needed = [node.mesh is not None for node in nodes]
    for k in reversed(range(len(nodes))):
        above = nodes[k].parent
        if needed[k] and above is not None:
            needed[above] = True
    names = unique(visible(node.name or node.mesh or "group") for node in nodes)
    stretches: list[Matrix] = []
    parts, notes = [], []
    for node, name, has_mesh_below in zip(nodes, names, needed, strict=True):
        place, stretch = _placed(node.motion, ONE if node.parent is None else stretches[node.parent])
        stretches.append(stretch)
        if not has_mesh_below:
            continue
        part: dict[str, Any] = {"name": name}
        if node.parent is not None:
            part["parent"] = names[node.parent]
        if node.mesh is not None:
            if determinant(stretch):
                part |= {**common, "mesh": node.mesh}
                if stretch != ONE:
                    part["stretch"] = [stretch[k][k] for k in range(3)] if _is_diagonal(stretch) else stretch
            else:
                notes.append(f"{name} is scaled to nothing: its mesh is left out")
        parts.append(part | place)
    return parts, tuple(notes)


def _placed(motion: Motion, above: Matrix) -> tuple[dict[str, Any], Matrix]:
    """Return the fields of a place for x ↦ B (R A x + t), and what is left of B and A for the meshes below."""
    place: dict[str, Any] = {}
    at = tuple(dot(row, motion.at) for row in above)
    if any(at):
        place["at"] = at
    quaternion, scale = motion.quaternion, above[0][0]
    uniform = above == tuple(tuple(scale * k for k in row) for row in ONE)
    if quaternion is not None and uniform:
        figures = [float(k) for k in quaternion]
        place["quaternion"] = figures if is_unit(figures) else _whole(quaternion)
        return place, times(above, motion.linear)
    turn = ONE if quaternion is None else rotation(quaternion)
    linear = times(above, times(turn, motion.linear))
    rows = [[float(k) for k in row] for row in linear]
    if linear == ONE or not is_rotation(rows):
        return place, linear
    return place | {"matrix": rows}, ONE


def _whole(quaternion: Sequence[Fraction]) -> list[int]:
    """Return whole numbers in the proportion of a quaternion, whose length then does not matter."""
    scale = math.lcm(*(k.denominator for k in quaternion))
    whole = [int(k * scale) for k in quaternion]
    return [k // math.gcd(*whole) for k in whole]


def _is_diagonal(rows: Matrix) -> bool:
    return not any(rows[i][j] for i in range(3) for j in range(3) if i != j)
