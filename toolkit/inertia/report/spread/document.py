"""`Ensemble` → the document ``inertia/ensemble/1``."""

from __future__ import annotations

from typing import Any

import numpy as np

from inertia.dynamics.spread.ensemble import Ensemble
from inertia.dynamics.spread.results import PERCENTILES


def ensemble_document(ensemble: Ensemble) -> dict[str, Any]:
    """Return an ensemble as ``inertia/ensemble/1``; SI units, radians."""
    nominal = ensemble.nominal
    return {
        "schema": "inertia/ensemble/1",
        "scene": ensemble.scene.name,
        "inputs": [{"path": each.path, "law": each.law, "figures": each.figures.tolist()} for each in ensemble.inputs],
        "draws": len(ensemble.values),
        "seed": ensemble.seed,
        "states": ensemble.state_counts,
        "sentences": {str(draw): sentence for draw, sentence in ensemble.sentences.items()},
        "models": ensemble.model_counts,
        "accuracy": {"requested": nominal.error.requested, "reached": float(np.nanmax(ensemble.reached))},
        "time": ensemble.time.tolist(),
        "quantities": {name: _quantity(ensemble, name) for name in ensemble.ends},
        "events": {name: _instants(ensemble, name) for name in ensemble.events},
    }


def _quantity(ensemble: Ensemble, name: str) -> dict[str, Any]:
    if not ensemble.has(name):
        return {"percentiles": {}, "largest": {}, "drivers": None}
    drivers = ensemble.drivers(name)
    over_time, largest = ensemble.percentiles(name), ensemble.largest(name)
    return {
        "percentiles": {f"{at:g}": row.tolist() for at, row in zip(PERCENTILES, over_time, strict=True)},
        "resolution": float(ensemble.resolution(name).max()),
        "largest": {f"{at:g}": value for at, value in zip(PERCENTILES, largest.tolist(), strict=True)},
        "drivers": None
        if drivers is None
        else {
            "share": _by_path(ensemble, drivers.share.tolist()),
            "rank": _by_path(ensemble, drivers.rank.tolist()),
            "explained": drivers.explained,
        },
    }


def _by_path(ensemble: Ensemble, figures: list[float]) -> dict[str, float]:
    return {each.path: figure for each, figure in zip(ensemble.inputs, figures, strict=True)}


def _instants(ensemble: Ensemble, name: str) -> dict[str, Any]:
    first = ensemble.events[name]
    met = first[np.isfinite(first)]
    share = len(met) / int(ensemble.followed.sum())
    instants = np.percentile(met, PERCENTILES).tolist() if met.size else []
    return {"share": share, "first": {f"{at:g}": t for at, t in zip(PERCENTILES, instants, strict=False)}}
