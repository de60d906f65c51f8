"""`plan`: the smallest model that follows a scene to the accuracy asked for, and why."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

from inertia.arrays import Float
from inertia.documents import FieldError
from inertia.dynamics.models.catalogue import MODELS
from inertia.dynamics.models.model import SHARE, Candidate, Model, Problem, angle_text
from inertia.dynamics.scene.document import Scene
from inertia.errors import FieldPath, placed, require_kind
from inertia.records import dataclass


@dataclass(frozen=True, eq=False)
class Plan:
    """What is to be run.

    Attributes
    ----------
    candidate : the model, its axes and moments, and what it costs
    candidates : all that could follow the scene, the smallest first; the last one is the most general
    method : the integrator that the scene asks for; None where the model chooses
    why : the reasons, in sentences
    """

    candidate: Candidate
    candidates: tuple[Candidate, ...]
    method: str | None
    why: tuple[str, ...]

    @property
    def model(self) -> str:
        """The name of the model."""
        return self.candidate.model.name

    @property
    def problem(self) -> Problem:
        """The point that the body turns about, the moments there, and what turns it."""
        return self.candidate.problem

    @property
    def axes(self) -> Float:
        """The model's principal axes (3, 3), columns in part axes."""
        return self.candidate.axes

    @property
    def moments(self) -> Float:
        """The moments (3,) kg m² about them."""
        return self.candidate.moments

    @property
    def view(self) -> str:
        """The name of the view that records the motion."""
        return self.candidate.model.view(self.problem)


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
    require_kind(scene, Scene, "scene", "inertia.Scene.load(path)")
    problem = Problem.of(scene)
    why = problem.why
    try:
        candidates = [each for model in MODELS if (each := model.candidate(problem)) is not None]
        candidate = _requested(scene, candidates) or _smallest(candidates, scene.run.accuracy, why)
    except FieldError as error:
        raise placed(error, scene.name) from None
    why.append(candidate.why)
    if candidate.cost > 0:
        why.append(f"What this leaves out costs about {candidate.cost:.1g} rad in {scene.run.duration:g} s.")
    if scene.run.model is not None or scene.run.method is not None:
        why.append(f"The scene asks for this {'model' if scene.run.model else 'method'}.")
    return Plan(candidate, tuple(candidates), scene.run.method, tuple(why))


def _smallest(candidates: list[Candidate], accuracy: float, why: list[str]) -> Candidate:
    for candidate in candidates:
        if candidate.cost <= SHARE * accuracy:
            return candidate
        if candidate.near_miss:
            why.append(
                f"{candidate.near_miss}, but that would cost about {candidate.cost:.1g} rad where "
                f"{accuracy:g} rad are asked for."
            )
    raise candidates[-1].model.too_costly(candidates[-1])


def _requested(scene: Scene, candidates: list[Candidate]) -> Candidate | None:
    """Return the candidate that the scene asks for; None where it leaves the choice."""
    run = scene.run
    if run.method is not None:
        _require_method(run.method, candidates[-1].model)
    name = run.model or (None if run.method is None else candidates[-1].model.name)
    if name is None:
        return None
    names = [model.name for model in MODELS]
    if name not in names:
        raise FieldError("run.model", f"is {name!r}, which is unknown: {_hint(name, names)}")
    candidate = next((each for each in candidates if each.model.name == name), None)
    if candidate is None:
        fitting = ", ".join(repr(each.model.name) for each in candidates)
        raise FieldError("run.model", f"is {name!r}, which does not describe this scene: use one of {fitting}")
    if candidate.cost > run.accuracy:
        raise FieldError(
            "run.model",
            f"is {name!r}, which would be off by about {angle_text(candidate.cost)} after {run.duration:g} s where ",
            FieldPath("run.accuracy"),
            f" asks for {run.accuracy:g} rad: leave the model out",
        )
    if run.method is not None and not candidate.model.methods:
        raise FieldError("run.method", f"is {run.method!r}, but {name!r} is a closed form: leave one of them out")
    return candidate


def _require_method(method: str, model: Model) -> None:
    if not model.methods:
        raise FieldError("run.method", f"is {method!r}, but a {model.name} has one method of its own: leave it out")
    if method not in model.methods:
        raise FieldError("run.method", f"is {method!r}, which is unknown: {_hint(method, model.methods)}")


def _hint(name: str, names: Iterable[str]) -> str:
    close = get_close_matches(name, names, n=1, cutoff=0.4)
    return f"did you mean {close[0]!r}?" if close else f"use one of {', '.join(map(repr, names))}"
