"""Products of inertia that were not written down: the diagonal is right, and zeros stand beside it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from inertia.auditing.bodies import Body
from inertia.auditing.claim import Context, Mistake

_ROUNDOFF = 1e-12  # of the largest element: what turning a tensor back and forth takes


def mistakes(context: Context) -> Iterator[Mistake]:
    """Yield the diagonal alone, where the file states products of zero."""
    written = context.stated.written
    if np.abs(written - np.diag(np.diag(written))).max() > _ROUNDOFF * np.abs(written).max():
        return
    words = "the products are left out: the moments about the axes stand alone"
    yield Mistake("products_left_out", 3, words, "state ixy, ixz and iyz", lambda claim: claim.then(_diagonal))


def _diagonal(context: Context, body: Body) -> Body:
    axes = context.stated.rotation
    return body._replace(inertia=axes @ np.diag(np.diag(axes.T @ body.inertia @ axes)) @ axes.T)
