"""Random scenes of every kind, each from its seed and number alone; figures are float64 and taken as exact."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

Table = dict[str, Any]
Random = np.random.Generator


@dataclass(frozen=True)
class Case:
    """A scene as a file has it; `function` describes a torque given as a function; `triangles` (n, 3, 3) a part."""

    kind: str
    seed: int
    number: int
    scene: Table
    function: Table = field(default_factory=dict)
    triangles: list[Any] | None = None
    note: str = ""


def case(kind: str, seed: int, number: int) -> Case:
    """Return a case of a kind."""
    random = np.random.default_rng([seed, number, *kind.encode()])
    made = KINDS[kind](random)
    return Case(kind, seed, number, **made)


def _power(random: Random, low: float, high: float) -> float:
    return float(10.0 ** random.uniform(low, high))


def _direction(random: Random) -> np.ndarray:
    v = random.normal(size=3)
    return v / np.linalg.norm(v)


def _attitude(random: Random) -> list[float]:
    if random.random() < 0.2:
        return [0.0, 0.0, 0.0, 1.0]
    q = random.normal(size=4)
    stretch = 1.0 + 9e-7 * random.uniform(-1, 1) if random.random() < 0.1 else 1.0
    return (q / np.linalg.norm(q) * stretch).tolist()


def _vector(random: Random, size: float) -> list[float]:
    return (size * _direction(random)).tolist()


def _scale(random: Random) -> float:
    """Return 1, or a decimal order between 1e-9 and 1e9."""
    return 1.0 if random.random() < 0.5 else _power(random, -9, 9)


def _moments(random: Random) -> np.ndarray:
    """Return three moments of a body of size one: of no kind, nearly symmetric, flat, long, a ball."""
    match random.integers(7):
        case 0:  # from second moments, which may be of very different sizes
            a, b, c = 10.0 ** random.uniform(-4, 0, 3)
        case 1:
            a = b = 1.0
            c = _power(random, -4, 2)
        case 2:
            a, c = 1.0, _power(random, -2, 1)
            b = 1.0 + _power(random, -16, -1)
        case 3:
            a, b = 1.0 + random.uniform(0, 1, 2) * _power(random, -16, -1)
            c = 1.0
        case 4:
            a, b, c = random.uniform(0.1, 1.0), random.uniform(0.1, 1.0), 0.0
        case _:
            a, b, c = random.uniform(0.05, 1.0, 3)
    moments = np.array([b + c, c + a, a + b])
    return moments[random.permutation(3)] * _scale(random)


def _spin(random: Random, moments: np.ndarray) -> np.ndarray:
    """Return an angular velocity of size one along principal axes: any, near an axis, near the separatrix, on one."""
    match random.integers(6):
        case 0:  # near a principal axis
            spin = np.eye(3)[random.integers(3)] + _power(random, -20, -1) * _direction(random)
        case 1:  # near the intermediate axis
            spin = np.eye(3)[np.argsort(moments)[1]] + _power(random, -17, -1) * _direction(random)
        case 2:  # near the separatrix, anywhere on it
            i, j, k = np.argsort(moments)
            a, b, c = moments[[i, j, k]]
            spin = np.zeros(3)
            spin[j] = random.uniform(-1, 1)
            spin[k] = 1.0
            if b > a:
                spin[i] = np.sqrt(max(c * (c - b) / (a * (b - a)), 0.0)) * (
                    1.0 + random.normal() * _power(random, -16, -2)
                )
            spin /= np.abs(spin).max()
        case 3:
            spin = _direction(random)
            spin[random.integers(3)] = 0.0
        case _:
            spin = _direction(random)
    return spin / np.linalg.norm(spin)


def _accuracy(random: Random) -> float:
    return 1e-10 if random.random() < 0.5 else _power(random, -14, -3)


def _run(random: Random, rate: float, turned: float, **more: Any) -> Table:
    """Return [run] for a motion of about `turned` rad at `rate` rad/s."""
    return {
        "duration": float(turned / rate),
        "samples": int(random.integers(2, 18)),
        "accuracy": _accuracy(random),
        **more,
    }


def _turned(random: Random, most: float = 30.0) -> float:
    return _power(random, 0.0, float(np.log10(most))) if random.random() < 0.9 else _power(random, -8, 0)


def _tensor(random: Random, moments: np.ndarray) -> list[list[float]]:
    """Return a full tensor with about these moments, symmetric to the last bit."""
    columns = np.linalg.qr(random.normal(size=(3, 3)))[0]
    if random.random() < 0.25:  # nearly diagonal
        skew = _power(random, -18, -1) * random.normal(size=3)
        columns = np.eye(3) + np.array([[0, -skew[2], skew[1]], [skew[2], 0, -skew[0]], [-skew[1], skew[0], 0]])
        columns = np.linalg.qr(columns)[0]
    tensor = columns @ np.diag(moments) @ columns.T
    return (0.5 * (tensor + tensor.T)).tolist()


def _body(random: Random) -> tuple[Table, np.ndarray, np.ndarray]:
    """Return a section [body], its moments (3,) and a matrix of columns along its principal axes."""
    moments = _moments(random)
    if random.random() < 0.4:
        return {"principal_moments": moments.tolist()}, moments, np.eye(3)
    tensor = _tensor(random, moments)
    values, columns = np.linalg.eigh(np.array(tensor))
    return {"inertia": tensor}, values, columns


def _distinct(moments: np.ndarray) -> bool:
    low, middle, high = np.sort(moments)
    return min(middle - low, high - middle) > 1e-6 * high


def _start(random: Random, body: Table, moments: np.ndarray, columns: np.ndarray, rate: float) -> Table:
    spin = rate * _spin(random, moments)
    frame = "part" if random.random() < 0.4 else "space" if random.random() < 0.3 else "principal"
    start: Table = {"attitude": _attitude(random)}
    if "inertia" in body:
        if frame == "principal" and not _distinct(moments):
            frame = "part"
        if frame == "part":
            spin = columns @ spin
    return {**start, "angular_velocity": spin.tolist(), "frame": frame}


def free(random: Random, most: float = 40.0) -> Table:
    """Return a free body."""
    body, moments, columns = _body(random)
    rate = _scale(random)
    return {
        "scene": {
            "body": body,
            "start": _start(random, body, moments, columns, rate),
            "run": _run(random, rate, _turned(random, most)),
        }
    }


def separatrix(random: Random) -> Table:
    """Return a free body that starts near its intermediate axis and is followed over several flips."""
    while not _distinct(moments := _moments(random)):
        pass
    tilt = 0.0 if random.random() < 0.2 else _power(random, -16, -2)
    axis = np.argsort(moments)[1]
    spin = np.eye(3)[axis] + tilt * _direction(random)
    body: Table = {"principal_moments": moments.tolist()}
    if random.random() < 0.7:
        tensor = _tensor(random, moments)
        columns = np.linalg.eigh(np.array(tensor))[1]
        order = np.argsort(np.argsort(moments))
        spin = columns[:, order] @ spin
        body = {"inertia": tensor}
    rate = _scale(random)
    low, middle, high = np.sort(moments)
    growth = float(np.sqrt((middle - low) * (high - middle) / (low * high)))
    angle = min(random.uniform(0.2, 1.2) * -np.log(max(tilt, 1e-16)) / growth, 200.0)
    return {
        "scene": {
            "body": body,
            "start": {"angular_velocity": (rate * spin).tolist(), "frame": "part", "attitude": _attitude(random)},
            "run": _run(random, rate, angle),
        }
    }


def _top(random: Random) -> tuple[Table, float, float]:
    """Return a symmetric body with its centre of mass on its axis (z), M g h over I1 and I3 over I1; held at 0."""
    mass, height = _power(random, -2, 2), _power(random, -2, 0)
    across, along = _power(random, -1, 1), _power(random, -1, 0.25)
    i1 = across * mass * height**2
    i3 = min(along, 1.99) * i1
    body = {"principal_moments": [i1, i1, i3], "mass": mass, "center_of_mass": [0.0, 0.0, height]}
    about = i1 + mass * height**2
    return body, mass * 9.80665 * height / about, i3 / about


def heavy(random: Random) -> Table:
    """Return a heavy symmetric top, tilted."""
    body, pull, ratio = _top(random)
    spin = np.sqrt(pull) / ratio * _power(random, -1, 1)
    tilt = random.uniform(0, np.pi)
    start: Table = {
        "attitude": [float(np.sin(tilt / 2)), 0.0, 0.0, float(np.cos(tilt / 2))],
        "angular_velocity": [0.0, 0.0, float(spin)],
        "frame": "part",
    }
    if random.random() < 0.7:
        start["angular_velocity"] = (np.array([0, 0, spin]) + np.sqrt(pull) * random.normal(size=3)).tolist()
        start["attitude"] = _attitude(random)
    if random.random() < 0.3:  # side by side with the axis of the tensor, by a little
        body["center_of_mass"] = (
            np.array(body["center_of_mass"])
            + body["center_of_mass"][2] * _power(random, -20, -8) * random.normal(size=3)
        ).tolist()
    rate = max(float(np.linalg.norm(start["angular_velocity"])), float(np.sqrt(pull)))
    gravity: Table = {"kind": "gravity"}
    if random.random() < 0.3:
        gravity["acceleration"] = _vector(random, _power(random, -1, 2))
    body = _turned_body(random, body, start)
    return {
        "scene": {
            "body": body,
            "start": start,
            "constraint": {"kind": "fixed_point"},
            "load": [gravity],
            "run": _run(random, rate, _turned(random)),
        }
    }


def _turned_body(random: Random, body: Table, start: Table) -> Table:
    """Return half of the bodies along other part axes, with full tensors, and turn their starts."""
    if random.random() < 0.5:
        return body
    columns = np.linalg.qr(random.normal(size=(3, 3)))[0]
    columns *= np.linalg.det(columns)
    tensor = columns @ np.diag(body["principal_moments"]) @ columns.T
    start["angular_velocity"] = (columns @ np.array(start["angular_velocity"])).tolist()
    return {
        "inertia": (0.5 * (tensor + tensor.T)).tolist(),
        "mass": body["mass"],
        "center_of_mass": (columns @ np.array(body["center_of_mass"])).tolist(),
    }


def upright(random: Random) -> Table:
    """Return an upright top around the spin from which on it sleeps, off the vertical or its axis by very little."""
    body, pull, ratio = _top(random)
    threshold = 2.0 * np.sqrt(pull) / ratio
    match random.integers(4):
        case 0:
            spin = threshold * (1.0 + random.choice([-1, 1]) * _power(random, -14, -1))
        case 1:
            spin = threshold * random.uniform(0.0, 1.0)
        case _:
            spin = threshold * _power(random, -1, 1)
    tilt = 0.0 if random.random() < 0.4 else _power(random, -18, -3)
    hanging = random.random() < 0.15
    q = np.array([np.sin(tilt / 2), 0.0, 0.0, np.cos(tilt / 2)])
    if hanging:
        q = np.array([q[3], 0.0, 0.0, -q[0]])
    start: Table = {"attitude": q.tolist(), "angular_velocity": [0.0, 0.0, float(spin)], "frame": "part"}
    if random.random() < 0.4:
        off = body["center_of_mass"][2] * _power(random, -22, -8)
        angle = random.uniform(0, 2 * np.pi)
        body["center_of_mass"] = [off * np.cos(angle), off * np.sin(angle), body["center_of_mass"][2]]
    if random.random() < 0.3:
        i1, _, i3 = body["principal_moments"]
        body["principal_moments"] = [i1, i1 * (1.0 + _power(random, -16, -6)), i3]
    growth = np.sqrt(pull) * 0.5
    body = _turned_body(random, body, start) if random.random() < 0.5 else body
    return {
        "scene": {
            "body": body,
            "start": start,
            "constraint": {"kind": "fixed_point"},
            "load": [{"kind": "gravity"}],
            "run": _run(random, 1.0, min(random.uniform(1, 45) / growth, 150.0 / max(growth, spin))),
        }
    }


def heavy_body(random: Random) -> Table:
    """Return a heavy body of no symmetry on a fixed point."""
    body, moments, columns = _body(random)
    size = float(np.sqrt(moments.max()))
    mass = _power(random, -1, 1)
    body |= {"mass": mass}
    lever = _power(random, -1, 0.3) * size / np.sqrt(mass)
    constraint: Table = {"kind": "fixed_point"}
    if random.random() < 0.5:
        body["center_of_mass"] = _vector(random, lever)
    else:
        constraint["point"] = _vector(random, lever)
    gravity = _scale(random)
    pull = float(np.sqrt(mass * gravity * lever / moments.min()))
    rate = pull * _power(random, -1, 1)
    return {
        "scene": {
            "body": body,
            "start": _start(random, body, moments, columns, rate),
            "constraint": constraint,
            "load": [{"kind": "gravity", "acceleration": _vector(random, gravity)}],
            "run": _run(random, max(rate, pull), _turned(random, 15.0)),
        }
    }


def _loads(random: Random, moments: np.ndarray, rate: float, duration: float, tables: bool) -> list[Table]:
    size = float(moments.min()) * rate**2
    loads: list[Table] = []
    for _ in range(random.integers(1, 4)):
        frame = str(random.choice(["part", "space", "principal"]))
        torque = _vector(random, size * _power(random, -6, 0.5))
        match random.integers(5):
            case 0:
                loads.append({"kind": "damping", "coefficient": float(moments.min()) * rate * _power(random, -5, 0)})
            case 1 if tables:
                rows = int(random.integers(2, 7))
                times = np.sort(np.concatenate([[0.0, duration], random.uniform(0, duration, rows)]))
                if random.random() < 0.5:
                    times[len(times) // 2] = times[len(times) // 2 - 1]  # a jump
                values = random.normal(size=(len(times), 3)) * np.linalg.norm(torque)
                loads.append({"kind": "torque", "table": np.column_stack([times, values]).tolist(), "frame": frame})
            case 2:
                axis = np.eye(3)[random.integers(3)] * np.linalg.norm(torque)
                loads.append({"kind": "torque", "torque": axis.tolist(), "frame": frame})
            case _:
                loads.append({"kind": "torque", "torque": torque, "frame": frame})
    return loads


def _safe_frames(body: Table, moments: np.ndarray, loads: list[Table]) -> None:
    """Name no principal axes where the package may choose them."""
    if "inertia" in body and not _distinct(moments):
        for load in loads:
            if load.get("frame") == "principal":
                load["frame"] = "part"


def torques(random: Random, tables: bool = False) -> Table:
    """Return a body under constant torques, damping, and in a third of the cases gravity on a fixed point."""
    made = heavy_body(random) if random.random() < 0.3 else free(random, 15.0)
    scene = made["scene"]
    body = scene["body"]
    moments = np.linalg.eigvalsh(np.array(body.get("inertia", np.diag(body.get("principal_moments", (1, 1, 1))))))
    duration = scene["run"]["duration"]
    rate = float(np.linalg.norm(scene["start"]["angular_velocity"]))
    rate = max(rate, min(1.0 / duration, rate * 100))
    loads = _loads(random, moments, rate, duration, tables)
    if random.random() < 0.15:
        scene["start"]["angular_velocity"] = [0.0, 0.0, 0.0]
        if not any(load["kind"] == "torque" for load in loads):
            loads.append({"kind": "torque", "torque": [0.0, 0.0, float(moments.min()) * rate**2]})
    _safe_frames(body, moments, loads)
    scene["load"] = [*scene.get("load", []), *loads]
    return made


def tables(random: Random) -> Table:
    """Return a body under torques, tables among them."""
    return torques(random, True)


def axial(random: Random) -> Table:
    """Return a body with closed forms: a torque or damping along a principal spin, or of a symmetric body's axis."""
    a, c = 1.0, random.uniform(0.1, 1.9)
    scale, rate = _scale(random), _scale(random)
    moments = np.array([a, a, c]) * scale
    if random.random() < 0.3:
        moments[1] *= 1.0 + _power(random, -16, -9)
    spin = np.array([0.0, 0.0, rate])
    if random.random() < 0.5:
        spin += rate * random.normal(size=3) * [1, 1, 0]
    elif random.random() < 0.5:
        spin += rate * _power(random, -18, -9) * random.normal(size=3)
    size = moments.min() * rate**2 * _power(random, -3, 0.5)
    loads: list[Table] = []
    if random.random() < 0.7:
        loads.append({"kind": "torque", "torque": [0.0, 0.0, size]})
    if random.random() < 0.7 or not loads:
        loads.append({"kind": "damping", "coefficient": moments.min() * rate * _power(random, -3, 0)})
    body: Table = {"principal_moments": moments.tolist()}
    start = {"angular_velocity": spin.tolist(), "frame": "part", "attitude": _attitude(random)}
    if random.random() < 0.2:
        body = {"principal_moments": [scale] * 3}
    return {"scene": {"body": body, "start": start, "load": loads, "run": _run(random, rate, _turned(random, 15.0))}}


def dissipation(random: Random) -> Table:
    """Return a free body that loses energy inside."""
    made = free(random, 15.0)
    scene = made["scene"]
    body = scene["body"]
    moments = np.linalg.eigvalsh(np.array(body.get("inertia", np.diag(body.get("principal_moments", (1, 1, 1))))))
    rate = float(np.linalg.norm(scene["start"]["angular_velocity"]))
    scene["load"] = [{"kind": "dissipation", "rate": float(moments.min()) / rate * _power(random, -5, -0.5)}]
    return made


def gradient(random: Random) -> Table:
    """Return a body that a distant primary turns."""
    made = free(random, 15.0)
    scene = made["scene"]
    rate = float(np.linalg.norm(scene["start"]["angular_velocity"]))
    distance = _power(random, 0, 7)
    mu = rate**2 * distance**3 * _power(random, -6, 0)
    scene["load"] = [{"kind": "gravity_gradient", "mu": float(mu), "position": _vector(random, distance)}]
    return made


def orbiting(random: Random) -> Table:
    """Return a body that goes round a primary, in libration, spinning, or past a near periapsis."""
    body, moments, columns = _body(random)
    size = _power(random, 6, 8)
    mu = 3.986004418e14 * (1.0 if random.random() < 0.7 else _power(random, -3, 3))
    motion = float(np.sqrt(mu / size**3))
    load: Table = {"kind": "orbit", "mu": mu}
    eccentricity = 0.0 if random.random() < 0.3 else random.uniform(0, 0.9)
    if random.random() < 0.4:
        place = size * _direction(random)
        velocity = np.cross(_direction(random), place)
        velocity *= np.sqrt(mu / size) * random.uniform(0.5, 1.2) / np.linalg.norm(velocity)
        load |= {"position": place.tolist(), "velocity": velocity.tolist()}
    else:
        angles = random.uniform(-3, 3, 4) * (random.random(4) < 0.8)
        load |= {"semi_major_axis": size, "eccentricity": eccentricity}
        load |= dict(zip(("inclination", "node", "argument", "anomaly"), angles.tolist(), strict=True))
    rate = motion * _power(random, -1, 1)
    start = _start(random, body, moments, columns, rate)
    run = _run(random, max(rate, motion), _turned(random, 15.0))
    return {"scene": {"body": body, "start": start, "load": [load], "run": run}}


def functions(random: Random) -> Table:
    """Return a body that a Python function turns: a wave, a bell, a pulse, drag, a spring to space."""
    moments = np.array([1.0, 2.0, 2.5]) * random.uniform(0.9, 1.08, 3) * _scale(random)
    rate = _scale(random)
    spin = rate * _spin(random, moments) if random.random() < 0.8 else np.zeros(3)
    turned = _turned(random, 15.0)
    duration = turned / rate
    size = float(moments.min()) * rate**2
    function: Table = {}
    for name in random.choice(["sine", "gauss", "pulse", "drag", "servo"], size=random.integers(1, 3), replace=False):
        torque = _vector(random, size * _power(random, -3, 0.3))
        width = duration * _power(random, -3.5, -0.3)
        begin = random.uniform(0, duration - width)
        match str(name):
            case "sine":
                function["sine"] = {
                    "torque": torque,
                    "rate": rate * _power(random, -1, 1.2),
                    "phase": random.uniform(0, 6),
                }
            case "gauss":
                function["gauss"] = {"torque": torque, "time": begin + width / 2, "width": width / 4}
            case "pulse":
                declared = bool(random.random() < 0.4)
                if declared:  # and as short as one likes
                    width = duration * _power(random, -7, -0.3)
                function["pulse"] = {"torque": torque, "times": [begin, begin + width], "declared": declared}
            case "drag":
                function["drag"] = {"factor": float(moments.min()) * _power(random, -4, 0)}
            case "servo":
                function["servo"] = {"gains": (size * random.uniform(0, 1, 3)).tolist()}
    if not spin.any() and "drag" in function:
        spin = rate * _spin(random, moments)
    body: Table = {"principal_moments": moments.tolist()}
    start = {"angular_velocity": spin.tolist(), "attitude": _attitude(random)}
    return {
        "scene": {"body": body, "start": start, "run": _run(random, rate, turned)},
        "function": function,
    }


def hinged(random: Random) -> Table:
    """Return a body on an axle: free, driven, braked, on a spring, heavy, at a constant speed."""
    body, moments, _ = _body(random)
    size = float(np.sqrt(moments.max()))
    body["mass"] = mass = _power(random, -1, 1)
    lever = _power(random, -2, 0.3) * size / np.sqrt(mass)
    body["center_of_mass"] = _vector(random, lever)
    axis = np.eye(3)[random.integers(3)] if random.random() < 0.3 else _direction(random) * _power(random, -2, 2)
    constraint: Table = {"kind": "hinge", "axis": axis.tolist()}
    if random.random() < 0.5:
        constraint["point"] = _vector(random, lever)
    inertia = float(moments.mean()) + mass * lever**2
    rate = _scale(random)
    spin = (rate * axis / np.linalg.norm(axis)).tolist()
    loads: list[Table] = []
    if random.random() < 0.6:
        gravity = inertia * rate**2 / (mass * lever) * _power(random, -2, 1)
        loads.append({"kind": "gravity", "acceleration": _vector(random, gravity)})
        if random.random() < 0.3:
            spin = [0.0, 0.0, 0.0]
    if random.random() < 0.3:
        loads.append({"kind": "damping", "coefficient": inertia * rate * _power(random, -3, 1)})
    if random.random() < 0.3:
        torque = _vector(random, inertia * rate**2 * _power(random, -3, 0.5))
        loads.append({"kind": "torque", "torque": torque, "frame": str(random.choice(["part", "space"]))})
    if random.random() < 0.4:
        constraint["stiffness"] = inertia * rate**2 * _power(random, -3, 1)
        constraint["rest_angle"] = float(random.normal())
    if random.random() < 0.1:
        constraint["drive"] = "constant_speed"
    if not any(spin) and constraint.get("drive"):
        del constraint["drive"]
    start = {"angular_velocity": spin, "frame": "part", "attitude": _attitude(random)}
    run = _run(random, rate, _turned(random, 60.0))
    return {"scene": {"body": body, "start": start, "constraint": constraint, "load": loads, "run": run}}


def inverted(random: Random) -> Table:
    """Return a pendulum near its upper rest, or with hardly the energy to pass it."""
    made = hinged(random)
    scene = made["scene"]
    body, lever = scene["body"], _power(random, -1, 0)
    moments = np.array([2.0, 3.0, 4.0]) * lever**2 * body["mass"] * _power(random, -2, 0)
    body.pop("inertia", None)
    body |= {"principal_moments": moments.tolist(), "center_of_mass": [0.0, 0.0, lever]}
    scene["constraint"] = {"kind": "hinge", "axis": [1.0, 0.0, 0.0]}
    about = moments[0] + body["mass"] * lever**2
    rate = float(np.sqrt(body["mass"] * 9.80665 * lever / about))
    tilt, spin = 0.0, 0.0
    match random.integers(3):
        case 0:
            tilt = _power(random, -16, -2)
        case 1:
            spin = rate * _power(random, -16, -2)
        case 2:
            tilt, spin = np.pi, 2.0 * rate * (1.0 + random.choice([-1, 1]) * _power(random, -16, -2))
    scene["start"] = {
        "angular_velocity": [float(spin), 0.0, 0.0],
        "frame": "part",
        "attitude": [float(np.sin(tilt / 2)), 0.0, 0.0, float(np.cos(tilt / 2))],
    }
    scene["load"] = [{"kind": "gravity"}]
    if random.random() < 0.3:
        scene["load"].append({"kind": "damping", "coefficient": about * rate * _power(random, -6, -1)})
    scene["run"] = _run(random, rate, random.uniform(5, 60))
    return made


def rolling(random: Random) -> Table:
    """Return a body of revolution on its rim."""
    mass, radius = _power(random, -2, 2), _power(random, -2, 1)
    across = mass * radius**2 * _power(random, -1.5, 0.5)
    along = across * random.uniform(0.3, 1.99)
    body: Table = {"principal_moments": [across, across, along], "mass": mass}
    if random.random() < 0.2:
        body["principal_moments"][1] *= 1.0 + _power(random, -16, -11)
    constraint: Table = {"kind": "rolling", "radius": radius, "axis": [0.0, 0.0, 1.0]}
    if random.random() < 0.4:
        constraint["offset"] = radius * random.normal() * 0.5
    rate = float(np.sqrt(9.80665 / radius))
    tilt = (
        random.uniform(0.3, np.pi - 0.3)
        if random.random() < 0.8
        else np.pi / 2 + random.normal() * _power(random, -16, -2)
    )
    turn = random.uniform(0, np.pi)
    q = np.array([np.sin(tilt / 2) * np.cos(turn), np.sin(tilt / 2) * np.sin(turn), 0.0, np.cos(tilt / 2)])
    spin = rate * _power(random, -1, 1) * _direction(random)
    if random.random() < 0.3:
        spin *= [1e-3, 1e-3, 1.0]
    start = {"attitude": q.tolist(), "angular_velocity": spin.tolist(), "frame": "part"}
    if random.random() < 0.3:
        body = _turned_body(random, body | {"center_of_mass": [0.0, 0.0, 0.0]}, start)
        if "inertia" in body:
            constraint["axis"] = np.linalg.eigh(np.array(body["inertia"]))[1][:, 2 if along > across else 0].tolist()
    speed = max(rate, float(np.linalg.norm(spin)))
    return {
        "scene": {
            "body": body,
            "start": start,
            "constraint": constraint,
            "load": [{"kind": "gravity"}],
            "run": _run(random, speed, _turned(random, 12.0)),
        }
    }


def long(random: Random) -> Table:
    """Return a free body that is followed over up to 1e15 rad."""
    made = free(random)
    scene = made["scene"]
    rate = float(np.linalg.norm(scene["start"]["angular_velocity"]))
    run = _run(random, rate, _power(random, 1, 15))
    scene["run"] = run | {"samples": 3, "accuracy": max(run["accuracy"], 1e-16 * run["duration"] * rate)}
    return made


def extreme(random: Random) -> Table:
    """Return a scene of another kind in units of far away, or with a component of the spin next to nothing."""
    made = [free, separatrix, heavy, upright, torques, axial][random.integers(6)](random)
    scene = made["scene"]
    mass, length, rate = _power(random, -20, 20), _power(random, -10, 10), _power(random, -15, 15)
    if random.random() < 0.5:
        rate = 1.0
        spin = scene["start"]["angular_velocity"]
        spin[random.integers(3)] *= _power(random, -45, -5)
    return {**made, "scene": rescaled(scene, mass, length, rate)}


_UNITS = {
    "principal_moments": (1, 2, 0),
    "inertia": (1, 2, 0),
    "mass": (1, 0, 0),
    "center_of_mass": (0, 1, 0),
    "point": (0, 1, 0),
    "angular_velocity": (0, 0, 1),
    "acceleration": (0, 1, 2),
    "torque": (1, 2, 2),
    "coefficient": (1, 2, 1),
    "duration": (0, 0, -1),
}
"""Mass, length and rate in the unit of a figure."""


def rescaled(table: Any, mass: float, length: float, rate: float) -> Any:
    """Return a scene in other units: the same motion at another pace, but for rounding."""
    if table.get("kind") == "gravity":
        table = {"acceleration": [0.0, 0.0, -9.80665], **table}
    out = {}
    for key, value in table.items():
        if key in _UNITS:
            a, b, c = _UNITS[key]
            out[key] = (np.array(value) * (mass**a * length**b * rate**c)).tolist()
        elif isinstance(value, dict):
            out[key] = rescaled(value, mass, length, rate)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            out[key] = [rescaled(each, mass, length, rate) for each in value]
        else:
            out[key] = value
    return out


def sliding(random: Random) -> Table:
    """Return a ball that slides on a plane with friction, its centre of mass off centre: tippe tops among them."""
    mass, radius = _power(random, -2, 1), _power(random, -2, 0)
    moments = mass * radius**2 * np.array([0.4, 0.4, 0.4]) * random.uniform(0.7, 1.1, 3)
    if random.random() < 0.5:
        moments[1] = moments[0]
    slow = float(np.sqrt(9.80665 / radius))
    rate = slow * _power(random, -0.5, 1)
    body: Table = {"principal_moments": moments.tolist(), "mass": mass}
    body["center_of_mass"] = _vector(random, radius * random.uniform(0, 0.3))
    if random.random() < 0.4:
        body["center_of_mass"] = [0.0, 0.0, -radius * random.uniform(0, 0.3)]
    friction = 0.0 if random.random() < 0.1 else _power(random, -2, 0)
    constraint: Table = {"kind": "sliding", "radius": radius, "friction": friction}
    if random.random() < 0.7:
        constraint["slip_speed"] = radius * rate * _power(random, -3, 0)
    start: Table = {"attitude": _attitude(random), "angular_velocity": _vector(random, rate), "frame": "part"}
    if random.random() < 0.4:
        start["velocity"] = [*(radius * slow * random.normal(size=2)).tolist(), 0.0]
    run = _run(random, rate, _turned(random, 15.0))
    return {
        "scene": {"body": body, "start": start, "constraint": constraint, "load": [{"kind": "gravity"}], "run": run}
    }


def idle(random: Random) -> Table:
    """Return a body whose loads are zero, or add up to zero."""
    made = free(random)
    torque = random.normal(size=3)
    one: Table = {"kind": "torque", "torque": torque.tolist()}
    rows = [[0.0, 0.0, 0.0, 0.0], [made["scene"]["run"]["duration"], 0.0, 0.0, 0.0]]
    made["scene"]["load"] = [
        [{"kind": "torque", "torque": [0.0, 0.0, 0.0]}],
        [{"kind": "damping", "coefficient": 0.0}, {"kind": "dissipation", "rate": 0.0}],
        [{"kind": "torque", "table": rows}],
        [one, {"kind": "torque", "torque": (-torque).tolist()}],
    ][random.integers(4)]
    return made


_SAMPLES = "box", "cube", "tetrahedron", "thin_plate", "t_handle", "cone", "needle", "spinning_top", "disc"


def mesh(random: Random) -> Table:
    """Return a part, a sample or a random polyhedron, that tumbles, or is held at a point and has weight."""
    triangles = None
    body: Table = {"unit": str(random.choice(["mm", "mm", "m", "cm"])), "density": _power(random, 1, 4)}
    if random.random() < 0.5:
        body["part"] = f"{random.choice(_SAMPLES)}.stl"
        size = 0.03
    else:
        body["part"] = "random.stl"
        size = _power(random, -1, 2)
        triangles = _polyhedron(random) * np.float32(size)
        if random.random() < 0.3:
            triangles = triangles + (size * _power(random, -1, 2) * _direction(random)).astype("<f4")
    rate = _power(random, 0, 2)
    scene: Table = {
        "body": body,
        "start": {"attitude": _attitude(random), "angular_velocity": _vector(random, rate), "frame": "part"},
    }
    if random.random() < 0.5:
        if random.random() < 0.5:
            scene["start"]["angular_velocity"] = (rate * np.eye(3)[random.integers(3)]).tolist()
        elif triangles is not None:
            scene["start"]["frame"] = "principal"
    scene["run"] = _run(random, rate, _turned(random, 25.0))
    if random.random() < 0.4:
        scene["constraint"] = {"kind": "fixed_point"}
        scene["load"] = [{"kind": "gravity"}]
        if random.random() < 0.4 or triangles is not None:
            scene["body"] |= {"part": "spinning_top.stl"}
            triangles = None
        spin = _power(random, 1, 2.5)
        if random.random() < 0.5:
            scene["start"] |= {"attitude": [0.0, 0.0, 0.0, 1.0], "angular_velocity": [0.0, 0.0, spin]}
        scene["start"]["frame"] = "part"
        scene["run"] = _run(random, spin, _turned(random, 60.0))
    return {"scene": scene, "triangles": None if triangles is None else triangles.astype("<f4").tolist()}


def _polyhedron(random: Random) -> np.ndarray:
    """Return the hull (n, 3, 3) of a few points, counter-clockwise from outside."""
    from scipy.spatial import ConvexHull

    stretch = 10.0 ** random.uniform(-1, 0, 3)
    points = (random.normal(size=(random.integers(4, 12), 3)) * stretch).astype("<f4")
    hull = ConvexHull(points.astype(float))
    triangles = points[hull.simplices]
    inward = (
        np.einsum(
            "ij,ij->i",
            np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]),
            hull.equations[:, :3],
        )
        < 0
    )
    triangles[inward] = triangles[inward][:, ::-1]
    return triangles


def deforming(random: Random) -> Table:
    """Return parts on joints that move one after the other, at once, or in quick jerks."""
    duration = _power(random, -0.5, 1)
    parts: list[Table] = []
    for k in range(random.integers(2, 5)):
        size, mass = _power(random, -1, 0), _power(random, -1, 1)
        moments = mass * size**2 * np.array([0.3, 0.35, 0.4]) * random.uniform(0.8, 1.2, 3)
        if random.random() < 0.3:
            part: Table = {"inertia": _tensor(random, moments)}
        else:
            part = {"principal_moments": moments.tolist()}
        part |= {"name": f"p{k}", "mass": mass, "center_of_mass": _vector(random, size)}
        if k:
            part["parent"] = f"p{random.integers(k)}"
            part["joint"] = [_joint(random, duration) for _ in range(random.integers(1, 3))]
        parts.append(part)
    spin = _vector(random, _power(random, -1, 1)) if random.random() < 0.8 else [0.0, 0.0, 0.0]
    run = _run(random, 1.0, duration)
    return {
        "scene": {
            "part": parts,
            "start": {"angular_velocity": spin, "frame": "part", "attitude": _attitude(random)},
            "run": run | {"samples": int(random.integers(2, 7))},
        }
    }


def _joint(random: Random, duration: float) -> Table:
    count = int(random.integers(1, 5))
    times = np.sort(random.uniform(-0.2, 1.0, count) * duration)
    if count > 1 and random.random() < 0.3:
        times[-1] = times[-2] + duration * _power(random, -5, -1)
    joint: Table = {"axis": _direction(random).tolist(), "times": times.tolist()}
    if random.random() < 0.8:
        joint |= {"angles": random.uniform(-2, 2, count).tolist(), "point": _vector(random, 0.5)}
    else:
        joint["displacements"] = random.uniform(-0.5, 0.5, count).tolist()
    if random.random() < 0.5:
        joint["rates"] = (random.uniform(-3, 3, count) / duration).tolist()
    return joint


def nearly(random: Random) -> Table:
    """Return a body that a smaller model may be taken for, at an accuracy that allows it or just does not."""
    accuracy = _power(random, -13, -1)
    turned = _turned(random, 60.0)
    rate = _scale(random)
    small = accuracy / max(turned, 1.0) * _power(random, -3, 0.5)
    moments = np.array([random.uniform(0.5, 1.5), 1.0, 1.2])
    spin = _direction(random)
    made: Table = {"body": {"principal_moments": [1.0, 1.0, 1.0]}}
    match random.integers(6):
        case 0:  # a sphere, nearly
            moments = 1.0 + small * random.uniform(-1, 1, 3)
        case 1:  # a symmetric body, nearly
            moments = np.array([1.0, 1.0 + small, random.uniform(0.1, 1.9)])[random.permutation(3)]
        case 2:  # a spin along an axis, nearly
            moments = random.uniform(0.6, 1.1, 3)
            spin = np.eye(3)[random.integers(3)] + small * _direction(random)
        case 3:  # a spin along the intermediate axis, nearly, over so many e-foldings
            moments = np.array([0.6, 1.0, 1.4]) * random.uniform(0.95, 1.05, 3)
            growth = np.sqrt((moments[1] - moments[0]) * (moments[2] - moments[1]) / (moments[0] * moments[2]))
            spin = np.eye(3)[1] + accuracy * np.exp(-growth * turned) * _power(random, -3, 1) * _direction(random)
        case 4:  # a symmetric body that spins across its axis, nearly
            moments = np.array([1.0, 1.0 + random.integers(2) * small, random.uniform(0.1, 1.9)])
            angle = random.uniform(0, 2 * np.pi)
            spin = np.array([np.cos(angle), np.sin(angle), 0.0]) + small * _direction(random)
        case 5:  # a weight that hardly turns the body
            moments = random.uniform(0.6, 1.1, 3)
            point = (small / max(turned, 1.0) * rate**2 / 9.80665 * _direction(random)).tolist()
            made |= {"constraint": {"kind": "fixed_point", "point": point}, "load": [{"kind": "gravity"}]}
            made["body"]["mass"] = 1.0
    made["body"]["principal_moments"] = moments.tolist()
    start = {"angular_velocity": (rate * spin).tolist(), "frame": "part", "attitude": _attitude(random)}
    run = _run(random, rate, turned) | {"accuracy": accuracy}
    return {"scene": {**made, "start": start, "run": run}}


def nearly_heavy(random: Random) -> Table:
    """Return a heavy body that is symmetric, nearly, at an accuracy that allows it or just does not."""
    made = (upright if random.random() < 0.7 else heavy)(random)
    scene = made["scene"]
    accuracy = _power(random, -12, -1)
    run, body = scene["run"], scene["body"]
    spin = float(np.linalg.norm(scene["start"]["angular_velocity"]))
    small = accuracy / max(spin * run["duration"], 1.0) * _power(random, -4, 0)
    if "principal_moments" in body:
        body["principal_moments"][0] *= 1.0 + small * random.uniform(-1, 1)
    center = np.array(body["center_of_mass"])
    body["center_of_mass"] = (
        center + np.linalg.norm(center) * small * random.uniform(0, 1) * _direction(random)
    ).tolist()
    run["accuracy"] = accuracy
    return made


_METHODS = (
    "Taylor",
    "splitting 2",
    "splitting 4",
    "splitting 6",
    "splitting 8",
    "RK4",
    "DOP853",
    "LSODA",
    "Radau",
    "heyoka",
)


def methods(random: Random) -> Table:
    """Return a scene for a stepping method that is named."""
    made = [free, separatrix, heavy, heavy_body, torques, tables][random.integers(6)](random)
    scene = made["scene"]
    rate = max(float(np.linalg.norm(scene["start"]["angular_velocity"])), 1.0 / scene["run"]["duration"])
    method = str(random.choice(_METHODS))
    finest = {"splitting 2": -5, "RK4": -7, "splitting 4": -8, "LSODA": -9, "Radau": -8}.get(method, -12)
    scene["run"]["duration"] = min(scene["run"]["duration"], 10.0 / rate)
    for load in scene.get("load", []):
        if "table" in load:
            load["table"][-1][0] = max(load["table"][-1][0], scene["run"]["duration"])
    scene["run"] |= {"method": method, "accuracy": _power(random, finest, -2)}
    return made


def stiff(random: Random) -> Table:
    """Return a body under damping that ends its spin in next to no time, with a torque or a weight that goes on."""
    body, moments, columns = _body(random)
    rate = _scale(random)
    duration = float(_power(random, 0, 1.5) / rate)
    damping = (
        float(moments.min()) / duration * (_power(random, 4, 4.3) if random.random() < 0.1 else _power(random, 0, 3))
    )
    loads: list[Table] = [{"kind": "damping", "coefficient": damping}]
    if random.random() < 0.7:
        frame = str(random.choice(["part", "space"]))
        loads.append(
            {"kind": "torque", "torque": _vector(random, damping * rate * _power(random, -3, 0)), "frame": frame}
        )
    start = _start(random, body, moments, columns, rate)
    accuracy = _power(random, -11, -3)
    run = {"duration": duration, "samples": int(random.integers(2, 9)), "accuracy": accuracy}
    return {"scene": {"body": body, "start": start, "load": loads, "run": run}}


KINDS: dict[str, Callable[[Random], Table]] = {
    "free": free,
    "separatrix": separatrix,
    "heavy": heavy,
    "upright": upright,
    "heavy_body": heavy_body,
    "torques": torques,
    "tables": tables,
    "axial": axial,
    "dissipation": dissipation,
    "gradient": gradient,
    "orbiting": orbiting,
    "functions": functions,
    "hinged": hinged,
    "inverted": inverted,
    "rolling": rolling,
    "sliding": sliding,
    "idle": idle,
    "mesh": mesh,
    "deforming": deforming,
    "long": long,
    "extreme": extreme,
    "nearly": nearly,
    "nearly_heavy": nearly_heavy,
    "methods": methods,
    "stiff": stiff,
}
