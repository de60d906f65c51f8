"""What the worked cases of the textbook share: scenes in a line, and meshes refined to their smooth shapes."""

import math
from typing import Any

import numpy as np
from tests.mass.parts import surface

import inertia
from inertia.dynamics.run import Run

G = 9.80665


def follow(body: dict[str, Any], angular_velocity: Any, duration: float, samples: int = 101, **rest: Any) -> Run:
    """Run a scene; `rest` may hold attitude and frame of the start, accuracy, constraint and load."""
    start = {"angular_velocity": list(angular_velocity)}
    start |= {name: rest[name] for name in ("attitude", "frame") if name in rest}
    run = {"duration": duration, "samples": samples}
    run |= {name: rest[name] for name in ("accuracy",) if name in rest}
    sections = {name: rest[name] for name in ("constraint", "load") if name in rest}
    return inertia.simulate(inertia.Scene.from_dict({"body": body, "start": start, "run": run, **sections}))


def free(moments: Any, angular_velocity: Any, duration: float, **rest: Any) -> Run:
    """Run a free body along its principal axes, in the order of the moments."""
    return follow({"principal_moments": list(moments)}, angular_velocity, duration, **rest)


def on_axle(body: inertia.MassProperties, axis: Any, omega: float) -> Run:
    """Turn a body steadily on an axle through the origin of its axes, once round."""
    unit = np.asarray(axis, float) / np.linalg.norm(axis)
    table = {"inertia": body.inertia.tolist(), "mass": body.mass, "center_of_mass": body.center_of_mass.tolist()}
    held = {"kind": "hinge", "axis": unit.tolist(), "drive": "constant_speed"}
    return follow(table, omega * unit, 2.0 * math.pi / omega, 17, frame="part", constraint=held)


def tilted(theta: float) -> list[float]:
    """Return the attitude (4,) of a body whose axis 3 is off the vertical by θ, turned about x."""
    return [math.sin(theta / 2), 0.0, 0.0, math.cos(theta / 2)]


def refined(shape: Any, density: float = 1.0) -> tuple[float, np.ndarray, np.ndarray]:
    """Take the errors of orders 2 and 4 out of the answers for 48, 96 and 192 segments (Richardson)."""
    result = [inertia.mass_properties(surface(shape(n)), density) for n in (48, 96, 192)]
    rows = np.array([[body.mass, *body.center_of_mass, *body.inertia.ravel()] for body in result])
    for order in (2, 4):
        rows = (2**order * rows[1:] - rows[:-1]) / (2**order - 1)
    (answer,) = rows
    return float(answer[0]), answer[1:4], answer[4:].reshape(3, 3)
