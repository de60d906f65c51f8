"""`Run` and `Plan` → the documents ``inertia/run/1`` and ``inertia/plan/1``."""

from __future__ import annotations

from typing import Any

import numpy as np

from inertia.dynamics.plan import Plan
from inertia.dynamics.run import Invariant, Run
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.sensitivity import attitude_uncertainty


def plan_document(scene: Scene, plan: Plan) -> dict[str, Any]:
    """Return what would run, and why, as ``inertia/plan/1``."""
    return {
        "schema": "inertia/plan/1",
        "scene": scene.name,
        "model": plan.model,
        "method": plan.method,
        "why": list(plan.why),
        "body": _body_document(scene),
        "moments": plan.moments.tolist(),
        "axes": plan.axes.tolist(),
        "cost": plan.candidate.cost,
    }


def run_document(run: Run) -> dict[str, Any]:
    """Return a run as ``inertia/run/1``; SI units, attitudes from part axes to space axes.

    What goes with the time is an array still: a list of its numbers takes ten times the memory.
    """
    moved = attitude_uncertainty(run)
    document: dict[str, Any] = {
        "schema": "inertia/run/1",
        "scene": run.scene.name,
        "model": run.model,
        "why": list(run.why),
        "accuracy": {
            "requested": run.error.requested,
            "reached": run.error.reached,
            "method": run.error.method,
            "inputs": run.error.inputs,
            "until": min(run.error.until, run.scene.run.duration),
            **({} if moved is None else {"standard_uncertainty": moved}),
        },
        "steps": run.steps,
        "body": _body_document(run.scene),
        "invariants": {name: _invariant_document(invariant) for name, invariant in run.invariants.items()},
        "remarks": list(run.remarks),
        "events": [{"name": event.name, "time": event.time, "what": event.what} for event in run.events],
        "warnings": list(run.warnings),
        "time": run.time,
        "attitude": run.attitude,
        "angular_velocity": run.angular_velocity,
        "angular_momentum": run.angular_momentum,
        "energy": run.energy,
    }
    if run.position is not None:
        document["position"] = run.position
    document["quantities"] = {name: np.asarray(values) for name, values in run.quantities.items()}
    return document


def _body_document(scene: Scene) -> dict[str, Any]:
    body = scene.body
    document = {
        "part": None if scene.body.part is None else scene.body.part.source.path,
        "mass": body.mass,
        "center_of_mass": body.center_of_mass.tolist(),
        "inertia": body.inertia.tolist(),
        "principal_moments": body.moments.tolist(),
        "principal_axes": body.axes.tolist(),
        "class": body.principal.kind,
    }
    if scene.body.assembly is not None:
        document["parts"] = [part.name for part in scene.body.assembly.parts]
    return document


def _invariant_document(invariant: Invariant) -> dict[str, Any]:
    return {"initial": invariant.initial.tolist(), "largest_relative_drift": invariant.largest_relative_drift}
