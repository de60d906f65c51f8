"""Simscape Multibody: variables for the fields of a block Inertia, as a MATLAB script."""

from __future__ import annotations

from collections.abc import Sequence

from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.writing import Body, heading, identifiers, number, numbers

_CONVENTION = CONVENTIONS["simscape"]


def write(bodies: Sequence[Body], comments: Sequence[str]) -> str:
    """Return a struct a body, whose fields are named as those of the block."""
    lines = [f"% {line}" for line in heading(bodies, _CONVENTION, comments)]
    for body, variable in zip(bodies, identifiers([body.name for body in bodies]), strict=True):
        elements = _CONVENTION.elements(body.properties.inertia)
        lines += [
            f"{variable}.Mass = {number(body.properties.mass)};  % kg",
            f"{variable}.CenterOfMass = [{numbers(body.properties.center_of_mass.tolist())}];  % m",
            f"{variable}.MomentsOfInertia = [{numbers(elements[:3])}];  % kg*m^2: Ixx Iyy Izz",
            f"{variable}.ProductsOfInertia = [{numbers(elements[3:])}];  % kg*m^2: Iyz Izx Ixy",
        ]
    return "\n".join([*lines, ""])
