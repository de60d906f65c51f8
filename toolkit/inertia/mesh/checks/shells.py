"""Findings about the shells of a surface that bounds a volume, one function for each kind."""

from __future__ import annotations

from typing import Literal

import numpy as np

from inertia.errors import ABSOLUTE, SHELL, Sentence
from inertia.mesh.checks.crossings import crossing_cavities, overlapping_bodies
from inertia.mesh.checks.findings import Finding, by_severity, counted, listed, middle
from inertia.mesh.checks.surface_topology import Measured
from inertia.mesh.geometry.shells import Shell, bodies

_NOISE = 1e-13  # volume over the sum of the shells' volumes

_State = Literal["sheet", "sound", "inverted", "overlapping"]
_STATES: dict[tuple[str, int], _State] = {
    ("outward", 0): "sound",
    ("inward", 1): "sound",
    ("inward", 0): "inverted",
    ("outward", -1): "inverted",
}
"""The state of a shell by its kind and the winding number around it; the inside of any other counts twice."""


def shell_findings(surface: Measured) -> tuple[Finding, ...]:
    """Return what is wrong with the shells and what they bound, the most important first."""
    if not surface.bounds:
        return ()
    if nothing := _no_volume(surface):
        return (nothing,)
    return by_severity(
        [
            _inward(surface),
            _inverted(surface),
            _contained(surface),
            overlapping_bodies(surface),
            crossing_cavities(surface),
            _sheets(surface),
            _several_bodies(surface),
            _cavities(surface),
        ]
    )


def outward(shells: tuple[Shell, ...]) -> bool | None:
    """Say whether all shells are wound rightly (True), all wrongly (False), or neither (None)."""
    states = {_state(shell) for shell in shells} - {"sheet"}
    if states == {"sound"}:
        return True
    return False if states == {"inverted"} else None


def _state(shell: Shell) -> _State:
    if shell.kind == "sheet":
        return "sheet"
    return _STATES.get((shell.kind, shell.winding_outside), "overlapping")


def _in_state(surface: Measured, state: _State) -> list[Shell]:
    return [shell for shell in surface.shells if _state(shell) == state]


def _no_volume(surface: Measured) -> Finding | None:
    solids = [shell for shell in surface.shells if shell.kind != "sheet"]
    volumes = [shell.signed_volume for shell in solids]
    turned = [(-1) ** shell.depth * abs(shell.signed_volume) for shell in solids]
    # The second sum tells a wall of no thickness from two bodies of which one is inside out.
    if max(abs(sum(volumes)), abs(sum(turned))) > _NOISE * sum(map(abs, volumes)):
        return None
    every, place = np.arange(len(surface.faces)), middle(surface.box)
    text = Sentence(
        f"no volume: the surface {surface.around(place)} folds back on itself everywhere: use ",
        SHELL,
        ", or export a solid",
    )
    return Finding("zero_volume", "error", text, len(every), listed(every), place)


def _sheets(surface: Measured) -> Finding | None:
    sheets = _in_state(surface, "sheet")
    if len(sheets) in (0, len(surface.shells)):
        return None
    at = surface.at_shells(sheets)
    text = (
        f"{counted(at.number, 'shell')} without volume beside the bodies, the first "
        f"{surface.around(at.place)} from triangle {at.faces[0]} on: remove what adds no mass, or give it a "
        "thickness"
    )
    return Finding("zero_volume", "warning", text, *at)


def _inward(surface: Measured) -> Finding | None:
    if outward(surface.shells) is not False:
        return None
    at = surface.at_shells(_in_state(surface, "inverted"))
    volume = sum(shell.signed_volume for shell in surface.shells)
    text = Sentence(
        f"inside out: every triangle faces inward and the volume is {volume:.4g} {surface.unit}³ "
        f"{surface.around(at.place)}: turn all triangles, or use ",
        ABSOLUTE,
    )
    return Finding("inward", "error", text, *at, turnable=True)


def _inverted(surface: Measured) -> Finding | None:
    inverted = _in_state(surface, "inverted")
    if not inverted or outward(surface.shells) is False:
        return None
    at = surface.at_shells(inverted)
    text = Sentence(
        f"{counted(at.number, 'shell')} inside out beside others that are not, the first "
        f"{surface.around(at.place)} from triangle {at.faces[0]} on: turn its triangles, or use ",
        ABSOLUTE,
    )
    return Finding("inverted_body", "error", text, *at, turnable=True)


def _contained(surface: Measured) -> Finding | None:
    contained = _in_state(surface, "overlapping")
    if not contained:
        return None
    at = surface.at_shells(contained)
    text = Sentence(
        f"overlapping bodies: {counted(at.number, 'shell')} inside another of the same orientation, the "
        f"first {surface.around(at.place)} from triangle {at.faces[0]} on, so that the inside counts twice: "
        "remove it, or use ",
        ABSOLUTE,
        " to make it a cavity",
    )
    return Finding("overlapping_bodies", "error", text, *at, turnable=True)


def _several_bodies(surface: Measured) -> Finding | None:
    found = bodies(surface.shells)
    if len(found) < 2:
        return None
    at = surface.at_shells([surface.shells[body.shells[0]] for body in found])
    return Finding("several_bodies", "note", f"{at.number} separate bodies", *at)


def _cavities(surface: Measured) -> Finding | None:
    cavities = [surface.shells[number] for body in bodies(surface.shells) for number in body.shells[1:]]
    if not cavities:
        return None
    at = surface.at_shells(cavities)
    volume = sum(abs(shell.signed_volume) for shell in cavities)
    text = (
        f"{counted(at.number, 'cavity', 'cavities')} of {volume:.4g} {surface.unit}³ in all, the first "
        f"{surface.around(at.place)}"
    )
    return Finding("cavity", "note", text, *at)
