"""A scene with other numbers in some of its fields, which are named by the paths that errors name."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import fields, replace
from difflib import get_close_matches
from numbers import Real
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.documents import FieldError
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.deforming.jointed_body import JointedBody
from inertia.dynamics.models.deforming.joints import JointedPart
from inertia.dynamics.scene.body import SceneBody, nearest
from inertia.dynamics.scene.document import Scene
from inertia.errors import GeometryError
from inertia.records import dataclass

_BODY = ("mass", "center_of_mass", "inertia", "principal_moments")
_OF_PART = ("density", "scale")
_ONCE = ("density", "shell", "wire", "sigma", "scale")
"""Fields of a mesh, which is integrated once: where they are not among those that vary, another one does instead."""

_LEAST = 1e-12  # of the correlations, below which a direction is taken for one that nothing is uncertain in
_PART = ("mass", "center_of_mass", "inertia", "principal_moments")
_PATH = re.compile(r"(?P<section>[a-z_]+(?:\[\d+\])?(?:\.joint\[\d+\])?)\.(?P<name>[a-z_]+)(?P<at>(?:\[\d+\])*)")

Entries = dict[tuple[int, ...], float]
"""Numbers by where they stand in a field; by () in one that is a number."""


@dataclass(frozen=True)
class _Field:
    section: str
    name: str
    at: tuple[int, ...]

    @classmethod
    def of(cls, path: str) -> _Field:
        match = _PATH.fullmatch(path)
        if match is None:
            raise FieldError(path, "is no field of a scene: name one by its path, as start.angular_velocity[2]")
        return cls(match["section"], match["name"], _indices(match["at"]))


def _indices(text: str) -> tuple[int, ...]:
    return tuple(int(k) for k in re.findall(r"\[(\d+)\]", text))


def value_at(scene: Scene, path: str) -> Any:
    """Return the number, or the array of them, that a path names; raise `FieldError` where there is none.

    >>> scene = Scene.from_dict({"body": {"principal_moments": [1, 2, 3]},
    ...                          "start": {"angular_velocity": [0, 10, 0.001]}, "run": {"duration": 60}})
    >>> value_at(scene, "start.angular_velocity[2]"), value_at(scene, "body.principal_moments").tolist()
    (0.001, [1.0, 2.0, 3.0])
    """
    field = _Field.of(path)
    value = _stated(scene, field, path)
    if value is None:
        raise FieldError(path, "is not stated in the scene: state it there, to vary it")
    if isinstance(value, bool) or not isinstance(value, Real | np.ndarray):
        raise FieldError(path, "is no number: vary one that is")
    try:
        entry = np.asarray(value)[field.at]
    except IndexError:
        raise FieldError(path, f"is not there: the field has the shape {np.asarray(value).shape}") from None
    return entry if np.ndim(entry) else float(entry)


def _stated(scene: Scene, field: _Field, path: str) -> Any:
    section = _section(scene, field.section, path)
    if isinstance(section, SceneBody):
        names: tuple[str, ...] = _BODY if section.properties is None else (*_BODY, *_OF_PART)
        names = names if section.covariance is None else (*names, "uncertainty")
    elif field.section.startswith("part") and ".joint" not in field.section:
        names = _PART
    else:
        names = tuple(each.name for each in fields(section))
    if field.name not in names:
        if field.name in _ONCE and (instead := _instead(section, field.name)):
            raise FieldError(path, f"does not vary, as a part is integrated once: {instead}")
        close = get_close_matches(field.name, names, n=1, cutoff=0.5)
        hint = f"did you mean {close[0]}?" if close else f"use one of {', '.join(names)}"
        raise FieldError(path, f"is unknown: {hint}")
    if field.name == "density":
        return section.properties.mass / section.properties.volume
    if field.name == "scale":
        return 1.0
    if field.name == "uncertainty":
        return np.zeros(deviations(section).shape[1])
    if field.name == "principal_moments":
        return section.moments if isinstance(section, SceneBody) else np.diagonal(section.inertia)
    return getattr(section, field.name)


def _instead(section: Any, name: str) -> str:
    """Return what to vary in place of a field of a mesh; "" where there is no mesh."""
    if not isinstance(section, SceneBody):
        return f"vary its {', '.join(_PART[:-1])} or {_PART[-1]}" if isinstance(section, JointedPart) else ""
    if section.properties is None:
        return ""
    if name == "sigma":
        return "vary body.uncertainty, which draws what noise of that size makes uncertain"
    return "vary body.density, as mass and tensor are in proportion to either"


def _section(scene: Scene, name: str, path: str) -> Any:
    """Return the section of a scene that a path names."""
    kind, _, rest = name.partition("[")
    number = _indices(f"[{rest}") if rest else ()
    assembly = scene.body.assembly
    if kind == "run":
        raise FieldError(path, "says how a motion is followed, and is the same for all draws: change it in the scene")
    if name in ("start", "constraint"):
        return getattr(scene, name)
    if name == "body" and assembly is None:
        return scene.body
    try:
        if kind == "load" and len(number) == 1:
            return scene.applied_loads[number[0]]
        if kind == "part" and assembly is not None and number:
            part = assembly.parts[number[0]]
            return part.joints[number[1]] if len(number) == 2 else part
    except IndexError:
        raise FieldError(path, "is not in the scene: there are fewer of them, counted from 0") from None
    raise FieldError(path, "is not in the scene: name a field of start, constraint, load[k], body or part[k]")


def deviations(body: SceneBody) -> Float:
    """Return what one standard deviation of each of k independent causes makes of a body whose figures are uncertain.

    The columns (10, k) are of mass, centre of mass and the elements xx, yy, zz, xy, xz, yz of the tensor, and their
    outer products add up to the covariance: the eigenvectors of the correlations, the largest first.
    """
    assert body.covariance is not None  # `value_at` saw to it
    size = np.sqrt(np.maximum(body.covariance[1:, 1:].diagonal(), 0.0))
    unit = np.where(size > 0, size, 1.0)
    values, vectors = np.linalg.eigh(body.covariance[1:, 1:] / np.outer(unit, unit))
    order = np.argsort(-values)[: int((values > _LEAST * max(values.max(), 0.0)).sum())]
    signs = np.sign(vectors[np.abs(vectors).argmax(axis=0), range(len(values))])
    columns: Float = (unit[:, None] * vectors * signs * np.sqrt(np.maximum(values, 0.0)))[:, order]
    return columns


def tensor_of(elements: Float) -> Float:
    """Return symmetric tensors (…, 3, 3) of elements xx, yy, zz, xy, xz, yz (…, 6)."""
    return elements[..., [[0, 3, 4], [3, 1, 5], [4, 5, 2]]]


def changed(scene: Scene, values: Mapping[str, float]) -> Scene:
    """Return a scene with numbers in place of others, by their paths; the rest as it is.

    An attitude is brought back to unit length. The axes that ``frame = "principal"`` means stay those of the scene, and
    where entries of the tensor change, they are the nearest of its principal axes. A mass or density of a part
    scales its tensor, ``scale`` its lengths, ``uncertainty`` moves its figures by standard deviations (`deviations`),
    and any other field of a body is taken as it is stated.

    Raises `UsageError` and `GeometryError` where the scene would make no sense.

    >>> scene = Scene.from_dict({"body": {"principal_moments": [1, 2, 3]},
    ...                          "start": {"angular_velocity": [0, 10, 0.001]}, "run": {"duration": 60}})
    >>> changed(scene, {"start.angular_velocity[0]": 0.5}).start.angular_velocity.tolist()
    [0.5, 10.0, 0.001]
    """
    sections: dict[str, dict[str, dict[tuple[int, ...], float]]] = {}
    for path, value in values.items():
        field = _Field.of(path)
        sections.setdefault(field.section, {}).setdefault(field.name, {})[field.at] = value
    loads = list(scene.applied_loads)
    other: dict[str, Any] = {}
    parts: dict[str, Any] = {}
    for name, entries in sections.items():
        if name == "body":
            other["body"] = _body(scene.body, entries)
        elif name.startswith("part"):
            parts[name] = entries
        else:
            section = _section(scene, name, name)
            new = {field: _filled(getattr(section, field), each) for field, each in entries.items()}
            if "attitude" in new and name == "start" and new["attitude"].any():
                new["attitude"] = quaternion.normalise(new["attitude"])
            made = replace(section, path=name, **new)
            if name in ("start", "constraint"):
                other[name] = made
            else:
                loads[_indices(name)[0]] = made
    if parts:
        other["body"] = _assembly(scene.body, parts)
    return replace(scene, applied_loads=tuple(loads), **other)


def _filled(value: Any, entries: Entries) -> Any:
    """Return a field with numbers in place of others."""
    if () in entries:
        return entries[()]
    array = np.array(value, dtype=np.float64)
    for at, number in entries.items():
        array[at] = number
    return array


def _body(body: SceneBody, entries: Mapping[str, Entries]) -> SceneBody:
    properties, mass = body.properties, body.mass
    if "density" in entries:
        assert properties is not None  # `value_at` saw to it
        if "mass" in entries:
            raise FieldError("body.density", "varies beside body.mass, which follows from it: vary one of them")
        mass = entries["density"][()] * properties.volume
    elif "mass" in entries:
        mass = entries["mass"][()]
    share, scale = 1.0, entries.get("scale", {}).get((), 1.0)
    if not 0 < scale < np.inf:
        raise FieldError("body.scale", f"is {scale:g}: it must be positive and finite")
    if mass is not None and "mass" not in entries:
        mass *= scale**3
    if properties is not None:
        assert mass is not None  # a part has one
        if not 0 < mass < np.inf:
            raise GeometryError(f"the mass is {mass:.6g} kg: it must be positive and finite")
        if not entries.keys() - {"mass", "density"}:
            if mass == body.mass:
                return body
            scaled = properties.with_mass(mass)
            return replace(body, inertia=scaled.inertia, mass=mass, axes=body.axes, properties=scaled)
        share = mass / (body.mass or mass)
    center, tensor, axes = scale * body.center_of_mass, share * scale**2 * body.inertia, body.axes
    if "uncertainty" in entries:
        both = deviations(body)
        more = both @ _filled(np.zeros(both.shape[1]), entries["uncertainty"])
        mass = None if mass is None else mass + more[0]
        center, tensor = center + more[1:4], tensor + tensor_of(more[4:])
        axes = nearest(np.linalg.eigh(tensor)[1], axes)[0]
    center = _filled(center, entries.get("center_of_mass", {}))
    inertia, axes = _tensor(tensor, axes, entries)
    return replace(body, inertia=inertia, mass=mass, center_of_mass=center, axes=axes, properties=None)


def _tensor(inertia: Float, axes: Float, entries: Mapping[str, Entries]) -> tuple[Float, Float]:
    """Return a tensor with other entries or principal moments, and its axes."""
    if "principal_moments" in entries:
        if "inertia" in entries:
            raise FieldError("body.principal_moments", "vary beside body.inertia: vary one of them")
        moments = _filled(np.diagonal(axes.T @ inertia @ axes), entries["principal_moments"])
        tensor = (axes * moments) @ axes.T
        return 0.5 * (tensor + tensor.T), axes
    if "inertia" not in entries:
        return inertia, axes
    both: Entries = {at: x for (i, j), x in entries["inertia"].items() for at in ((i, j), (j, i))}
    tensor = _filled(inertia, both)
    if not np.isfinite(tensor).all():
        return tensor, axes
    return tensor, nearest(np.linalg.eigh(tensor)[1], axes)[0]


def _assembly(body: SceneBody, sections: Mapping[str, Mapping[str, Entries]]) -> SceneBody:
    assert body.assembly is not None  # `value_at` saw to it
    parts = list(body.assembly.parts)
    for name, entries in sections.items():
        k, *joint = _indices(name)
        part = parts[k]
        if joint:
            old = part.joints[joint[0]]
            new = replace(
                old, path=name, **{field: _filled(getattr(old, field), each) for field, each in entries.items()}
            )
            parts[k] = replace(part, joints=(*part.joints[: joint[0]], new, *part.joints[joint[0] + 1 :]))
            continue
        own = {
            field: _filled(getattr(part, field), each)
            for field, each in entries.items()
            if field in ("mass", "center_of_mass")
        }
        diagonal: Entries = {(i, i): x for (i,), x in entries.get("principal_moments", {}).items()}
        tensor: Entries = {at: x for (i, j), x in entries.get("inertia", {}).items() for at in ((i, j), (j, i))}
        parts[k] = replace(part, inertia=_filled(part.inertia, {**diagonal, **tensor}), **own)
    made = SceneBody.of_assembly(JointedBody(tuple(parts)), body.meshes, body.notes)
    return replace(made, axes=nearest(made.axes, body.axes)[0])
