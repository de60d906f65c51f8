"""Rows of a part made up for the tests of what is done with rows."""

import inertia
from inertia.mass.triangles.arithmetic import Arithmetic
from inertia.work_precision.machine import Machine
from inertia.work_precision.recommend import part_recommendations
from inertia.work_precision.rows import PartRow, Relative, Simplification, Skipped
from inertia.work_precision.stopwatch import Timing
from inertia.work_precision.trade import PartTrade
from inertia_meshes import path

BALL = inertia.MassProperties(2.0, 1.0, [0, 0, 0], [[0.8, 0, 0], [0, 0.8, 0], [0, 0, 0.8]])
NEEDLE = inertia.MassProperties(2.0, 1.0, [0, 0, 0], [[1e-6, 0, 0], [0, 1, 0], [0, 0, 1]])


def same(value: float) -> Relative:
    return Relative(value, value, value)


def whole(method: Arithmetic, seconds: float, bound: float) -> PartRow:
    time = Timing(seconds, 0.9 * seconds, 1.2 * seconds, 5)
    return PartRow(method, time, bound, 8000, None, BALL, same(bound / 100), same(bound))


def simpler(share: int, seconds: float, error: float, made: float = 1.0) -> PartRow:
    time = Timing(seconds, 0.9 * seconds, 1.2 * seconds, 5)
    simplification = Simplification(share, 1e-4 * share, made)
    return PartRow("float64", time, error, 8000 // share, simplification, BALL, same(error), same(1e-14))


ROWS = (
    whole("float64", 0.008, 3e-14),
    whole("double-double", 0.04, 1.2e-16),
    whole("exact", 0.4, 1.1e-16),
    simpler(2, 0.004, 5e-4),
    simpler(4, 0.002, 2e-3),
    simpler(8, 0.001, 8e-3),
    simpler(16, 0.0009, 0.2),
)


def made_up(
    accuracy: float | None = None, rows: tuple[PartRow, ...] = ROWS, skipped: tuple[Skipped, ...] = ()
) -> PartTrade:
    """Return a trade of made-up rows, times and machine."""
    return PartTrade(
        analysis=inertia.analyse(inertia.read(path("cube.stl")), 7850.0),
        accuracy=accuracy,
        machine=Machine("Difference Engine", 1, "3.11.0", "2.0.0", "Brass"),
        repeats=5,
        budget=30.0,
        steps={"closedness": Timing(0.0123, 0.012, 0.013, 5), "results": Timing(0.002, 0.002, 0.002, 5)},
        rows=rows,
        reference=ROWS[2],
        skipped=skipped,
        recommendations=part_recommendations(rows, skipped, accuracy),
    )
