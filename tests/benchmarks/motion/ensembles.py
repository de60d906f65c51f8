"""Many free bodies in one call, on one core."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from inertia.dynamics.integrators.ensemble import step_ensemble
from inertia.dynamics.models.free.motion import free_ensemble

MOMENTS = (1.0, 2.0, 3.0)
ROUNDS = 5


def ensembles() -> dict[str, float]:
    """Return bodies a second, samples a second and body-steps a second: the best of some runs."""
    spins = np.random.default_rng(5).normal(size=(100_000, 3))
    samples = np.linspace(0.0, 100.0, 1000)
    return {
        "closed form, bodies a second": _rate(len(spins), lambda: free_ensemble(MOMENTS, spins, [100.0])),
        "closed form, samples a second": _rate(1_000_000, lambda: free_ensemble(MOMENTS, spins[:1000], samples)),
        "stepping (RK4), body-steps a second": _rate(
            16_384 * 2000, lambda: step_ensemble(MOMENTS, spins[:16_384], 100.0, 2000)
        ),
    }


def _rate(count: int, run: Callable[[], Any]) -> float:
    run()
    seconds = []
    for _ in range(ROUNDS):
        begin = time.process_time()
        run()
        seconds.append(time.process_time() - begin)
    return float(f"{count / min(seconds):.3g}")
