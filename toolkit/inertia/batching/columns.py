"""The columns of a batch's rows: name, kind, unit and meaning; their order is that of the table."""

from __future__ import annotations

from typing import Literal

from inertia.tables import Column

SCHEMA = "inertia/batch-rows/1"

State = Literal["answered", "refused", "unreadable", "crashed", "timed_out"]
STATES: tuple[State, ...] = ("answered", "refused", "unreadable", "crashed", "timed_out")


def _text(name: str, meaning: str) -> Column:
    return Column(name, "text", "", meaning)


def _count(name: str, meaning: str) -> Column:
    return Column(name, "integer", "", meaning)


def _number(name: str, unit: str, meaning: str) -> Column:
    return Column(name, "number", unit, meaning)


def _truth(name: str, meaning: str) -> Column:
    return Column(name, "truth", "", meaning)


FILE = (
    _text("path", "the file; of one of several meshes in an archive, the archive's path and its name there"),
    _text("sha256", "of its bytes; null where they could not be had, and of what in an archive its process died of"),
    _text("state", "answered, refused, unreadable, crashed or timed_out"),
    _count("exit_code", "of the command on this file alone"),
    _text("message", "why there is no answer, or what the answer has to say, in one sentence"),
    _text("place", "where that is: x, y, z in the file's unit"),
)
LAST = (_number("seconds", "s", "spent on the file; null unless timings are asked for: they are never the same"),)

_UNIT = (_text("unit", "of the coordinates"), _text("unit_from", "option, file or assumed"))
_ELEMENTS = ("xx", "yy", "zz", "xy", "xz", "yz")

ANALYSE = (
    *_UNIT,
    _number("density", "kg/m3", "the mean of several"),
    _text("density_from", "option, material, mass, file or assumed"),
    _count("triangles", "outer ones of a volume mesh"),
    _count("bodies", "separate ones"),
    _number("volume", "m3", "of what is enclosed"),
    _number("area", "m2", "of the surface"),
    _number("mass", "kg", "of all bodies"),
    *(_number(f"com_{k}", "m", "centre of mass") for k in "xyz"),
    *(_number(f"i{k}", "kg m2", "about the centre of mass, part axes, tensor signs") for k in _ELEMENTS),
    *(_number(f"i{k}", "kg m2", "principal moment, ascending") for k in (1, 2, 3)),
    *(_number(f"axes_{k}", "", "quaternion that takes principal axes to part axes, w not negative") for k in "xyzw"),
    _text("class", "spherical, prolate, oblate, asymmetric or rotor"),
    _number("error_volume", "", "relative bound"),
    _number("error_mass", "", "relative bound"),
    _number("error_com", "m", "bound of the centre of mass"),
    _number("error_inertia", "", "relative bound (Frobenius norm)"),
    _text("method", "that ran"),
)

CHECK = (
    *_UNIT,
    _count("triangles", "outer ones of a volume mesh"),
    _count("vertices", "different ones"),
    _truth("fit", "whether it bounds an honest volume"),
    _truth("closed", "whether every edge is paired"),
    _truth("consistent", "whether it is wound consistently"),
    _truth("outward", "null where there is no answer"),
    _count("bodies", "separate ones"),
    _truth("crossings_examined", "whether triangles that cross were looked for"),
    _count("errors", "how many findings, without what the orientation forgives"),
    _count("warnings", "how many findings"),
    _text("findings", "their codes, the most important first"),
)

AUDIT = (
    _text("robot", "its name"),
    _text("verdict", "consistent, inconsistent or undecided"),
    _count("links", "of the robot"),
    *(_count(state, "how many links") for state in ("consistent", "inconsistent", "unphysical", "unjudged")),
    _number("stated_mass", "kg", "of all links that state one"),
    _number("worst_mass", "", "largest relative difference of a mass"),
    _number("worst_com", "m", "largest difference of a centre of mass"),
    _number("worst_inertia", "", "largest relative difference of a tensor (Frobenius norm)"),
    _text("findings", "their codes, of all links"),
)

BALANCE = (
    _text("verdict", "pass, conditional, fail or undecided: after the corrections"),
    _text("initial_verdict", "the same before"),
    _number("rpm", "1/min", "highest speed in service"),
    _number("mass", "kg", "of all bodies"),
    _number("static_gmm", "g mm", "static unbalance before corrections"),
    _number("static_deg", "deg", "its angle"),
    _number("couple_gmm2", "g mm2", "couple unbalance about the centre of mass, before corrections"),
    _number("couple_deg", "deg", "its angle"),
    _number("grade_mm_s", "mm/s", "the grade that the rotor just keeps before corrections"),
    *(
        column
        for plane in "ab"
        for column in (
            _number(f"permissible_{plane}_gmm", "g mm", f"limit in tolerance plane {plane.upper()}"),
            _number(f"initial_{plane}_gmm", "g mm", "unbalance there before corrections"),
            _number(f"initial_{plane}_deg", "deg", "its angle"),
            _number(f"residual_{plane}_gmm", "g mm", "unbalance there after corrections"),
            _number(f"residual_{plane}_deg", "deg", "its angle"),
            _number(f"bound_{plane}_gmm", "g mm", "how far the residual may be off"),
            _number(f"residual_95_{plane}_gmm", "g mm", "what 95 % of the parts stay below, by the stated tolerances"),
        )
    ),
    _number("within", "", "share of the parts within the limits, by the stated tolerances"),
    _count("operations", "corrections planned"),
    _text("shares", "JSON: of the variance in planes A and B, by stated tolerance"),
)

COLUMNS: dict[str, tuple[Column, ...]] = {
    verb: (*FILE, *columns, *LAST)
    for verb, columns in {"analyse": ANALYSE, "check": CHECK, "balance": BALANCE, "audit": AUDIT}.items()
}
