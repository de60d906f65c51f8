"""Overlapping pairs of boxes: all of them, against every pair compared, in one order with the kernel and without."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest

from inertia import native
from inertia.arrays import Float
from inertia.mesh.geometry.boxes import BoxTree, overlapping


def boxes(rng: np.random.Generator, count: int, kind: str) -> tuple[Float, Float]:
    """Return boxes anywhere, on a lattice whose planes many share, or flat ones."""
    low = rng.random((count, 3))
    if kind == "on a lattice":
        low = np.round(6 * low) / 6
        return low, low + rng.integers(0, 3, (count, 3)) / 6
    return low, low + rng.random((count, 3)) * ([0.2, 0.2, 0.0] if kind == "flat" else 0.2)


def found(a: BoxTree, b: BoxTree | None, touching: bool) -> np.ndarray:
    pairs = list(overlapping(a, b, touching=touching))
    assert pairs[-1][2] == pytest.approx(1.0)
    assert all(now[2] <= later[2] for now, later in pairwise(pairs))
    return np.concatenate([np.column_stack(pair[:2]) for pair in pairs])


@pytest.fixture(params=["compiled", "numpy"])
def way(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    monkeypatch.setattr(native, "SHIPPED_ABOVE", 0)
    monkeypatch.setenv("INERTIA_NATIVE", "1" if request.param == "compiled" else "0")
    return request.param


@pytest.mark.parametrize("kind", ["anywhere", "on a lattice", "flat"])
@pytest.mark.parametrize(("many", "more"), [(1, 1), (1, 70), (70, 1), (200, 333)])
@pytest.mark.parametrize("touching", [False, True])
def test_all_pairs_are_found_once(way: str, kind: str, many: int, more: int, touching: bool) -> None:
    rng = np.random.default_rng(many + more)
    (low, high), (lower, higher) = boxes(rng, many, kind), boxes(rng, more, kind)
    group = rng.integers(0, 5, many)
    below = np.less_equal if touching else np.less
    for one, other, among in ((low, high, None), (lower, higher, 0), (low, high, group)):
        if among is None:
            tree, trees = BoxTree(low, high), BoxTree(lower, higher)
            meet = (below(low[:, None], higher) & below(lower, high[:, None])).all(axis=2)
        else:
            tree, trees = BoxTree(one, other, *([among] if isinstance(among, np.ndarray) else [])), None
            meet = np.triu((below(one[:, None], other) & below(one, other[:, None])).all(axis=2), 1)
            if isinstance(among, np.ndarray):
                meet &= among[:, None] != among
        assert sorted(map(tuple, found(tree, trees, touching).tolist())) == list(zip(*np.nonzero(meet), strict=True))


def test_order_and_progress_are_the_same_with_the_kernel_and_without(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(native, "SHIPPED_ABOVE", 0)
    rng = np.random.default_rng(3)
    low, high = boxes(rng, 9_000, "anywhere")
    tree, other = BoxTree(low, high, np.sort(rng.integers(0, 9, 9_000))), BoxTree(*boxes(rng, 500, "flat"))
    compiled = found(tree, None, True), found(tree, other, False)
    assert sum(map(len, compiled)) > 1 << 16  # which more than one piece is of
    monkeypatch.setenv("INERTIA_NATIVE", "0")
    for these, those in zip(compiled, (found(tree, None, True), found(tree, other, False)), strict=True):
        assert np.array_equal(these, those)
