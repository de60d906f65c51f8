"""The compiled loop over the samples of a run, into which the step of each method is built.

Imported only to be compiled (`inertia.native`); `loop` says what it does, and does the same where nothing is compiled.
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

HEAD, VECTOR = 10, 17


def through(inline, clock_at_start, aim, short, step, value):
    """Return the loop of a method, to be called by a kernel; `inline` is the decorator that compiles it.

    A method says where it is by a `clock` of numbers of its own, `clock_at_start` at first, and works on `work`, a
    tuple of its own arrays and numbers. Its functions are

        aim(work, clock, row, target)  → clock         before the steps to the sample `row`
        short(clock, target)           → bool          whether `target` lies beyond the last step
        step(work, clock, state)       → clock, state, bool    a step, and whether it could be taken
        value(work, clock, state, target) → state      at a `target` within the last step

    A state is (x, y, z, w, ω₁, ω₂, ω₃), in units of time 1/rate, as targets are.
    """

    @inline
    def follow(work, piece):
        """Take the state in the first row of `rows` (samples + 1, 7) to each sample and to the end, a row each.

        Return the steps; −1 where one cannot be taken, −2 where they are more than `limit`.
        """
        times_at, samples, start, end, rate, limit, rows_at = piece
        times = carray(times_at, (samples,), np.float64)
        rows = carray(rows_at, (samples + 1, 7), np.float64)
        row = rows[0]
        state = row[0], row[1], row[2], row[3], row[4] / rate, row[5] / rate, row[6] / rate
        clock = clock_at_start
        steps = 0
        for sample in range(samples + 1):
            target = ((times[sample] if sample < samples else end) - start) * rate
            clock = aim(work, clock, sample, target)
            while short(clock, target):
                clock, state, fine = step(work, clock, state)
                steps += 1
                if not fine:
                    return -1
                if steps > limit:
                    return -2
            x, y, z, w, p, q, r = value(work, clock, state, target)
            row = rows[sample]
            row[0], row[1], row[2], row[3] = x, y, z, w
            row[4], row[5], row[6] = p * rate, q * rate, r * rate
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
    def take(work, clock, state):
        end, begin, length, number, count = clock
        state = step(work, begin + number * length, length, number == 0, number + 1 == count, state)
        return (end, begin, length, number + 1, count), state, True

    @inline
    def value(work, clock, state, target):
        return state

    return through(inline, (0.0, 0.0, 0.0, 0, 0), aim, short, take, value)
