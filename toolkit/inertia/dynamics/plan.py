"""`plan`: the smallest model that a scene needs, and why."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np

from inertia.arrays import Float
from inertia.documents import FieldError
from inertia.dynamics.models.candidates import (
    Candidate,
    deforming_candidates,
    free_candidates,
    heavy_candidates,
    rolling_candidates,
)
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.scene.loads import Gravity
from inertia.dynamics.setting import Setting, setting_of
from inertia.errors import FieldPath, placed

SHARE = 0.1
"""Part of the accuracy asked for that a smaller model may cost."""

STEPPED = "Euler equations"
ROLLING = "rolling body"
DEFORMING = "deforming body"
_NOUNS = {
    "torque": "an applied torque",
    "damping": "damping",
    "gravity_gradient": "the gravity gradient",
    "dissipation": "energy lost inside the body",
}
MODELS = (
    "spherical top",
    "steady axis",
    "symmetric top",
    "asymmetric top",
    "heavy symmetric top",
    STEPPED,
    ROLLING,
    DEFORMING,
)


@dataclass(frozen=True, eq=False)
class Plan:
    """What is to be run.

    Attributes
    ----------
    candidate : the model, its axes and moments, and what it costs
    method : the integrator that the scene asks for; None where the model chooses
    why : the reasons, in sentences
    setting : the point that the body turns about, the moments there, and what turns it
    """

    candidate: Candidate
    method: str | None
    why: tuple[str, ...]
    setting: Setting

    @property
    def model(self) -> str:
        """One of `MODELS`."""
        return self.candidate.model

    @property
    def axes(self) -> Float:
        """The model's principal axes (3, 3), columns in part axes."""
        return self.candidate.axes

    @property
    def moments(self) -> Float:
        """The moments (3,) kg m² about them."""
        return self.candidate.moments


def plan(scene: Scene) -> Plan:
    """Return the smallest model that reaches the accuracy which the scene asks for.

    Smaller models take nearly equal moments as equal, or a spin near a principal axis as along it. Each says what that
    costs in rad over the duration (a relative difference δ of moments about δ |ω| T); the first whose cost is within a
    tenth of the accuracy runs. ``run.model`` and ``run.method`` override the choice.

    Raises `UsageError` where the model or method that is asked for does not fit the scene.

    >>> scene = Scene.from_dict({"body": {"principal_moments": [1, 1, 2]},
    ...                          "start": {"angular_velocity": [1, 0, 5]}, "run": {"duration": 10}})
    >>> plan(scene).model
    'symmetric top'
    """
    setting = setting_of(scene)
    why = list(setting.why)
    try:
        candidates = _candidates(scene, setting)
        chosen = _forced(scene, candidates) or _smallest(candidates, scene.run.accuracy, why)
    except FieldError as error:
        raise placed(error, scene.name) from None
    why.append(chosen.why)
    if chosen.cost > 0:
        why.append(f"What this leaves out costs about {chosen.cost:.1g} rad in {scene.run.duration:g} s.")
    if scene.run.model is not None or scene.run.method is not None:
        why.append(f"The scene asks for this {'model' if scene.run.model else 'method'}.")
    return Plan(chosen, scene.run.method, tuple(why), setting)


def _candidates(scene: Scene, setting: Setting) -> list[Candidate]:
    """Return the models that can follow the scene, the smallest first."""
    if scene.constraint.kind == "rolling":
        return rolling_candidates(setting)
    if scene.body.deforms:
        return deforming_candidates(setting)
    acting = dict.fromkeys(_NOUNS[load.kind] for load in scene.applied_loads if not isinstance(load, Gravity))
    integrated = "attitude and angular velocity are integrated."
    if acting:
        why = f"There is no closed form for {' and '.join(acting)}: {integrated}"
    elif setting.weight:
        why = f"There is no closed form for a heavy body that is not symmetric about its centre of mass: {integrated}"
    else:
        why = f"Euler's equations serve any body: {integrated}"
    general = Candidate(STEPPED, setting.axes, setting.moments, 0.0, why)
    closed = [] if acting else [*free_candidates(setting), *heavy_candidates(setting)]
    return [*closed, general]


def _smallest(candidates: list[Candidate], accuracy: float, why: list[str]) -> Candidate:
    for candidate in candidates:
        if candidate.cost <= SHARE * accuracy:
            return candidate
        if candidate.near_miss:
            why.append(
                f"{candidate.near_miss}, but that would cost about {candidate.cost:.1g} rad where "
                f"{accuracy:g} rad are asked for."
            )
    raise FieldError(
        "constraint.kind",
        f'is "rolling", but the body is off a body of revolution by some {_angle(candidates[-1].cost)} after the run: '
        "ask for no finer ",
        FieldPath("run.accuracy"),
        " than ten times that",
    )


def _forced(scene: Scene, candidates: list[Candidate]) -> Candidate | None:
    """Return the candidate that the scene asks for; None where it leaves the choice."""
    run = scene.run
    if run.method is not None:
        _require_method(scene, run.method)
    model = run.model or (None if run.method is None else candidates[-1].model)
    if model is None:
        return None
    if model not in MODELS:
        close = get_close_matches(model, MODELS, n=1, cutoff=0.4)
        hint = f"did you mean {close[0]!r}?" if close else f"use one of {', '.join(map(repr, MODELS))}"
        raise FieldError("run.model", f"is {model!r}, which is unknown: {hint}")
    named = [candidate for candidate in candidates if candidate.model == model]
    if not named:
        fitting = ", ".join(repr(candidate.model) for candidate in candidates)
        raise FieldError("run.model", f"is {model!r}, which does not describe this scene: use one of {fitting}")
    (candidate,) = named
    if candidate.cost > run.accuracy:
        raise FieldError(
            "run.model",
            f"is {model!r}, which would be off by about {_angle(candidate.cost)} after {run.duration:g} s where ",
            FieldPath("run.accuracy"),
            f" asks for {run.accuracy:g} rad: leave the model out",
        )
    if run.method is not None and model not in (STEPPED, ROLLING):
        raise FieldError("run.method", f"is {run.method!r}, but {model!r} is a closed form: leave one of them out")
    return candidate


def _require_method(scene: Scene, method: str) -> None:
    if scene.body.deforms:
        raise FieldError("run.method", f"is {method!r}, but a deforming body has one method of its own: leave it out")
    if scene.constraint.kind == "rolling":
        from inertia.dynamics.models.rolling.motion import METHODS as known
    else:
        from inertia.dynamics.models.stepped.solve import METHODS as known  # type: ignore[assignment]
    if method not in known:
        close = get_close_matches(method, known, n=1, cutoff=0.4)
        hint = f"did you mean {close[0]!r}?" if close else f"use one of {', '.join(map(repr, known))}"
        raise FieldError("run.method", f"is {method!r}, which is unknown: {hint}")


def _angle(cost: float) -> str:
    return f"{cost:.1g} rad" if cost < np.pi else "a whole turn"
