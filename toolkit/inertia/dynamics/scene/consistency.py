"""What the fields of a scene must be *together*, so that there is a motion to follow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inertia.documents import FieldError
from inertia.dynamics.loads.gravity import Gravity
from inertia.errors import GeometryError

if TYPE_CHECKING:
    from inertia.dynamics.scene.document import Scene

_FAR = 10.0  # sizes of the body


def require_sense(scene: Scene) -> None:
    """Raise `UsageError` where fields contradict each other or one is lacking, `GeometryError` for what cannot be."""
    least = scene.body.body.principal.moments[0]
    if not least > 0:
        raise GeometryError(
            f"the smallest principal moment is {least:.3g} kg m², and about an axis that no mass is away from there "
            "is no rotation to follow: give the body a thickness"
        )
    _require_mass(scene)
    if scene.body.deforms and scene.constraint.kind != "free":
        held = scene.constraint.kind
        raise FieldError("constraint.kind", f'is "{held}": a body that changes its shape must be free')
    _require_loads_that_fit(scene)
    if scene.constraint.kind == "fixed_point":
        _require_near(scene)
    if scene.start.velocity is not None and scene.constraint.kind != "free":
        raise FieldError("start.velocity", "is given, but the constraint decides it: leave it out")
    if not np.any(scene.start.angular_velocity) and not _is_turned(scene):
        raise FieldError("start.angular_velocity", "is zero, and nothing makes the body turn: give a spin or a torque")


def _is_turned(scene: Scene) -> bool:
    """Whether a load can set a body in motion that is at rest."""
    if scene.body.deforms or any(load.starts_motion for load in scene.applied_loads):
        return True
    arm = scene.constraint.fixed_point - scene.body.body.center_of_mass
    return scene.constraint.kind != "free" and bool(scene.gravity.any() and arm.any())


def _require_mass(scene: Scene) -> None:
    body, constraint = scene.body.body, scene.constraint
    if body.mass is not None:
        return
    for k, load in enumerate(scene.applied_loads):
        if load.acts_on_mass:
            raise FieldError("body.mass", f"is missing: load[{k}], {load.kind}, acts on mass")
    if constraint.kind == "rolling":
        raise FieldError("body.mass", "is missing: a rolling body needs it")
    if constraint.kind == "fixed_point" and np.any(constraint.fixed_point - body.center_of_mass):
        raise FieldError("body.mass", "is missing: the moments about the fixed point need it")


def _require_loads_that_fit(scene: Scene) -> None:
    kind = scene.constraint.kind
    for k, load in enumerate(scene.applied_loads):
        if scene.body.deforms and not isinstance(load, Gravity):
            raise FieldError(f"load[{k}]", f"is {load.kind}: a body that changes its shape takes gravity only")
        if kind != "free" and load.free_bodies_only:
            raise FieldError(f"load[{k}]", f"is {load.kind}, which acts on a free body, not on one that is held")
        if kind == "rolling" and not isinstance(load, Gravity):
            raise FieldError(f"load[{k}]", f"is {load.kind}: a rolling body takes gravity only")
        load.require_span(scene.run.duration, f"load[{k}]")
    if kind == "rolling":
        x, y, z = scene.gravity.tolist()
        if x or y or not z < 0:
            raise FieldError("load", 'needs one of kind = "gravity" along −z: the body rolls on the plane z = 0')


def _require_near(scene: Scene) -> None:
    """Refuse a fixed point that no body of these moments would be held at: metres for millimetres, most often."""
    body = scene.body.body
    arm = float(np.linalg.norm(scene.constraint.fixed_point - body.center_of_mass))
    if arm == 0 or body.mass is None:
        return
    size = 2.0 * float(np.sqrt(5.0 * scene.body.body.principal.second_moments.max() / body.mass))
    if arm > _FAR * size:
        raise GeometryError(
            f"constraint.point is {arm:.4g} m from the centre of mass of a body that is about {size:.3g} m long, and "
            f"the limit is {_FAR:g} lengths: give the point in m, along the part axes"
        )
