"""The nodes and elements of Gmsh MSH 4.1, and the physical groups of its entities."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import ReadError
from inertia.mesh.readers.msh_numbers import Group, MshFile
from inertia.mesh.readers.msh_types import nodes_of


def nodes(file: MshFile) -> tuple[Int, Float]:
    """Return the tags (n,) and the coordinates (n, 3) of the nodes."""
    body = file.numbers("Nodes")
    blocks, total, _, _ = body.sizes(4).tolist()
    tags: list[Int] = [np.empty(0, np.int64)]
    points: list[Float] = [np.empty((0, 3))]
    for _ in range(blocks):
        dimension, _, parametric = body.ints(3).tolist()
        if not 0 <= dimension <= 3:
            raise ReadError(f"its section $Nodes has an entity of dimension {dimension}: export it again")
        count = body.size()
        width = 3 + (dimension if parametric else 0)
        tags.append(body.sizes(count))
        points.append(body.floats(count * width).reshape(count, width)[:, :3])
    body.finish("nodes", total, sum(map(len, tags)))
    return np.concatenate(tags), np.concatenate(points)


def elements(file: MshFile) -> list[Group]:
    """Return the elements; their entity says which physical group they belong to."""
    physical = _entities(file)
    body = file.numbers("Elements")
    blocks, total, _, _ = body.sizes(4).tolist()
    groups: list[Group] = []
    for _ in range(blocks):
        dimension, entity, number = body.ints(3).tolist()
        count = body.size()
        width = 1 + nodes_of(number)
        rows = body.sizes(count * width).reshape(count, width)
        groups.append((number, np.full(count, physical.get((dimension, entity), 0)), rows[:, 1:]))
    body.finish("elements", total, sum(len(corners) for _, _, corners in groups))
    return groups


def _entities(file: MshFile) -> dict[tuple[int, int], int]:
    """Return (dimension, tag) of each entity in a physical group → the tag of (the first) group."""
    physical: dict[tuple[int, int], int] = {}
    if file.section("Entities") is None:
        return physical
    body = file.numbers("Entities")
    for dimension, count in enumerate(body.sizes(4).tolist()):
        for _ in range(count):
            tag = int(body.ints(1)[0])
            body.floats(6 if dimension else 3)
            groups = body.ints(body.size())
            if dimension:
                body.ints(body.size())
            if len(groups):
                physical[dimension, tag] = abs(int(groups[0]))
    return physical
