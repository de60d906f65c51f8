"""One case: what the package claims, what is true, and what it says beside."""

from __future__ import annotations

import math
import re
import time
import warnings
from dataclasses import asdict, dataclass, replace
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

_ADVICE = re.compile(r"(?:ask for|reaches) ([\d.]+(?:e[-+]?\d+)?) rad")

FLOOR = 2.0**-52
"""rad: an error below it is counted as this in the ratio of claim and error; an attitude is rounded to about it."""


@dataclass(frozen=True)
class Verdict:
    """What became of a case.

    `outcome` is "held", "exceeded", "refused", "undecided" (the truth is not known to within the claim), "dear" (the
    truth takes too many steps), "misadvised" (refused, and refused again at the accuracy that the refusal names) or
    "fault". The sentence is that of the refusal, also of runs that were made again as it advises. Errors in rad, at the
    worst sample.
    """

    kind: str
    seed: int
    number: int
    outcome: str
    model: str = ""
    method: str = ""
    claim: float = math.nan
    error: float = math.nan
    truth: float = math.nan
    sentence: str = ""
    warnings: tuple[str, ...] = ()
    until: float | None = None
    seconds: float = 0.0
    truth_seconds: float = 0.0

    @property
    def ratio(self) -> float:
        """Claim over error."""
        return self.claim / max(self.error, FLOOR)


def judge(case: Case) -> Verdict:
    """Run a case and compare; one that is refused for its accuracy runs again at that which is named."""
    begin = time.process_time()
    about: dict[str, Any] = {"kind": case.kind, "seed": case.seed, "number": case.number}
    scene, run, refusal = None, None, ""
    for attempt in (0, 1):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                scene = scene_of(case)
                run = inertia.simulate(scene)
            break
        except InertiaError as error:
            refusal, before = str(error), refusal
            advice = _ADVICE.search(refusal)
            if attempt or advice is None:
                outcome = "misadvised" if before else "refused"
                words = f"{before} – and then: {refusal}" if before else refusal
                return Verdict(**about, outcome=outcome, sentence=words, seconds=time.process_time() - begin)
            setting = {**case.scene["run"], "accuracy": float(advice[1])}
            case = replace(case, scene={**case.scene, "run": setting})
        except Exception as error:  # whatever it is, it is a fault
            return Verdict(**about, outcome="fault", sentence=f"{type(error).__name__}: {error}")
    assert scene is not None
    assert run is not None
    # A plane that pulls, as it must after a lift-off, is no part of the equations of the truth: up to there, then.
    leaves = min((each.time for each in run.events if "leaves the plane" in each.what), default=math.inf)
    if scene.constraint.kind == "sliding" and 0 < leaves < run.time[-1]:
        scene = replace(scene, run=replace(scene.run, duration=0.999 * leaves))
        run = inertia.simulate(scene)
    middle = time.process_time()
    error = run.error
    until = error.until
    known = min(error.inputs, error.requested) if until < run.time[-1] else error.inputs
    about |= {
        "model": run.model,
        "method": error.method,
        "claim": float(error.reached + known),
        "warnings": run.warnings,
        "seconds": middle - begin,
        "until": until if until < run.time[-1] else None,
        "sentence": refusal,
    }
    try:
        truth = truth_of(case, scene, run.time)
    except TooLongError:
        return Verdict(**about, outcome="dear", truth_seconds=time.process_time() - middle)
    rows = run.time <= min(until, leaves if scene.constraint.kind == "sliding" else math.inf)
    off, apart = truth.off(run.attitude)[rows], truth.error[rows]
    worst = int(np.argmax(off - apart))
    if not off[worst] - apart[worst] <= about["claim"]:
        outcome = "exceeded"
    else:
        outcome = "undecided" if apart.max() > max(about["claim"], FLOOR) else "held"
    return Verdict(
        **about,
        outcome=outcome,
        error=float(off[worst]),
        truth=float(apart[worst]),
        truth_seconds=time.process_time() - middle,
    )


def scene_of(case: Case) -> inertia.Scene:
    """Return the scene as the package takes it."""
    table = dict(case.scene)
    loads = [dict(load) for load in table.get("load", [])]
    if case.function:
        pulse = case.function.get("pulse", {})
        told = {"breaks": pulse["times"], "longest_step": table["run"]["duration"]} if pulse.get("declared") else {}
        if told and "gauss" in case.function:
            told["longest_step"] = case.function["gauss"]["width"]
        loads.append({"kind": "torque", "torque": torque_function(case.function), **told})
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
        case "sliding":
            return held.slide(case.scene, body, times)
    return rigid.follow(case.scene, body, times, case.function)


def reproduction(case: Case) -> dict[str, Any]:
    """Return the case as JSON."""
    return {name: value for name, value in asdict(case).items() if value not in (None, {}, "")}
