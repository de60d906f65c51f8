"""Standards of permissible unbalance: one table of what each takes from a rotor file and how it comes to its limits.

The table of balance quality grades and the machines that they are meant for is `inertia.balancing.tolerance.GRADES`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from inertia.balancing.tolerance import GRADES, Planes, Tolerance, api, iso_21940_11, mil_std_167_1
from inertia.balancing.unbalance import Unbalance
from inertia.records import dataclass

CATEGORIES: dict[str, tuple[float, tuple[str, ...]]] = {
    "BV-1": (16.0, ("ceiling and attic fans, window units",)),
    "BV-2": (16.0, ("fans for buildings and agriculture, up to 3.7 kW",)),
    "BV-3": (6.3, ("fans for buildings and agriculture, above 3.7 kW", "process and power plant fans, up to 300 kW")),
    "BV-4": (2.5, ("process and power plant fans, above 300 kW (AMCA 204)", "petrochemical fans, above 37 kW")),
    "BV-5": (1.0, ("fans of clean rooms for chips",)),
}
"""The fan application categories of ISO 14694:2003, the balance quality grade of each, and examples.

Its scope ends at 300 kW; ANSI/AMCA 204, which is in harmony with it, goes on. Its tables are not public: these are as
the literature cites them, to be checked against one's own copy.
"""

_FLEXIBLE = (
    "ISO 21940-12 judges a flexible rotor mode by mode: modal tolerances take mode shapes and modal masses, which a "
    "mesh and a speed do not give; the limits shown are those of the grade for a rigid rotor, a guide for low speed"
)


@dataclass(frozen=True)
class Request:
    """What a rotor file says of the tolerance, with the rotor that it is for.

    Attributes
    ----------
    rotor : its mass and centre of mass count
    planes : (A, B) m
    rpm : r/min
    grade : G, mm/s
    category : of ISO 14694
    overhung : see `inertia.balancing.tolerance.allocate`
    """

    rotor: Unbalance
    planes: Planes
    rpm: float
    grade: float | None = None
    category: str | None = None
    overhung: bool | None = None

    def graded(self, grade: float | None) -> Tolerance:
        """Return the tolerance of a balance quality grade for it."""
        assert grade is not None, "the section asks for one"
        return iso_21940_11(grade, self.rotor, self.planes, self.rpm * math.pi / 30.0, self.overhung)


@dataclass(frozen=True)
class Standard:
    """A standard of permissible unbalance.

    Attributes
    ----------
    limits : how it comes to them
    takes : the fields of ``[tolerance]`` that it needs, by its revision; by None where it is not asked for
    says : what it goes by, in words
    """

    limits: Callable[[Request, str | None], Tolerance]
    takes: Mapping[str | None, tuple[str, ...]]
    says: str


def _iso_14694(request: Request, revision: str | None) -> Tolerance:
    grade, machines = CATEGORIES[request.category or ""]
    return replace(
        request.graded(grade), standard=f"ISO 14694:2003, {request.category}, G{grade:g}", meant_for=machines
    )


def _iso_21940_12(request: Request, revision: str | None) -> Tolerance:
    limits = request.graded(request.grade)
    return replace(limits, standard=f"ISO 21940-12:2016, G{request.grade:g} as a guide", undecided=_FLEXIBLE)


def _mil(request: Request, revision: str | None) -> Tolerance:
    name = {"1974": "MIL-STD-167-1", "A": "MIL-STD-167-1A"}[revision or ""]
    return mil_std_167_1(name, request.rotor, request.planes, request.rpm, request.grade)


def _api(name: str) -> Callable[[Request, str | None], Tolerance]:
    return lambda request, revision: api(name, request.rotor, request.planes, request.rpm)


_W_OVER_N = "6350 W/N g·mm per plane, W the journal's load in kg, N in r/min"

STANDARDS: dict[str, Standard] = {
    "ISO 21940-11": Standard(
        lambda request, revision: request.graded(request.grade),
        {None: ("grade",)},
        "U_per = G m/ω, by a balance quality grade, of its table or of a contract",
    ),
    "ISO 21940-12": Standard(_iso_21940_12, {None: ("grade",)}, "flexible rotors, mode by mode: not decided here"),
    "ISO 14694": Standard(_iso_14694, {None: ("category",)}, "fans, by an application category BV-1 to BV-5"),
    "API 610": Standard(_api("API 610"), {None: ()}, _W_OVER_N),
    "API 617": Standard(_api("API 617"), {None: ()}, f"{_W_OVER_N}; from 25000 r/min on W/3.937 g·mm"),
    "MIL-STD-167-1": Standard(
        _mil,
        {"1974": (), "A": ("grade",)},
        'revision "1974": limits by speed and weight; revision "A" of 2005: a grade of the contract',
    ),
}
"""The standards by name: the only list of them."""

FORMER = dict.fromkeys(("ISO 1940", "ISO 1940-1", "ISO 1940-1:2003", "ISO 21940-11:2016"), "ISO 21940-11")
"""Names that ISO 21940-11 had before it took the place of ISO 1940-1, and with its year."""

GRADE = re.compile(r"[Gg] ?(\d+(?:\.\d+)?)")
"""How a balance quality grade is written, as G6.3 or G 6.3."""


def grades_document(rpm: float | None = None) -> dict[str, Any]:
    """Return grades, fan categories and standards as ``inertia/grades/1``; with e_per at a speed (r/min), if given."""
    rows = [
        {
            "grade_mm_s": grade,
            "machines": list(machines),
            "specific_unbalance_um": None if rpm is None else 1e3 * grade / (rpm * math.pi / 30.0),
        }
        for grade, machines in sorted(GRADES.items())
    ]
    return {
        "schema": "inertia/grades/1",
        "rpm": rpm,
        "grades": rows,
        "categories": [
            {"category": name, "grade_mm_s": grade, "machines": list(machines)}
            for name, (grade, machines) in CATEGORIES.items()
        ],
        "standards": [
            {
                "standard": name,
                "fields": {revision or "": list(k) for revision, k in entry.takes.items()},
                "rule": entry.says,
            }
            for name, entry in STANDARDS.items()
        ],
    }
