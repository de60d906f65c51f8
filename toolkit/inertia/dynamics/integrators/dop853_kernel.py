"""DOP853, compiled: the method of Dormand and Prince of order 8 with an error estimate of orders 5 and 3.

Imported only to be compiled (`inertia.native`); `scipy_methods` says when. Steps, their control and the dense output of
order 7 are those of `scipy.integrate.DOP853`, which stands in where nothing is compiled.

Hairer, Nørsett & Wanner, *Solving ODEs I*, §§ II.4–6.
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit
from scipy.integrate import DOP853

from inertia.dynamics.integrators.loop_kernel import through

STAGES, EXTENDED = 12, 16
A = np.zeros((EXTENDED, EXTENDED))
A[:STAGES, :STAGES], A[STAGES, :STAGES], A[STAGES + 1 :] = DOP853.A, DOP853.B, DOP853.A_EXTRA
C = np.array([*DOP853.C, 1.0, *DOP853.C_EXTRA])
E3, E5, D = DOP853.E3, DOP853.E5, DOP853.D

CLOCK, TRIAL, BEFORE, NOW, DENSE, SLOPES = 0, 1, 2, 3, 4, 11
ROWS = SLOPES + EXTENDED
"""Rows of the table: the time and the state at which the equations were looked at last, the states at both ends of the
step, the polynomial of the dense output, and the slopes at all stages."""

SAFETY, SHRINK, GROW = 0.9, 0.2, 10.0
LEAST = 10.0 * 2.0**-52  # of a step, relative to the time
FINEST = 100.0 * 2.0**-52  # of a tolerance

inline = njit(error_model="numpy", forceinline=True)


def dop853(rate, size):
    """Return the loop of DOP853 for equations of `size` numbers, of which the first four are a quaternion.

    `rate(problem, time, state, slope)` → bool writes the rate of a state, both (size,), in the problem's units; False
    where there is none. The loop takes `problem`, the arguments that kernels share from `times_at` on, and its own:
    tolerance, longest step, and where a table (ROWS, size) and the units (size,) of the state lie. It returns the
    evaluations of the rate; where a step could not be taken, rows `CLOCK` and `TRIAL` say at which time and state.
    """

    @inline
    def look(work, time, to):
        problem, table = work[0], work[1]
        table[CLOCK, 0] = time
        return rate(problem, time, table[TRIAL], table[SLOPES + to])

    @inline
    def stage(work, number, begin, length):
        """Write the slope of a stage; the state there stays in its row."""
        table = work[1]
        for j in range(size):
            table[TRIAL, j] = 0.0
        for m in range(number):
            for j in range(size):
                table[TRIAL, j] += A[number, m] * table[SLOPES + m, j]
        for j in range(size):
            table[TRIAL, j] = table[BEFORE, j] + length * table[TRIAL, j]
        return look(work, begin + C[number] * length, number)

    @inline
    def first_length(work):
        """Return the length of the first step, and whether the equations allow one; § II.4."""
        _, table, tolerance, longest, bound, _ = work
        for j in range(size):
            table[TRIAL, j] = table[NOW, j]
        if not look(work, 0.0, STAGES):
            return 0.0, False
        there = speed = 0.0
        for j in range(size):
            scale = tolerance + abs(table[NOW, j]) * tolerance
            there += (table[NOW, j] / scale) ** 2
            speed += (table[SLOPES + STAGES, j] / scale) ** 2
        there, speed = np.sqrt(there / size), np.sqrt(speed / size)
        length = min(1e-6 if there < 1e-5 or speed < 1e-5 else 0.01 * there / speed, bound)
        for j in range(size):
            table[TRIAL, j] = table[NOW, j] + length * table[SLOPES + STAGES, j]
        if not look(work, length, 0):
            return 0.0, False
        bend = 0.0
        for j in range(size):
            scale = tolerance + abs(table[NOW, j]) * tolerance
            bend += ((table[SLOPES, j] - table[SLOPES + STAGES, j]) / scale) ** 2
        bend = np.sqrt(bend / size) / length
        if speed <= 1e-15 and bend <= 1e-15:
            other = max(1e-6, 1e-3 * length)
        else:
            other = np.sqrt(np.sqrt(np.sqrt(0.01 / max(speed, bend))))
        return min(100.0 * length, other, bound, longest), True

    @inline
    def error_of(work, length):
        """Return the error of the step in units of the tolerance, and leave its end beside its begin."""
        table, tolerance = work[1], work[2]
        fifth = third = 0.0
        for j in range(size):
            table[NOW, j] = table[TRIAL, j]
            scale = tolerance + max(abs(table[BEFORE, j]), abs(table[NOW, j])) * tolerance
            five = three = 0.0
            for m in range(STAGES + 1):  # the last one counts nothing, but where it is not finite
                five += E5[m] * table[SLOPES + m, j]
                three += E3[m] * table[SLOPES + m, j]
            fifth += (five / scale) ** 2
            third += (three / scale) ** 2
        if fifth == 0.0 and third == 0.0:
            return 0.0
        return length * fifth / np.sqrt((fifth + 0.01 * third) * size)

    @inline
    def expand(work, begin, length):
        """Write the polynomial of the dense output, and say whether the equations allow it."""
        table = work[1]
        for number in range(STAGES + 1, EXTENDED):
            if not stage(work, number, begin, length):
                return False
        for j in range(size):
            change, slope = table[NOW, j] - table[BEFORE, j], length * table[SLOPES, j]
            table[DENSE, j], table[DENSE + 1, j] = change, slope - change
            table[DENSE + 2, j] = 2.0 * change - (slope + length * table[SLOPES + STAGES, j])
            for n in range(len(D)):
                total = 0.0
                for m in range(EXTENDED):
                    total += D[n, m] * table[SLOPES + m, j]
                table[DENSE + 3 + n, j] = length * total
        return True

    @inline
    def aim(work, clock, row, target):
        return clock

    @inline
    def short(clock, target):
        return clock[1] < target

    @inline
    def step(work, clock, state, target):
        _, table, _, longest, bound, _ = work
        _, begin, length = clock
        looks = 0
        if length == 0.0:
            length, possible = first_length(work)
            looks = 2
            if not possible:
                return clock, state, 0
        for j in range(size):
            table[BEFORE, j] = table[NOW, j]
            table[SLOPES, j] = table[SLOPES + STAGES, j]
        least = LEAST * begin
        length = max(min(length, longest), least)
        rejected = False
        while True:
            if not (length >= least and length > 0.0):
                return clock, state, 0
            end = min(begin + length, bound)
            length = end - begin
            for number in range(1, STAGES + 1):
                if not stage(work, number, begin, length):
                    return clock, state, 0
            looks += STAGES
            error = error_of(work, length)
            factor = GROW if error == 0.0 else SAFETY / np.sqrt(np.sqrt(np.sqrt(error)))
            if error < 1.0:
                break
            rejected = True
            length *= factor if factor > SHRINK else SHRINK
        if end >= target:
            looks += EXTENDED - STAGES - 1
            if not expand(work, begin, length):
                return clock, state, 0
        return (begin, end, length * min(factor, 1.0 if rejected else GROW)), state, looks

    @inline
    def value(work, clock, state, target):
        return (target - clock[0]) / (clock[1] - clock[0])

    @inline
    def read(work, row, rate):
        table, unit = work[1], work[-1]
        for j in range(size):
            table[NOW, j] = row[j] / unit[j]
        return 0.0

    @inline
    def write(work, row, rate, share):
        table, unit = work[1], work[-1]
        for j in range(size):
            total = 0.0
            for n in range(SLOPES - DENSE - 1, -1, -1):
                total = (total + table[DENSE + n, j]) * (share if n % 2 == 0 else 1.0 - share)
            row[j] = (total + table[BEFORE, j]) * unit[j]
        length = np.sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2] + row[3] * row[3])
        for j in range(4):
            row[j] /= length

    follow = through(inline, (0.0, 0.0, 0.0), aim, short, step, value, (size, read, write))

    @inline
    def run(problem, piece, tolerance, longest, table_at, unit_at):
        table = carray(table_at, (ROWS, size), np.float64)
        unit = carray(unit_at, (size,), np.float64)
        work = problem, table, max(tolerance, FINEST), longest, (piece[3] - piece[2]) * piece[4], unit
        return follow(work, piece)

    return run
