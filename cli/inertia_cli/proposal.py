"""What `balance` says of a part alone: the axis in it, what still has to be known, and a command line to go on with."""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Iterator

import numpy as np

from inertia.arrays import Float
from inertia.balancing.axis.journals import AxisCandidate, Journal
from inertia.balancing.tolerance import GRADES

EXIT = 4
"""Nothing was judged."""

_AXES = {(1, 0, 0): "x", (0, 1, 0): "y", (0, 0, 1): "z"}
_STRAIGHT = 1e-6  # of unit length
_DECIMALS = 4
_USUAL = (40.0, 16.0, 6.3, 2.5, 1.0, 0.4)
_SPEED, _GRADE = 3000, 6.3


def proposal(options: argparse.Namespace) -> str:
    """Return lines that propose how to go on with a part of which only the file is named."""
    from inertia.balancing.axis.journals import axis_candidates
    from inertia.mesh.read import read

    part = read(options.part, options.unit)
    candidates = [one for one in axis_candidates(part.triangles) if _outer(one)]
    likely = next((one for one in candidates if len(_outer(one)) > 1), candidates[0] if candidates else None)
    return "\n".join(_lines(options, likely, part.unit.name))


def _lines(options: argparse.Namespace, axis: AxisCandidate | None, unit: str) -> Iterator[str]:
    from inertia.report.numerals import row, wrapped

    yield row("Part", options.part)
    words = ["inertia", "balance", options.part]
    if axis is None:
        yield from wrapped("Axis", "no cylinder was found that says where the shaft runs: say so")
        words += ["--axis", "z", "--bearings", "A,B"]
    else:
        direction, (a, b) = axis.direction, _ends(axis)
        along = _name(direction)
        journals = _outer(axis)
        which = (
            f"the first and last of {len(journals)} coaxial cylinders"
            if len(journals) > 1
            else "the ends of a cylinder"
        )
        radii = " and ".join(dict.fromkeys(f"{_round(journal.radius)}" for journal in (journals[0], journals[-1])))
        yield from wrapped(
            "Axis",
            f"likely {along}, with bearings at {a} and {b}, {which} of radius {radii} {unit}? They are where the rotor "
            "runs, as its drawing says",
        )
        words += ["--axis", along]
        foot = axis.point - float(axis.point @ direction) * direction
        if np.abs(foot).max() > 10.0**-_DECIMALS:
            words += ["--through", ",".join(f"{_round(x)}" for x in foot.tolist())]
        words += ["--bearings", f"{a},{b}"]
    yield from wrapped(
        "Places", f"along the axis from A to B, in {unit}, counted from the origin of the part's coordinates"
    )
    yield row("Machine", "what is it? its kind says the grade (ISO 21940-11), its speed the rest:")
    for grade in _USUAL:
        yield from wrapped("", f"--grade {grade:g}: {', '.join(GRADES[grade])}")
    words += _given(options)
    planes = options.planes or ([] if axis is None else _planes(axis))
    words += ["--rpm", str(_SPEED), "--grade", f"{_GRADE:g}"]
    if planes:
        words += ["--planes", ",".join(f"{_round(z)}" for z in planes)]
        if options.drill is None:
            words += ["--drill", "8,10,12"]
    yield row("Go on with", " ".join(word if word[:1] == "-" else shlex.quote(word) for word in words))
    yield from wrapped(
        "",
        f"with its own speed in place of {_SPEED}, its grade in place of {_GRADE:g}, and the bearings, material and "
        "drills that it has; --to-toml prints it as a rotor file",
    )


def _given(options: argparse.Namespace) -> Iterator[str]:
    """Yield what was said already."""
    for name in ("unit", "material", "density", "mass", "chord", "rotation", "critical_rpm", "drill", "max_depth"):
        value = getattr(options, name)
        if value is not None:
            text = ",".join(f"{k:g}" for k in value) if isinstance(value, list) else f"{value}"
            yield from (f"--{name.replace('_', '-')}", text)
    if options.material is options.density is options.mass is None:
        yield from ("--material", "steel")


def _outer(axis: AxisCandidate) -> list[Journal]:
    return [journal for journal in axis.journals if not journal.bore]


def _ends(axis: AxisCandidate) -> tuple[float, float]:
    first, last = _outer(axis)[0], _outer(axis)[-1]
    half = 0.5 * first.length if first is last else 0.0
    a, b = (float(journal.center @ axis.direction) for journal in (first, last))
    return _round(a - half), _round(b + half)


def _planes(axis: AxisCandidate) -> list[float]:
    """Return the middles of the two largest cylinders between the bearings, in order along the axis."""
    between = _outer(axis)[1:-1] or _outer(axis)
    largest = sorted(between, key=lambda journal: -journal.radius)[:2]
    return sorted({float(journal.center @ axis.direction) for journal in largest})


def _name(direction: Float) -> str:
    for axis, name in _AXES.items():
        if np.abs(direction - axis).max() < _STRAIGHT:
            return name
    return ",".join(f"{_round(x, 9)}" for x in direction.tolist())


def _round(value: float, decimals: int = _DECIMALS) -> float | int:
    rounded = round(value, decimals) + 0.0
    return int(rounded) if rounded == int(rounded) else rounded
