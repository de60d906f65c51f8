"""Tensors that nobody computed: multiples of the identity, one figure for all moments, those of another link."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from inertia.auditing.bodies import norm
from inertia.auditing.claim import Context

_FEW = 2  # significant digits of a figure that somebody typed
_ROUNDOFF = 1e-12  # relative: what turning a tensor back and forth takes
_ALIKE = 0.05  # tensors a kilogram of two links that differ by less are of equal links


def placeholder(context: Context, others: Iterable[tuple[str, Context | None]]) -> str | None:
    """Return in what way a stated tensor that differs from that of the shapes looks like a placeholder, or None.

    Parameters
    ----------
    others : the other links of the file with this centre and tensor: name, and what they are stated about, if known
    """
    tensor = context.stated.written
    moment = float(np.trace(tensor)) / 3
    equal = np.abs(tensor - moment * np.eye(3)).max() <= _ROUNDOFF * abs(moment)
    if equal and _typed(moment):
        return f"all moments are {moment:g} kg m² and the products 0, as where nobody computed them"
    for name, about in others:
        if about is not None:
            own, its = context.truth.body.inertia / context.stated.body.mass, about.truth.body.inertia
            its = its / about.stated.body.mass
            if norm(own - its) > _ALIKE * norm(own):
                return f"centre of mass and tensor are those of {name}, whose meshes are others"
    return None


def _typed(value: float) -> bool:
    digits = f"{value:.12e}".partition("e")[0].rstrip("0").replace(".", "")
    return len(digits) <= _FEW
