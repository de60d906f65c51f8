"""Rows of a scene made up for the tests of what is done with rows."""

from tests.dynamics.scenes import scene

from inertia.work_precision.machine import Machine
from inertia.work_precision.recommend import scene_recommendations
from inertia.work_precision.rows import SceneRow, Skipped
from inertia.work_precision.stopwatch import Timing
from inertia.work_precision.trade import SceneTrade

LADDER = (1e-3, 1e-5, 1e-7, 1e-9)
CLOSED = "closed form: Jacobi elliptic functions"


def stepped(method: str, asked: float, seconds: float, error: float, *, planned: bool = False) -> SceneRow:
    time = Timing(seconds, 0.9 * seconds, 1.2 * seconds, 5)
    return SceneRow(method, time, error, "Euler equations", (asked,), planned, 800, 2 * error, error)


def closed(seconds: float = 0.015, asked: tuple[float, ...] = LADDER) -> SceneRow:
    time = Timing(seconds, seconds, seconds, 5)
    return SceneRow(CLOSED, time, 4e-15, "asymmetric top", asked, True, 0, 4e-15, None)


ROWS = (
    closed(),
    stepped("Taylor", 1e-3, 0.003, 2e-5),
    stepped("Taylor", 1e-5, 0.004, 3e-8),
    stepped("Taylor", 1e-9, 0.014, 1e-12),
    stepped("RK4", 1e-3, 0.008, 1e-4),
)


def made_up(accuracy: float | None = None, rows: tuple[SceneRow, ...] = ROWS) -> SceneTrade:
    """Return a trade of made-up rows, times and machine."""
    return SceneTrade(
        scene=scene(run__accuracy=1e-9),
        accuracy=accuracy,
        machine=Machine("Difference Engine", 1, "3.11.0", "2.0.0", "Brass"),
        repeats=5,
        budget=30.0,
        rows=rows,
        reference=rows[0],
        skipped=(
            Skipped("Radau at 1e-05 rad and finer", "it does not fit into the budget", 12.0),
            Skipped("splitting 2 at 1e-09 rad", "splitting 2 reached 2e-9 rad"),
            Skipped("splitting 4 at 1e-09 rad", "splitting 2 reached 2e-9 rad"),
        ),
        recommendations=scene_recommendations(rows, LADDER, accuracy),
    )
