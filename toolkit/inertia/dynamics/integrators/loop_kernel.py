"""The compiled loop over the samples of a run, into which the step of each method is built.

Imported only to be compiled (`inertia.native`); `loop` says what it does, and does the same where nothing is compiled.
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

HEAD, VECTOR = 10, 17


@njit(error_model="numpy", forceinline=True)
def read(work, row, rate):
    """Return the state (x, y, z, w, ω₁, ω₂, ω₃) of a row, in units of time 1/rate."""
    return row[0], row[1], row[2], row[3], row[4] / rate, row[5] / rate, row[6] / rate


@njit(error_model="numpy", forceinline=True)
def write(work, row, rate, state):
    """Write it into a row."""
    x, y, z, w, p, q, r = state
    row[0], row[1], row[2], row[3] = x, y, z, w
    row[4], row[5], row[6] = p * rate, q * rate, r * rate


def through(inline, clock_at_start, aim, short, step, value, form=(7, read, write)):
    """Return the loop of a method, to be called by a kernel; `inline` is the decorator that compiles it.

    A method says where it is by a `clock` of numbers of its own, `clock_at_start` at first, and works on `work`, a
    tuple of its own arrays and numbers. Its functions are

        aim(work, clock, row, target)  → clock         before the steps to the sample `row`
        short(clock, target)           → bool          whether `target` lies beyond the last step
        step(work, clock, state, target) → clock, state, int   a step, and as how many it counts: none if it cannot be
        value(work, clock, state, target) → state      at a `target` within the last step

    Targets are in units of time 1/rate. What a state is, `form` says: how many numbers a row of it has, and what reads
    and writes one.
    """
    size, read, write = form

    @inline
    def follow(work, piece):
        """Take the state in the first row of `rows` (samples + 1, size) to each sample and to the end, a row each.

        Return the steps; −1 where one cannot be taken, −2 where they are more than `limit`.
        """
        times_at, samples, start, end, rate, limit, rows_at = piece
        times = carray(times_at, (samples,), np.float64)
        rows = carray(rows_at, (samples + 1, size), np.float64)
        state = read(work, rows[0], rate)
        clock = clock_at_start
        steps = 0
        for sample in range(samples + 1):
            target = ((times[sample] if sample < samples else end) - start) * rate
            clock = aim(work, clock, sample, target)
            while short(clock, target):
                clock, state, taken = step(work, clock, state, target)
                if taken == 0:
                    return -1
                steps += taken
                if steps > limit:
                    return -2
            write(work, rows[sample], rate, value(work, clock, state, target))
        return steps

    return follow


def equal_steps(step):
    """Return the loop of a method whose steps are of equal length between samples.

    `step(work, time, length, first, last, state)` → state: `first` and `last` say whether it begins at a sample, ends
    at one. `work` begins with the counts of steps, (samples + 1,).
    """
    inline = njit(error_model="numpy", forceinline=True)

    @inline
    def aim(work, clock, row, target):
        begin, count = clock[0], work[0][row]
        return target, begin, ((target - begin) / count if count > 0 else 0.0), 0, count

    @inline
    def short(clock, target):
        return clock[3] < clock[4]

    @inline
    def take(work, clock, state, target):
        end, begin, length, number, count = clock
        state = step(work, begin + number * length, length, number == 0, number + 1 == count, state)
        return (end, begin, length, number + 1, count), state, 1

    @inline
    def value(work, clock, state, target):
        return state

    return through(inline, (0.0, 0.0, 0.0, 0, 0), aim, short, take, value)
