"""The angles at which the bodies of a rotor are best put together, among those that flanges and keyways allow.

A body that is turned about the shaft by α turns what it brings to each tolerance plane by e^{iα}. The largest
|Σ v_b e^{iα_b}| over its limit is made least: by trying all ways where they are not too many, else by turning bodies
one by one and in pairs from several beginnings. No way leaves less in a plane than the longest vector is longer than
all others together.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from inertia.arrays import Float, Int
from inertia.balancing.unbalance import Complex

_ALL = 1_000_000  # ways that are tried one and all
_BEGINNINGS = 24
_GAIN = 1e-12


@dataclass(frozen=True, eq=False)
class Indexing:
    """How bodies are put together.

    Attributes
    ----------
    turns : (b,) rad, by which each body is turned from where its file has it
    left, as_filed : the largest |unbalance| over its limit, as indexed and as the files have it
    bound : no way leaves less
    ways : how many there are
    """

    turns: tuple[float, ...]
    left: float
    as_filed: float
    bound: float
    ways: int


def best_indexing(
    vectors: Complex, fixed: Complex, limits: Sequence[float], angles: Sequence[Sequence[float]]
) -> Indexing:
    """Return the best way to put bodies together.

    Parameters
    ----------
    vectors : (b, k) kg m, what each body brings to each plane as its file has it
    fixed : (k,) kg m, what does not turn
    limits : (k,) kg m
    angles : of each body, those that it may be turned by, rad

    >>> two = best_indexing(np.array([[1.0 + 0j], [1.0 + 0j]]), np.zeros(1, complex), [1.0], [[0.0], [0.0, math.pi]])
    >>> round(two.left, 9), two.as_filed, two.ways
    (0.0, 2.0, 2)
    """
    scaled, start = vectors / np.asarray(limits), fixed / np.asarray(limits)
    options = [each * np.exp(1j * np.asarray(turns))[:, None] for each, turns in zip(scaled, angles, strict=True)]
    ways = math.prod(len(turns) for turns in angles)
    choice = _of_all(options, start) if ways <= _ALL else _by_turning(options, start)
    made = start + sum(option[k] for option, k in zip(options, choice, strict=True))
    lengths = np.abs(np.concatenate([scaled, start[None]]))
    beyond = np.maximum(2 * lengths.max(axis=0) - lengths.sum(axis=0), 0.0)
    left = float(np.abs(made).max())
    return Indexing(
        turns=tuple(float(turns[k]) for turns, k in zip(angles, choice, strict=True)),
        left=left,
        as_filed=float(np.abs(start + scaled.sum(axis=0)).max()),
        bound=left if ways <= _ALL else float(beyond.max()),
        ways=ways,
    )


def _of_all(options: Sequence[Complex], start: Complex) -> tuple[int, ...]:
    sums: Complex = start[None]
    for option in options:
        sums = (sums[:, None] + option[None]).reshape(-1, len(start))
    best = int(np.abs(sums).max(axis=1).argmin())
    return tuple(int(k) for k in np.unravel_index(best, [len(option) for option in options]))


def _by_turning(options: Sequence[Complex], start: Complex) -> tuple[int, ...]:
    draw, best, least = np.random.default_rng(0), None, math.inf
    for _ in range(_BEGINNINGS):
        choice = np.array([draw.integers(len(option)) for option in options])
        left = _improved(options, start, choice)
        if left < least:
            best, least = choice, left
    assert best is not None
    return tuple(best.tolist())


def _improved(options: Sequence[Complex], start: Complex, choice: Int) -> float:
    """Turn bodies one by one and in pairs, in place, while that leaves less; return what is left."""
    left = math.inf
    while True:
        before = left
        for group in [*itertools.combinations(range(len(options)), 1), *itertools.combinations(range(len(options)), 2)]:
            rest = start + sum(options[n][choice[n]] for n in range(len(options)) if n not in group)
            sums: Complex = np.asarray(rest)[None]
            for n in group:
                sums = (sums[:, None] + options[n][None]).reshape(-1, len(start))
            worst: Float = np.abs(sums).max(axis=1)
            if worst.min() < left * (1 - _GAIN):
                left = float(worst.min())
                choice[list(group)] = np.unravel_index(int(worst.argmin()), [len(options[n]) for n in group])
        if not left < before * (1 - 1e-6):
            return left
