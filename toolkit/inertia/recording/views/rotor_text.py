"""What the screen of a rotor says in words: unbalance with its bounds, verdict, list of operations, and notes.

A figure that its bounds do not tell from zero is never written as one: it is "below" what it can be at most.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from pathlib import Path

from inertia.balancing.balance import Balance
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.shop_digits import ShopDigits, shop_digits
from inertia.balancing.shop_units import in_degrees, in_gmm
from inertia.balancing.unbalance import Unbalance
from inertia.recording.summary import markdown, sentence

TURNS = {"ccw": "counter-clockwise", "cw": "clockwise"}

_LOST = 1e-6  # of what is permissible
_RESOLVED = 2.0  # bounds: a size that is no larger says little more than that it is small
_DIGITS, _FEWEST = 4, 3  # of a figure; without what it may be off by, where its last digit is known without that


def size_text(size: float, bound: float, limit: float, unit: str) -> str:
    """Return a size with what it may be off by, or what it stays below where that is all that is known.

    Parameters
    ----------
    size, bound : what was computed, and how far from it the truth may be
    limit : what is permissible: what is lost beside it is none
    unit : of all three, or nothing

    >>> size_text(247.2, 3.21, 109.9, "g·mm"), size_text(0.0997, 0.656, 109.9, "g·mm")
    ('247.2 ± 3.3 g·mm', 'below 0.76 g·mm')
    >>> size_text(2.2e-15, 3e-15, 0.5, "g·mm"), size_text(0.01, 1e-15, 0.5, "g·mm")
    ('none', '0.01000 g·mm')
    """
    if size + bound <= _LOST * limit:
        return "none"
    unit = f" {unit}" if unit else ""
    if not resolved(size, bound):
        return f"below {_raised(size + bound)}{unit}"
    power = math.floor(math.log10(size))
    for digits in range(_DIGITS, _FEWEST - 1, -1):
        if bound < 10.0 ** (power + 1 - digits):
            return f"{size:.{max(0, digits - 1 - power)}f}{unit}"
    uncertain, decimals = _raised(bound), max(0, _DIGITS - 1 - power)
    return f"{size:.{min(decimals, len(uncertain.partition('.')[2]))}f} ± {uncertain}{unit}"


def resolved(size: float, bound: float) -> bool:
    """Say whether a size is told from zero so well that it is drawn, and written as a figure."""
    return size > _RESOLVED * bound


def angle_text(vector: complex, bound: float) -> str:
    """Return where a vector points, in degrees, with what that may be off by; nothing where it may point anywhere.

    >>> angle_text(-3.0 - 3.0j, 1e-9), angle_text(3j, 0.5), angle_text(3j, 4.0)
    ('225.0°', '90 ± 10°', '')
    """
    if not resolved(abs(vector), bound):
        return ""
    off = math.degrees(math.asin(bound / abs(vector)))
    angle = in_degrees(vector)
    if off < 0.05:
        return f"{round(angle, 1) % 360.0:.1f}°"
    decimals = 1 if off < 1 else 0
    raised = math.ceil(off * 10.0**decimals) / 10.0**decimals
    return f"{round(angle, decimals) % 360.0:.{decimals}f} ± {raised:.{decimals}f}°"


def vector_text(vector: complex, bound: float, limit: float, unit: str = "g·mm", *, short: bool = False) -> str:
    """Return an unbalance (kg m) in g·mm with its angle, or what it stays below; `short` of what the angle is off by.

    >>> vector_text(3e-6 + 3e-6j, 1e-12, 1e-6), vector_text(1e-9j, 2e-9, 1e-6)
    ('4.243 g·mm at 45.0°', 'below 0.0030 g·mm')
    >>> vector_text(3e-6j, 1e-7, 1e-6), vector_text(3e-6j, 1e-7, 1e-6, short=True)
    ('3.00 ± 0.10 g·mm at 90 ± 2°', '3.00 ± 0.10 g·mm at 90°')
    """
    text = size_text(in_gmm(vector), in_gmm(bound), in_gmm(limit), unit)
    angle = "" if text == "none" else angle_text(vector, bound)
    if short and " ±" in angle:
        angle = f"{angle.partition(' ±')[0]}°"
    return f"{text} at {angle}" if angle else text


def force_text(balance: Balance, unbalance: Unbalance, number: int, unit: str = "N") -> str:
    """Return the force on bearing A (0) or B (1), N, with what it may be off by."""
    squared = balance.rotor.speed**2
    return size_text(
        abs(balance.forces(unbalance)[number]),
        squared * bearing_bounds(balance, unbalance)[number],
        squared * balance.tolerance.permissible[number],
        unit,
    )


def bearing_bounds(balance: Balance, unbalance: Unbalance) -> tuple[float, float]:
    """Return how far the vectors in the tolerance planes may be off, kg m."""
    a, b = (math.fsum(each.values()) for each in unbalance.bounds_in_planes(balance.tolerance_planes))
    return a, b


def plane_bounds(balance: Balance, unbalance: Unbalance) -> list[float]:
    """Return how far the vectors in the correction planes may be off, kg m; one alone takes the static unbalance."""
    if len(balance.planes) < 2:
        return [unbalance.static_bound] * len(balance.planes)
    return [math.fsum(each.values()) for each in unbalance.bounds_in_planes([k.z for k in balance.planes])]


def states(balance: Balance) -> list[tuple[str, str, Unbalance]]:
    """Return (name, verdict, unbalance) of the rotor as modelled and, where something was done about it, corrected."""
    first = f"as {balance.origin}"
    if balance.correction is None or not balance.correction.operations:
        return [(first, balance.verdict.outcome.upper(), balance.initial)]
    return [
        (first, balance.initial_verdict.outcome.upper(), balance.initial),
        ("corrected", balance.verdict.outcome.upper(), balance.residual),
    ]


def verdict_text(balance: Balance) -> str:
    """Return the verdict, and what each plane and bearing has, in Markdown."""
    every = states(balance)
    before = "".join(f", {verdict} {name}" for name, verdict, _ in every[:-1])
    lines = [
        f"**{balance.verdict.outcome.upper()}**: {markdown(Path(balance.rotor.name).name)}, "
        f"{every[-1][0]}{before}. {sentence('; '.join(balance.verdict.qualified))}".strip(),
        "",
        *_planes(balance, every),
        *_forces(balance, every),
    ]
    return "\n".join(lines)


def _planes(balance: Balance, every: list[tuple[str, str, Unbalance]]) -> Iterator[str]:
    yield f"| | Limit | {' | '.join(name.capitalize() for name, _, _ in every)} |"
    yield f"|-|-|{'-|' * len(every)}"
    limits = balance.tolerance.permissible
    for k, (name, limit) in enumerate(zip("AB", limits, strict=True)):
        cells = [
            vector_text(u.in_planes(*balance.tolerance_planes)[k], bearing_bounds(balance, u)[k], limit, "", short=True)
            for _, _, u in every
        ]
        yield f"| Bearing {name}, g·mm | {_rounded(in_gmm(limit))} | {' | '.join(cells)} |"
    for k, plane in enumerate(balance.planes):
        cells = [
            vector_text(vector, plane_bounds(balance, unbalance)[k], max(limits), "", short=True)
            for (_, _, unbalance), vector in zip(every, (plane.initial, plane.residual), strict=False)
        ]
        yield f"| {markdown(plane.id)}, g·mm | | {' | '.join(cells)} |"


def _forces(balance: Balance, every: list[tuple[str, str, Unbalance]]) -> Iterator[str]:
    for k, name in enumerate("AB"):
        limit = balance.rotor.speed**2 * balance.tolerance.permissible[k]
        cells = " | ".join(force_text(balance, unbalance, k, "") for _, _, unbalance in every)
        yield f"| Force on {name}, N | {_rounded(limit)} | {cells} |"


def work_text(balance: Balance) -> str:
    """Return the list of operations in Markdown, numbered as they are in the views; what there is instead of one."""
    operations = () if balance.correction is None else balance.correction.operations
    if not operations:
        inside = balance.initial_verdict.outcome == "pass"
        return "Nothing has to be done." if inside else "Nothing is done: no plane has a method of correction."
    zs = {plane.id: plane.z for plane in balance.planes}
    digits = shop_digits(balance)
    lines = ["| | Plane | Angle | Work, mm | Mass |", "|-|-|-|-|-|"]
    for number, work in enumerate(operations, 1):
        at = place_text(work, digits)
        mass = f"{'+' if work.method == 'add' else '−'}{_rounded(1e3 * work.mass, digits.mass)} g"
        place = f"{markdown(work.plane)}, z {_plain(1e3 * zs.get(work.plane, work.z), digits.place)}"
        lines.append(f"| {number} | {place} | {at} | {_work(work, digits)} | {mass} |")
    return "\n".join(lines)


def place_text(work: Operation, digits: ShopDigits) -> str:
    """Return the angle at which an operation is done."""
    decimals = max(1, digits.angle)
    return f"{round(math.degrees(work.angle), decimals) % 360.0:.{decimals}f}°"


def _work(work: Operation, digits: ShopDigits) -> str:
    """Return what is done in a few words, in mm."""
    at = f"r {_plain(1e3 * work.radius, digits.place)}"
    if work.item is not None:
        return f"{work.pieces} × {markdown(work.item)}, {at}"
    depth = "" if work.depth is None else _plain(1e3 * work.depth, digits.depth)
    if work.arc is not None and work.half_angle is not None:
        arc = _plain(math.degrees(2.0 * work.half_angle), digits.ends)
        return f"arc of {arc}°, {depth} deep, {at}"
    if work.depth is not None and work.tool_diameter is not None:
        way = "axial" if work.kind == "drill_axial" else "radial"
        return f"{way} Ø{_plain(1e3 * work.tool_diameter, digits.tool)}, {depth} deep, {at}"
    if work.depth is not None:
        return f"flat, {depth} deep, {at}"
    return f"point mass, {at}"


def notes_text(balance: Balance, speed: float, notes: Iterable[str]) -> str:
    """Return how it is shown and what was taken for granted; `speed` is that of the playback, rotor s in a second."""
    rotor = balance.rotor
    rpm = rotor.fields.service.rpm
    slowed = f", {1.0 / speed:.6g} times slower" if speed != 1 else ""
    lines = [
        f"The shaft turns {TURNS[balance.shaft.rotation]} seen from B looking toward A, at {rpm:.6g} r/min; on the "
        f"screen at {rpm * speed:.4g} r/min{slowed}. Angles run counter-clockwise from the zero mark, 0°, seen the "
        "same way, and are those of heavy spots; in the list of work they are where it is done.",
        "",
        f"{balance.tolerance.standard}: {balance.tolerance.rule}. {' '.join(map(sentence, _reasons(balance)))}",
        "",
        f"**On the screen.** {' '.join(sentence(each) for each in notes)}",
    ]
    if balance.rigid is not None:
        lines += ["", sentence(balance.rigid.text)]
    return "\n".join([*lines, "", *(f"- {note}" for note in balance.notes)])


def _reasons(balance: Balance) -> Iterator[str]:
    """Yield what the table of planes does not say of the verdict."""
    planes = balance.verdict.planes
    yield from (plane.why for plane in planes if plane.outcome == "undecided")
    yield from balance.verdict.why[len(planes) :]


def _rounded(value: float, decimals: int = 0) -> str:
    """Return a value with four digits, or so many decimals where these are more, never in powers of ten."""
    if value == 0:
        return "0"
    return f"{value:.{max(decimals, _DIGITS - 1 - math.floor(math.log10(abs(value))))}f}"


def _plain(value: float, decimals: int) -> str:
    """Return a figure of the work, mm or degrees, with two decimals, or so many where these are more, but no zeros."""
    return f"{value:.{max(2, decimals)}f}".rstrip("0").rstrip(".")


def _raised(value: float) -> str:
    """Return a value rounded up to two digits, so that it stays a bound."""
    if value == 0:
        return "0"
    decimals = 1 - math.floor(math.log10(value))
    unit = 10.0**-decimals
    raised = math.ceil(value / unit * (1 - 1e-12)) * unit
    return f"{raised:.{max(0, decimals)}f}"
