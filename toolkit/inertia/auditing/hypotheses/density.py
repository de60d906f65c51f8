"""Another density than the one that is known of the meshes: of another material, or a program's default."""

from __future__ import annotations

from collections.abc import Iterator

from inertia.auditing.bodies import Body
from inertia.auditing.claim import Context, Mistake
from inertia.mass.density import DENSITIES

_ALIKE = 0.01  # of a density, within which a material is named
_DEFAULTS = {1000.0: "the default of many programs", 1.0: "the default of some programs"}


def mistakes(context: Context) -> Iterator[Mistake]:
    """Yield the meshes with all densities multiplied so that they have the stated mass."""
    if context.densities is None:
        return
    factor = context.stated.body.mass / context.truth.body.mass
    words = f"all of it is {factor:.4g} times as dense as it should be"
    if len(set(context.densities)) == 1:
        density = factor * context.densities[0]
        known = [*_DEFAULTS.items(), *((value, name) for name, value in DENSITIES.items())]
        names = ", or ".join(name for value, name in known if abs(density - value) <= _ALIKE * value)
        words += f": {density:.4g} kg/m³{f' ({names})' if names else ''}"

    def scaled(_context: Context, body: Body) -> Body:
        return body.weighed(factor)

    yield Mistake("other_density", 5, words, "weigh it with its own density", lambda claim: claim.then(scaled))
