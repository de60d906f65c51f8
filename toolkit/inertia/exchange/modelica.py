"""Modelica: `MultiBody.Parts.Body`."""

from __future__ import annotations

from collections.abc import Sequence

from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.writing import Body, heading, identifiers, number, numbers

_CONVENTION = CONVENTIONS["modelica"]


def write(bodies: Sequence[Body], comments: Sequence[str]) -> str:
    """Return a model a body, to be used as any other part; several stand in a package."""
    models = identifiers([body.name for body in bodies])
    lines = []
    for body, model in zip(bodies, models, strict=True):
        properties = body.properties
        elements = zip(_CONVENTION.order, _CONVENTION.elements(properties.inertia), strict=True)
        values = [
            f"m = {number(properties.mass)}",
            f"r_CM = {{{numbers(properties.center_of_mass.tolist(), ', ')}}}",
            *(f"I_{pair} = {number(value)}" for pair, value in elements),
        ]
        lines += [f"model {model}", "  extends Modelica.Mechanics.MultiBody.Parts.Body("]
        lines += [f"    {value}{',' if k < len(values) - 1 else ');'}" for k, value in enumerate(values)]
        lines += [f"end {model};"]
    if len(bodies) > 1:
        lines = ["package Assembly", *(f"  {line}" for line in lines), "end Assembly;"]
    return "\n".join([*(f"// {line}" for line in heading(bodies, _CONVENTION, comments)), *lines, ""])
