"""Budgets of the sample assemblies: standard uncertainties of the first order beside those of draws of all inputs.

    python -m tests.benchmarks.budget_draws [--draws 20000] [NAME ...]

A draw takes each input from a normal distribution, places and turns every part in numpy, rotations as rotations, and
adds up; nothing of it is linear. The ratio is that of the first order to the draws', the worst of mass, centre of mass
and tensor.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator

import numpy as np
from scipy.spatial.transform import Rotation

from inertia.arrays import Float
from inertia.assembly.document import Assembly
from inertia.assembly.frames import LENGTH_BITS, Frame
from inertia.assembly.inputs import Source
from inertia.assembly.tree import Node
from inertia.estimate import uncertainty_of
from inertia.mesh.turns import TURN_BITS
from inertia_meshes import assemblies, path

_NAMES = ("mass", "x", "y", "z", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
_ELEMENTS = (0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)
_PLACES = (0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)
_NOTHING = 1e-6  # of the largest of its kind: an uncertainty of the first order that is none


def main() -> None:
    """Print a row for each assembly."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.budget_draws", description=__doc__)
    parser.add_argument("--draws", type=int, default=20_000)
    parser.add_argument("names", nargs="*")
    options = parser.parse_args()
    off = 0.0
    print(
        f"{options.draws} draws, each standard deviation of which is known to {1 / math.sqrt(2 * options.draws):.2%}\n"
    )
    for name in options.names or assemblies():
        ratios = ratios_of(Assembly.load(path(name)), options.draws)
        worst = max(ratios, key=lambda each: abs(math.log(ratios[each])))
        off = max(off, abs(ratios[worst] - 1))
        print(f"{name:34} {len(ratios):2} figures, worst {ratios[worst]:.4f} of {worst}")
    print(f"\nfirst order and draws differ by {off:.2%} at most")


def ratios_of(tree: Assembly, count: int, seed: int = 0) -> dict[str, float]:
    """Return the ratio of the first order to draws, of each figure that is uncertain to the first order."""
    sigma = tree.budget().total.sigma.all[:10]
    drawn = draws(tree, count, seed).std(axis=0)
    groups = (0, 1), (1, 4), (4, 10)
    largest = np.concatenate([np.full(b - a, sigma[a:b].max()) for a, b in groups])
    return {
        name: float(one / other)
        for name, one, other, most in zip(_NAMES, sigma, drawn, largest, strict=True)
        if one > _NOTHING * most
    }


def draws(tree: Assembly, count: int, seed: int) -> Float:
    """Return mass, centre of mass and tensor (xx, yy, zz, xy, xz, yz) of each draw, (count, 10)."""
    random = np.random.default_rng(seed)
    frames = dict(tree.in_places())
    above = {child: node for node in frames for child in node.children}
    common: dict[Source, Float] = {}
    moves = {node: list(_misplaced(node, frames[node], random, count)) for node in frames}
    whole = np.zeros((count, 10))
    for node in frames:
        if node.body is None:
            continue
        mass, center, second = _own(node, random, count, common)
        for number, frame in enumerate(frames[node]):
            turn, at = _floats(frame)
            c, s = center @ turn.T + at, turn @ second @ turn.T
            on: Node | None = node
            while on is not None:  # from the part outwards
                if moves[on]:
                    copy = number * len(frames[on]) // len(frames[node])
                    rotation, shift, origin = moves[on][copy]
                    c = np.einsum("nij,nj->ni", rotation, c - origin) + origin + shift
                    s = rotation @ s @ rotation.swapaxes(1, 2)
                on = above.get(on)
            s = s + mass[:, None, None] * c[:, :, None] * c[:, None, :]
            whole[:, 0] += mass
            whole[:, 1:4] += mass[:, None] * c
            whole[:, 4:] += np.stack([s[:, i, j] for i, j in _ELEMENTS], axis=1)
    c = whole[:, 1:4] / whole[:, :1]
    central = np.zeros((count, 3, 3))
    for k, (i, j) in enumerate(_ELEMENTS):
        central[:, i, j] = central[:, j, i] = whole[:, 4 + k] - whole[:, 0] * c[:, i] * c[:, j]
    tensor = np.trace(central, axis1=1, axis2=2)[:, None, None] * np.eye(3) - central
    return np.concatenate([whole[:, :1], c, np.stack([tensor[:, i, j] for i, j in _ELEMENTS], axis=1)], axis=1)


def _own(
    node: Node, random: np.random.Generator, count: int, common: dict[Source, Float]
) -> tuple[Float, Float, Float]:
    """Return mass (n,), centre (n, 3) and ∫x xᵀ about it (n, 3, 3) of a part in its own axes, each input drawn."""
    fields, body = node.fields, node.body
    assert fields is not None
    assert body is not None
    central = body.moments.central()
    mass = np.full(count, float(central.zeroth))
    center = np.tile([float(k) for k in central.origin], (count, 1))
    second = np.zeros((count, 3, 3))
    for value, (i, j) in zip(central.second, _PLACES, strict=True):
        second[:, i, j] = second[:, j, i] = float(value)
    for one in body.inputs:
        if one.source.what in ("density", "thickness", "mass"):
            relative = one.change[0, 0] / float(central.zeroth)
            factor = 1 + relative * common.setdefault(one.source, random.normal(size=count))
            mass = mass * factor
            second = second * (1.0 if fields.inertia is not None else factor[:, None, None])
        elif one.source.what == "scale":
            u = uncertainty_of(fields.scale) if fields.scale is not None else 0.0
            factor = 1 + u * common.setdefault(one.source, random.normal(size=count))
            grown = fields.mass is None
            mass = mass * (factor**3 if grown else 1.0)
            center = center * (1.0 if fields.center_of_mass is not None else factor[:, None])
            if fields.inertia is None:
                second = second * (factor**5 if grown else factor**2)[:, None, None]
        elif one.source.what == "centre of mass":
            u = float(node.unit.metres) * (fields.center_of_mass_uncertainty or 0.0)
            center = center + u * random.normal(size=(count, 3))
        elif one.source.what == "tensor" and fields.inertia_uncertainty is not None:
            change = np.zeros((count, 3, 3))
            for i, j in _ELEMENTS:
                change[:, i, j] = change[:, j, i] = fields.inertia_uncertainty[i, j] * random.normal(size=count)
            second = second + np.trace(change, axis1=1, axis2=2)[:, None, None] / 2 * np.eye(3) - change
        else:
            raise SystemExit(f"{one.source.what} is not drawn")
    return mass, center, second


def _misplaced(
    node: Node, frames: tuple[Frame, ...], random: np.random.Generator, count: int
) -> Iterator[tuple[Float, Float, Float]]:
    """Yield the rotation (n, 3, 3), shift (n, 3) and origin (3,) of each copy; nothing where its place is certain."""
    fields = node.fields
    if fields is None or not (fields.position_uncertainty or fields.angle_uncertainty):
        return
    angle = math.radians(fields.angle_uncertainty or 0.0)
    shift = float(node.unit.metres) * (fields.position_uncertainty or 0.0)
    for frame in frames:
        turns = Rotation.from_rotvec(angle * random.normal(size=(count, 3))).as_matrix()
        yield turns, shift * random.normal(size=(count, 3)), _floats(frame)[1]


def _floats(frame: Frame) -> tuple[Float, Float]:
    turn = np.array([k / (1 << TURN_BITS) for k in frame.rotation]).reshape(3, 3)
    return turn, np.array([k / (1 << LENGTH_BITS) for k in frame.origin])


if __name__ == "__main__":
    main()
