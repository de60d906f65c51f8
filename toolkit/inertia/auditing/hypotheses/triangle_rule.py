"""A tensor that broke the triangle rule and was made to obey it: all moments set to their mean."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from inertia.auditing.bodies import Body
from inertia.auditing.claim import Context, Mistake


def mistakes(_context: Context) -> Iterator[Mistake]:
    """Yield the mean of the principal moments in place of each, as MuJoCo's `balanceinertia` sets them."""
    words = "all three moments are set to their mean, as a validator does to a tensor that breaks the triangle rule"
    yield Mistake("unphysical", 6, words, "state the tensor that the meshes have", lambda claim: claim.then(_balanced))


def _balanced(_context: Context, body: Body) -> Body:
    return body._replace(inertia=np.eye(3) * (np.trace(body.inertia) / 3))
