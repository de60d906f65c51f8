"""One case: what the package claims, what is true, and what it says beside."""

from __future__ import annotations

import math
import time
import warnings
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import mpmath
import numpy as np

import inertia
from inertia.errors import InertiaError
from inertia_meshes import path

from . import deforming, held, meshes, rigid
from .quad import TooLongError
from .scenes import Case

FLOOR = 2.0**-52
"""rad: an error below it is counted as this in the ratio of claim and error; an attitude is rounded to about it."""


@dataclass(frozen=True)
class Verdict:
    """What became of a case.

    `outcome` is "held", "exceeded", "refused", "undecided" (the truth is not known to within the claim), "dear" (the
    truth takes too many steps) or "fault"; errors in rad, at the worst sample.
    """

    kind: str
    seed: int
    number: int
    outcome: str
    model: str = ""
    method: str = ""
    claim: float = math.nan
    error: float = math.nan
    oracle: float = math.nan
    sentence: str = ""
    warnings: tuple[str, ...] = ()
    until: float | None = None
    seconds: float = 0.0
    oracle_seconds: float = 0.0

    @property
    def ratio(self) -> float:
        """Claim over error."""
        return self.claim / max(self.error, FLOOR)


def judge(case: Case) -> Verdict:
    """Run a case and compare."""
    begin = time.process_time()
    about = {"kind": case.kind, "seed": case.seed, "number": case.number}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            scene = scene_of(case)
            run = inertia.simulate(scene)
    except InertiaError as error:
        return Verdict(**about, outcome="refused", sentence=str(error), seconds=time.process_time() - begin)
    except Exception as error:  # whatever it is, it is a fault
        return Verdict(**about, outcome="fault", sentence=f"{type(error).__name__}: {error}")
    middle = time.process_time()
    told = {
        "model": run.model,
        "method": run.error.method,
        "claim": float(run.error.reached),
        "warnings": run.warnings,
        "seconds": middle - begin,
    }
    try:
        truth = truth_of(case, scene, run.time)
    except TooLongError as error:
        return Verdict(**about, **told, outcome="dear", sentence=str(error))
    off, known = truth.off(run.attitude), truth.error
    counted = np.ones(len(off), dtype=bool)
    worst = int(np.argmax(np.where(counted, off - known, -1.0)))
    claim = told["claim"]
    if not off[worst] - known[worst] <= claim:
        outcome = "exceeded"
    else:
        outcome = "undecided" if known[counted].max() > max(claim, FLOOR) else "held"
    return Verdict(
        **about,
        **told,
        outcome=outcome,
        error=float(off[worst]),
        oracle=float(known[worst]),
        oracle_seconds=time.process_time() - middle,
    )


def scene_of(case: Case) -> inertia.Scene:
    """Return the scene as the package takes it."""
    table = dict(case.scene)
    loads = [dict(load) for load in table.get("load", [])]
    if case.function:
        loads.append({"kind": "torque", "torque": torque_function(case.function)})
    table = {"schema": 1, **table, "load": loads}
    if case.triangles is None:
        return inertia.Scene.from_dict(table, Path(path("cube.stl")).parent)
    with TemporaryDirectory() as folder:
        meshes.write_stl(Path(folder) / table["body"]["part"], np.array(case.triangles))
        return inertia.Scene.from_dict(table, folder)


def torque_function(function: dict[str, Any]) -> Any:
    """Return the torque that `function` describes as a user would write it, in float64."""
    terms = []
    if "sine" in function:
        wave, torque = function["sine"], np.array(function["sine"]["torque"])
        terms.append(lambda t, q, w: torque * math.sin(wave["rate"] * t + wave["phase"]))
    if "gauss" in function:
        bell, push = function["gauss"], np.array(function["gauss"]["torque"])
        terms.append(lambda t, q, w: push * math.exp(-(((t - bell["time"]) / bell["width"]) ** 2)))
    if "pulse" in function:
        (t0, t1), blow = function["pulse"]["times"], np.array(function["pulse"]["torque"])
        terms.append(lambda t, q, w: blow if t0 <= t < t1 else 0.0 * blow)
    if "drag" in function:
        factor = function["drag"]["factor"]
        terms.append(lambda t, q, w: -factor * float(np.linalg.norm(w)) * np.asarray(w))
    if "servo" in function:
        gains = np.array(function["servo"]["gains"])
        terms.append(lambda t, q, w: -gains * q[3] * np.asarray(q[:3]))
    return lambda t, q, w: sum(term(t, q, w) for term in terms)


def truth_of(case: Case, scene: inertia.Scene, times: np.ndarray) -> rigid.Truth:
    """Return the true motion at `times` (n,)."""
    if "part" in case.scene:
        return deforming.follow(case.scene, times)
    with mpmath.workdps(rigid.DIGITS):
        table = case.scene["body"]
        if "part" in table:
            triangles = None if case.triangles is None else np.array(case.triangles, dtype="<f4")
            body = meshes.body_of(table, triangles, scene.body.axes)
        else:
            body = rigid.body_of(table, scene.body.axes)
    if case.kind == "long":
        return rigid.closed_form(case.scene, body, times)
    match case.scene.get("constraint", {}).get("kind"):
        case "hinge":
            return held.hinge(case.scene, body, times)
        case "rolling":
            return held.roll(case.scene, body, times)
    return rigid.follow(case.scene, body, times, case.function)


def reproduction(case: Case) -> dict[str, Any]:
    """Return the case as JSON."""
    return {name: value for name, value in asdict(case).items() if value not in (None, {}, "")}
