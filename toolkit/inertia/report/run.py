"""`Run` and `Plan` → text, and the documents ``inertia/run/1`` and ``inertia/plan/1``."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.plan import Plan
from inertia.dynamics.run import Invariant, Run
from inertia.dynamics.scene.body import SceneBody
from inertia.dynamics.scene.document import Scene
from inertia.report.numerals import LABEL, cleared, number, row

_WIDTH = 120
_LISTED = 6  # events in the text
_ROUNDING = 1e-15  # of the largest component of a vector: below it, a component is printed as 0
_NEGLIGIBLE = 1e-13  # of the largest entry of a series: likewise
_UNITS = {
    "energy": "J",
    "work": "J",
    "moments": "kg m²",
    "joint values": "rad or m",
    "p_phi": "kg m²/s",
    "p_psi": "kg m²/s",
    "angular momentum": "kg m²/s",
    "Appell–Korteweg": "rad/s",
    "precession": "rad/s",
    "cone": "rad",
    "period": "s",
    "rate": "rad/s",
    "theta": "rad",
    "phi": "rad",
    "psi": "rad",
    "contact force": "N",
    "contact": "m",
    "center of mass": "m",
}
"""What quantities and invariants are printed in: the first of these words that is in the name decides."""
_STARTS_IN = {"principal": "along the principal axes", "part": "along the part axes", "space": "along the space axes"}


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


def plan_text(scene: Scene, plan: Plan) -> str:
    """Return what would run, and why, as lines of text."""
    return "\n".join([*_scene_lines(scene), "", *_model_lines(plan.model, plan.why)])


def run_document(run: Run) -> dict[str, Any]:
    """Return a run as ``inertia/run/1``; SI units, attitudes from part axes to space axes."""
    document: dict[str, Any] = {
        "schema": "inertia/run/1",
        "scene": run.scene.name,
        "model": run.model,
        "why": list(run.why),
        "accuracy": {"requested": run.error.requested, "reached": run.error.reached, "method": run.error.method},
        "steps": run.steps,
        "body": _body_document(run.scene),
        "invariants": {name: _invariant_document(kept) for name, kept in run.invariants.items()},
        "remarks": list(run.remarks),
        "events": [{"name": event.name, "time": event.time, "what": event.what} for event in run.events],
        "warnings": list(run.warnings),
        "time": run.time.tolist(),
        "attitude": run.attitude.tolist(),
        "angular_velocity": run.angular_velocity.tolist(),
        "angular_momentum": run.angular_momentum.tolist(),
        "energy": run.energy.tolist(),
    }
    if run.position is not None:
        document["position"] = run.position.tolist()
    document["quantities"] = {name: _finite(np.asarray(values)) for name, values in run.quantities.items()}
    return document


def _body_document(scene: Scene) -> dict[str, Any]:
    body = scene.body.body
    document = {
        "part": None if scene.body.part is None else scene.body.part.source.path,
        "mass": body.mass,
        "center_of_mass": body.center_of_mass.tolist(),
        "inertia": body.inertia.tolist(),
        "principal_moments": body.principal.moments.tolist(),
        "principal_axes": scene.body.axes.tolist(),
        "class": body.principal.kind,
    }
    if scene.body.assembly is not None:
        document["parts"] = [part.name for part in scene.body.assembly.parts]
    return document


def _invariant_document(kept: Invariant) -> dict[str, Any]:
    return {"initial": kept.initial.tolist(), "largest_relative_drift": kept.largest_relative_drift}


def _finite(values: Float) -> Any:
    """Return an array as lists; JSON knows no infinity, so what is not finite becomes null."""
    if np.isfinite(values).all():
        return values.tolist()
    return np.where(np.isfinite(values), values, None).tolist()  # type: ignore[call-overload]


def run_text(run: Run) -> str:
    """Return a run as lines of text."""
    blocks = [
        list(_scene_lines(run.scene)),
        list(_model_lines(run.model, run.why)),
        list(_accuracy_lines(run)),
        [line for k, remark in enumerate(run.remarks) for line in _wrapped("" if k else "Motion", remark)],
        list(_quantity_lines(run)),
        list(_event_lines(run)),
        list(_state_lines(run)),
        [line for warning in run.warnings for line in _wrapped("Note", warning)],
    ]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _scene_lines(scene: Scene) -> Iterator[str]:
    body, settings = scene.body.body, scene.run
    if scene.body.part is None or scene.body.part.name != scene.name:
        yield row("Scene", scene.name)
    if scene.body.part is not None:
        yield row("Part", scene.body.part.name)
    if scene.body.assembly is not None:
        joints = len(scene.body.assembly.joints)
        names = ", ".join(part.name for part in scene.body.assembly.parts)
        yield from _wrapped("Parts", f"{names} ({joints} {'joint' if joints == 1 else 'joints'}); at the start:")
    if body.mass is not None:
        yield row("Mass", f"{number(body.mass)} kg")
        bound = _center_bound(scene.body)
        center = ", ".join(number(cleared(value, bound)) for value in body.center_of_mass.tolist())
        yield row("Centre of mass", f"{center} m")
    yield row("Moments", f"{_listed(scene.body.moments)} kg m² ({body.principal.kind})")
    if scene.constraint.kind == "fixed_point":
        yield row("Held at", f"{_listed(scene.constraint.fixed_point)} m of the part axes")
    if scene.constraint.kind == "rolling":
        yield row("Rolls", f"on a rim of radius {number(scene.constraint.radius or 0.0)} m")
    for load in scene.applied_loads:
        yield row("Load", load.described(lambda values: _listed(np.atleast_1d(values))))
    spin = scene.start.angular_velocity
    yield row("Spin", f"{_listed(spin)} rad/s {_STARTS_IN[scene.start.frame]}")
    if scene.start.attitude[3] != 1:
        yield row("Attitude", f"{_listed(scene.start.attitude)} (x, y, z, w; part axes to space)")
    yield row("Run", f"{number(settings.duration)} s, {settings.samples} samples")


def _center_bound(body: SceneBody) -> float:
    """Return m: a coordinate of the centre of mass below it is printed as 0."""
    if body.properties is not None:
        return body.properties.error.center_of_mass
    if body.assembly is None:
        return 0.0
    return _ROUNDING * max(float(np.abs(part.center_of_mass).max()) for part in body.assembly.parts)


def _model_lines(model: str, why: Iterable[str]) -> Iterator[str]:
    yield row("Model", model)
    for k, sentence in enumerate(why):
        yield from _wrapped("" if k else "Why", sentence)


def _accuracy_lines(run: Run) -> Iterator[str]:
    error = run.error
    steps = f", {run.steps} steps" if run.steps else ""
    yield from _wrapped("Method", f"{error.method}{steps}")
    yield row("Accuracy", f"attitude to {error.reached:.2g} rad, {error.requested:g} rad asked for")
    for k, (name, kept) in enumerate(run.invariants.items()):
        held = f"{name} {_listed(np.atleast_1d(kept.initial))}{_unit(name)}, drift {kept.largest_relative_drift:.2g}"
        yield row("" if k else "Kept", held)
    if "energy" not in run.invariants:
        yield row("Energy", f"{number(run.energy[0])} J at the start, {number(run.energy[-1])} J at the end")


def _quantity_lines(run: Run) -> Iterator[str]:
    """Yield numbers as they are, and series by where they lie; series of matrices are for the document only."""
    names = {name: np.asarray(values) for name, values in run.quantities.items()}
    lines = [(name, _extent(values) + _unit(name)) for name, values in names.items() if values.size and values.ndim < 3]
    width = max([LABEL, *(len(name) + 2 for name, _ in lines)])
    for name, said in lines:
        yield f"{name[:1].upper() + name[1:]:<{width}}{said}"


def _extent(values: Float) -> str:
    if values.size == 1:
        return number(values.item()) if math.isfinite(values.item()) else "none"
    bound = _NEGLIGIBLE * float(np.abs(values).max())
    if values.ndim == 1:
        return _between(values, bound)
    return ", ".join(_between(column, bound) for column in values.T)


def _between(values: Float, bound: float) -> str:
    low, high = (number(cleared(float(end), bound)) for end in (values.min(), values.max()))
    return low if low == high else f"{low} … {high}"


def _event_lines(run: Run) -> Iterator[str]:
    for k, event in enumerate(run.events[:_LISTED]):
        instant = cleared(event.time, _ROUNDING * run.scene.run.duration)
        yield from _wrapped("" if k else "Events", f"{instant:.9g} s  {event.name}: {event.what}")
    if len(run.events) > _LISTED:
        yield row("", f"… and {len(run.events) - _LISTED} more")


def _state_lines(run: Run) -> Iterator[str]:
    yield row("At the end", f"t = {number(run.time[-1])} s")
    yield row("  attitude", f"{_listed(run.attitude[-1])} (x, y, z, w; part axes to space)")
    yield row("  spin", f"{_listed(run.angular_velocity[-1])} rad/s along the part axes")
    if run.position is not None:
        yield row("  position", f"{_listed(run.position[-1])} m, of the centre of mass in space")


def _listed(values: Float) -> str:
    bound = _ROUNDING * float(np.abs(values).max())
    return ", ".join(number(cleared(value, bound)) for value in values.tolist())


def _unit(name: str) -> str:
    return next((f" {unit}" for word, unit in _UNITS.items() if word in name), "")


def _wrapped(label: str, sentence: str) -> Iterator[str]:
    for k, line in enumerate(textwrap.wrap(sentence, _WIDTH - LABEL, break_long_words=False)):
        yield row("" if k else label, line)
