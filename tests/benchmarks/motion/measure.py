"""Running every method on every motion: CPU time and error at the end."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from typing import Any

from inertia.errors import InertiaError

from .contestants import CONTESTANTS, Contestant
from .scenes import MOTIONS, Motion

LIMIT = 6.0
"""Seconds of CPU time that one run may be expected to take."""

ENOUGH, RUNS = 0.3, 7
"""A method is run again until this many seconds or runs are spent."""

Run = tuple[float, float, float]
"""(setting, seconds, error in rad)"""


def measure(say: Callable[[str], None], motions: tuple[Motion, ...] = MOTIONS) -> dict[str, Any]:
    """Return {motion: {revolutions: {method: [[setting, s, rad], …] or a reason}}}."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    result: dict[str, Any] = {}
    for motion in motions:
        fitting = [contestant for contestant in CONTESTANTS if contestant.fits(motion)]
        per_revolution: dict[tuple[str, float], float] = {}
        result[motion.name] = {}
        for revolutions in motion.revolutions:
            table = result[motion.name][str(revolutions)] = {}
            for contestant in fitting:
                runs = _runs(contestant, motion, revolutions, per_revolution)
                table[contestant.name] = runs or f"over {LIMIT:.0f} s"
            say(f"{motion.name}, {revolutions} revolutions")
    return result


def _runs(
    contestant: Contestant, motion: Motion, revolutions: int, per_revolution: dict[tuple[str, float], float]
) -> list[Run]:
    runs: list[Run] = []
    for setting in contestant.settings:
        key = contestant.name, setting
        if per_revolution.get(key, 0.0) * revolutions > LIMIT:
            continue
        call = contestant.prepare(motion, motion.duration(revolutions), setting)
        begin = time.process_time()
        try:
            attitude = call()
        except InertiaError:  # so coarse a setting that the motion runs away
            continue
        first = time.process_time() - begin
        spent: list[float] = []
        while first < LIMIT / 4 and len(spent) < RUNS and sum(spent) < ENOUGH:  # a first call compiles and loads
            begin = time.process_time()
            call()
            spent.append(time.process_time() - begin)
        seconds = min(spent or [first])
        per_revolution[key] = seconds / revolutions
        runs.append((setting, float(f"{seconds:.3g}"), float(f"{motion.error(revolutions, attitude):.3g}")))
    return runs
