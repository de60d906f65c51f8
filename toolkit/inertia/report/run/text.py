"""`Run` and `Plan` → lines of text."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.columns import unit_of
from inertia.dynamics.plan import Plan
from inertia.dynamics.run import Run
from inertia.dynamics.scene.body import SceneBody
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.sensitivity import attitude_uncertainty
from inertia.report.numerals import LABEL, cleared, number, row, wrapped

_LISTED = 6  # events in the text
_ROUNDING = 1e-15  # of the largest component of a vector, or rad: below it, a component is printed as 0
_NEGLIGIBLE = 1e-13  # of the largest entry of a series: likewise
_STARTS_IN = {"principal": "along the principal axes", "part": "along the part axes", "space": "along the space axes"}


def plan_text(scene: Scene, plan: Plan) -> str:
    """Return what would run, and why, as lines of text."""
    return "\n".join([*_scene_lines(scene), "", *_model_lines(plan.model, plan.why)])


def run_text(run: Run) -> str:
    """Return a run as lines of text."""
    blocks = [
        list(_scene_lines(run.scene)),
        list(_model_lines(run.model, run.why)),
        list(_accuracy_lines(run)),
        [line for k, remark in enumerate(run.remarks) for line in wrapped("" if k else "Motion", remark)],
        list(_quantity_lines(run)),
        list(_event_lines(run)),
        list(_state_lines(run)),
        [line for warning in run.warnings for line in wrapped("Note", warning)],
    ]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _scene_lines(scene: Scene) -> Iterator[str]:
    body, settings = scene.body, scene.run
    if scene.body.part is None or scene.body.part.name != scene.name:
        yield row("Scene", scene.name)
    if scene.body.part is not None:
        yield row("Part", scene.body.part.name)
    if scene.body.assembly is not None:
        joints = len(scene.body.assembly.joints)
        names = ", ".join(part.name for part in scene.body.assembly.parts)
        yield from wrapped("Parts", f"{names} ({joints} {'joint' if joints == 1 else 'joints'}); at the start:")
    if body.mass is not None:
        yield row("Mass", f"{number(body.mass)} kg")
        bound = _center_bound(scene.body)
        center = ", ".join(number(cleared(value, bound)) for value in body.center_of_mass.tolist())
        yield row("Centre of mass", f"{center} m")
    yield row("Moments", f"{_listed(scene.body.moments)} kg m² ({body.principal.kind})")
    if scene.constraint.kind == "fixed_point":
        yield row("Held at", f"{_listed(scene.constraint.fixed_point)} m of the part axes")
    if scene.constraint.kind == "hinge":
        where = _listed(scene.constraint.fixed_point)
        yield row("On an axle", f"through {where} m along {_listed(np.asarray(scene.constraint.axis))}, part axes")
    if scene.constraint.kind == "rolling":
        yield row("Rolls", f"on a rim of radius {number(scene.constraint.radius or 0.0)} m")
    if scene.constraint.kind == "sliding":
        held = scene.constraint
        ball = f"a ball of radius {number(held.radius or 0.0)} m about {_listed(held.fixed_point)} m of the part axes"
        yield row("Slides", f"{ball}, friction {number(held.friction or 0.0)}")
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
        yield from wrapped("" if k else "Why", sentence)


def _accuracy_lines(run: Run) -> Iterator[str]:
    error = run.error
    steps = f", {run.steps} steps" if run.steps else ""
    yield from wrapped("Method", f"{error.method}{steps}")
    until = "" if error.until >= run.scene.run.duration else f" up to {error.until:.3g} s"
    yield row("Accuracy", f"attitude to {error.reached:.2g} rad{until}, {error.requested:g} rad asked for")
    if error.inputs > _ROUNDING:
        most = "a whole turn" if error.inputs >= np.pi else f"{error.inputs:.2g} rad"
        yield row("", f"by the end up to {most} more from the bounds of the mass properties")
    if (moved := attitude_uncertainty(run)) is not None:
        known = f"{moved:.2g} rad" if moved < np.pi else "more than a whole turn"
        stated = "from what is stated as uncertain of the part, the spin along the part axes staying"
        yield from wrapped("", f"by the end {known} (one standard deviation) {stated}")
    for k, (name, invariant) in enumerate(run.invariants.items()):
        drift = f"{_unit(name)}, drift {invariant.largest_relative_drift:.2g}"
        yield row("" if k else "Kept", f"{name} {_listed(np.atleast_1d(invariant.initial))}{drift}")
    if "energy" not in run.invariants:
        yield row("Energy", f"{number(run.energy[0])} J at the start, {number(run.energy[-1])} J at the end")


def _quantity_lines(run: Run) -> Iterator[str]:
    """Yield numbers as they are, and series by where they lie; series of matrices are for the document only."""
    names = {name: np.asarray(values) for name, values in run.quantities.items()}
    lines = [(name, _extent(name, values)) for name, values in names.items() if values.size and values.ndim < 3]
    width = max([LABEL, *(len(name) + 2 for name, _ in lines)])
    for name, extent in lines:
        yield f"{name[:1].upper() + name[1:]:<{width}}{extent}"


def _extent(name: str, values: Float) -> str:
    if values.size == 1:
        value = values.item()
        return number(value) + _unit(name) if math.isfinite(value) else "none" if math.isnan(value) else "infinite"
    bound = _NEGLIGIBLE * float(np.abs(values).max())
    columns = values[None] if values.ndim == 1 else values.T
    return ", ".join(_between(column, bound) for column in columns) + _unit(name)


def _between(values: Float, bound: float) -> str:
    low, high = (number(cleared(float(end), bound)) for end in (values.min(), values.max()))
    return low if low == high else f"{low} … {high}"


def _event_lines(run: Run) -> Iterator[str]:
    for k, event in enumerate(run.events[:_LISTED]):
        instant = cleared(event.time, _ROUNDING * run.scene.run.duration)
        yield from wrapped("" if k else "Events", f"{instant:.9g} s  {event.name}: {event.what}")
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
    unit = unit_of(name)
    return f" {unit}" if unit else ""
