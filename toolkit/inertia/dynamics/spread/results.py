"""What becomes of draws, gathered block by block: columns of N numbers, and percentiles at every instant."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float
from inertia.dynamics.spread.follow import FOLLOWED, STATES, Block, Task
from inertia.errors import UsageError
from inertia.records import dataclass

PERCENTILES = (5.0, 50.0, 95.0)
"""What is stated of a quantity where nothing else is asked for."""

_BINS = 4096
_DIGITS = 50  # binary ones of the largest value, below which no bin is
_SENTENCES = 1000  # that stay where the series do not


class Histogram:
    """How many values fell into bins [k 2ᵉ, (k + 1) 2ᵉ), e being the least for which 4096 bins hold all of them.

    Widths are powers of two, so that two neighbours make one bin of twice the width: the counts depend on the values
    alone, neither on their order nor on the blocks they come in. A percentile is the middle of a bin, half a width off
    at most, and a width is at most 1/2047 of the range of the values, or 2⁻⁴⁹ of the largest.

    >>> histogram = Histogram()
    >>> for block in (np.arange(700.0), np.arange(700.0, 1001.0)):
    ...     histogram.add(block)
    >>> histogram.percentiles([5.0, 50.0]).tolist(), histogram.width
    ([50.125, 500.125], 0.25)
    """

    def __init__(self) -> None:
        self._counts = np.zeros(0, dtype=np.int64)
        self._least, self._most = np.inf, -np.inf
        self._exponent = 0

    @property
    def width(self) -> float:
        """Of a bin."""
        return float(np.ldexp(1.0, self._exponent)) if self._counts.size else 0.0

    def add(self, values: Float) -> None:
        """Count values (m,), which are finite."""
        if not values.size:
            return
        least, most = min(self._least, float(values.min())), max(self._most, float(values.max()))
        exponent = int(np.frexp(max(abs(least), abs(most)))[1]) - _DIGITS
        while _place(most, exponent) - _place(least, exponent) >= _BINS:
            exponent += 1
        counts = np.zeros(_place(most, exponent) - _place(least, exponent) + 1, dtype=np.int64)
        if self._counts.size:
            shift = exponent - self._exponent
            old = (_place(self._least, self._exponent) + np.arange(self._counts.size)) >> shift
            np.add.at(counts, old - _place(least, exponent), self._counts)
        places = np.floor(np.ldexp(values, -exponent)).astype(np.int64) - _place(least, exponent)
        self._counts = counts + np.bincount(places, minlength=counts.size)
        self._least, self._most, self._exponent = least, most, exponent

    def percentiles(self, at: Sequence[float]) -> Float:
        """Return percentiles (p,) as `numpy.percentile` does, of values that are in the middle of their bins."""
        below = np.cumsum(self._counts)
        rank = np.asarray(at, dtype=np.float64) / 100.0 * (below[-1] - 1)
        low = np.floor(rank)
        first, second = (self._middle(np.searchsorted(below, each, side="right")) for each in (low, np.ceil(rank)))
        values: Float = first + (rank - low) * (second - first)
        return values

    def _middle(self, bins: NDArray[np.intp]) -> Float:
        middle: Float = np.ldexp(_place(self._least, self._exponent) + bins + 0.5, self._exponent)
        return np.asarray(np.clip(middle, self._least, self._most))


def _place(value: float, exponent: int) -> int:
    return int(np.floor(np.ldexp(value, -exponent)))


@dataclass(frozen=True, eq=False)
class Results:
    """What became of N draws at n instants.

    Attributes
    ----------
    quantities : {name: (N, n)} as asked for; rows of draws that were not followed are not numbers. None is there where
        they would take more memory than is granted: then `percentiles` between the ends are those of histograms
    ends, most : {name: (N,)}, each quantity at the end, and the largest that it is at the instants
    histograms : {name: one for each instant but the last}, where the quantities are not there
    state, model : (N,), by their numbers in `STATES` and `model_names`
    sentences : {draw: why it was not followed}; the first thousand where the quantities are not there
    reached : (N,) rad, the error of the attitude that each states
    events : {name: (N,) s} when it first happened
    turned : (N, 3) rad, rotation vector in space from the nominal attitude at the end; (0, 3) where nobody asks for it
    """

    quantities: Mapping[str, Float]
    ends: Mapping[str, Float]
    most: Mapping[str, Float]
    histograms: Mapping[str, Sequence[Histogram]]
    state: NDArray[np.uint8]
    model: NDArray[np.uint8]
    model_names: Sequence[str]
    sentences: Mapping[int, str]
    reached: Float
    events: Mapping[str, Float]
    turned: Float

    @cached_property
    def followed(self) -> Bool:
        """Which draws (N,) were followed."""
        return np.asarray(self.state == STATES.index(FOLLOWED))

    @property
    def states(self) -> tuple[str, ...]:
        """Of each draw: "followed"; "refused", where the numbers describe no body or scene; "not followed", where no
        model reached the accuracy."""
        return tuple(STATES[k] for k in self.state.tolist())

    @property
    def models(self) -> tuple[str, ...]:
        """The names of the models that ran, "" without."""
        return tuple(self.model_names[k] for k in self.model.tolist())

    @property
    def state_counts(self) -> dict[str, int]:
        """How many draws are in each state."""
        return _counts(self.state, STATES)

    @property
    def model_counts(self) -> dict[str, int]:
        """How many draws each model followed."""
        return {name: count for name, count in _counts(self.model, self.model_names).items() if name}

    def percentiles(self, name: str, at: Sequence[float] = PERCENTILES) -> Float:
        """Return percentiles (p, n) of a quantity over the draws that were followed and have it, at every instant.

        They are exact, or within half of `resolution` where the quantities are not there.
        """
        self._require(name)
        if name in self.histograms:
            between = [each.percentiles(at) for each in self.histograms[name]]
            return np.column_stack([*between, np.percentile(self._whole(self.ends[name], name), at)])
        return np.asarray(np.percentile(self._whole(self.quantities[name], name), at, axis=0))

    def resolution(self, name: str) -> Float:
        """Return the widths (n,) of the bins that `percentiles` of a quantity are read from; 0 where they are exact."""
        if name in self.histograms:
            return np.array([*(each.width for each in self.histograms[name]), 0.0])
        return np.zeros(self.quantities[name].shape[1])

    def largest(self, name: str, at: Sequence[float] = PERCENTILES) -> Float:
        """Return percentiles (p,) of the largest value that the quantity has at the instants of a draw."""
        self._require(name)
        return np.asarray(np.percentile(self._whole(self.most[name], name), at))

    def has(self, name: str) -> bool:
        """Whether some draw has a quantity at all instants."""
        return bool(np.isfinite(self.most[name]).any())

    def _whole(self, rows: Float, name: str) -> Float:
        return rows[np.isfinite(self.most[name])]

    def _require(self, name: str) -> None:
        if not self.has(name):
            raise UsageError(f"no draw has the quantity {name!r} at all instants")


def gathered(
    blocks: Iterator[Block], task: Task, count: int, time: Float, levels: Mapping[str, float], *, series: bool
) -> Results:
    """Return the results of all blocks of draws, which come in their order.

    Parameters
    ----------
    blocks : of draws; count : how many draws there are
    time : (n,) s; levels : {quantity: a level}, the first instant at which a draw reaches it becoming an event
    series : whether the quantities stay at all instants
    """
    names = task.names
    ends, most = ({name: np.full(count, np.nan) for name in names} for _ in range(2))
    quantities = {name: np.full((count, len(time)), np.nan) for name in names} if series else {}
    histograms = {} if series else {name: [Histogram() for _ in time[1:]] for name in names}
    reached = np.full(count, np.nan)
    turned = np.full((count if series or "deviation" in names else 0, 3), np.nan)
    state, model = np.zeros(count, dtype=np.uint8), np.zeros(count, dtype=np.uint8)
    models = [""]
    events: dict[str, Float] = {}
    crossings = {f"{name} reaches {level:g}": np.full(count, np.nan) for name, level in levels.items()}
    sentences: dict[int, str] = {}
    first = 0
    for block in blocks:
        rows = slice(first, first + len(block.states))
        state[rows] = [STATES.index(each) for each in block.states]
        models += [each for each in dict.fromkeys(block.model) if each not in models]
        model[rows] = [models.index(each) for each in block.model]
        reached[rows] = block.reached
        if len(turned):
            turned[rows] = block.turned
        for name, values in block.quantities.items():
            ends[name][rows], most[name][rows] = values[:, -1], values.max(axis=1)
            if series:
                quantities[name][rows] = values
                continue
            whole = values[np.isfinite(values).all(axis=1)]
            for histogram, column in zip(histograms[name], whole.T[:-1], strict=True):
                histogram.add(column)
        for name, instants in block.events.items():
            if name not in events:
                events[name] = np.full(count, np.nan)
            events[name][rows] = instants
        for (name, level), instants in zip(levels.items(), crossings.values(), strict=True):
            instants[rows] = _first_at(time, block.quantities[name], level)
        some = None if series else _SENTENCES - len(sentences)
        sentences |= {first + row: sentence for row, sentence in islice(block.sentences.items(), some)}
        first = rows.stop
    return Results(
        quantities=quantities,
        ends=ends,
        most=most,
        histograms=histograms,
        state=state,
        model=model,
        model_names=models,
        sentences=sentences,
        reached=reached,
        events=events | crossings,
        turned=turned,
    )


def _counts(numbers: NDArray[np.uint8], names: Sequence[str]) -> dict[str, int]:
    """Return how often there is each of the names, in the order in which they come first."""
    values, first, counts = np.unique(numbers, return_index=True, return_counts=True)
    return {names[values[k]]: int(counts[k]) for k in np.argsort(first)}


def _first_at(time: Float, rows: Float, level: float) -> Float:
    """Return when each row (N, n) first is at a level, or passes it, (N,); not a number where it never does."""
    above = rows - level
    met = (above * np.sign(above[:, :1]) <= 0) & np.isfinite(rows)
    (some,) = np.nonzero(met.any(axis=1))
    after = met[some].argmax(axis=1)
    before = np.maximum(after - 1, 0)
    low, high = above[some, before], above[some, after]
    share = np.divide(low, low - high, out=np.zeros(len(some)), where=low != high)
    first = np.full(len(rows), np.nan)
    first[some] = time[before] + share * (time[after] - time[before])
    return first
