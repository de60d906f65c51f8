"""Signs of the products: positive integrals ∫xy dm in fields for tensor elements −∫xy dm, all of them or some."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import product

import numpy as np

from inertia.arrays import Float
from inertia.auditing.bodies import Body
from inertia.auditing.claim import Claim, Context, Mistake


def mistakes(context: Context) -> Iterator[Mistake]:
    """Yield the tensor with the signs of all products turned, then with those of one or two."""
    integrals, elements = "positive integrals (∫xy dm)", "tensor elements (−∫xy dm)"
    given, wanted = (elements, integrals) if context.stated.integrals else (integrals, elements)
    for xy, xz, yz in sorted(product((1, -1), repeat=3), key=sum):
        names = [name for name, sign in (("ixy", xy), ("ixz", xz), ("iyz", yz)) if sign < 0]
        if names:
            signs = np.array([[1.0, xy, xz], [xy, 1.0, yz], [xz, yz, 1.0]])
            words = (
                f"the products are {given} where the field wants {wanted}"
                if len(names) == 3
                else f"the sign of {' and '.join(names)} is turned"
            )
            yield Mistake("product_signs", 3, words, f"turn the sign of {', '.join(names)}", partial(_turned, signs))


def _turned(signs: Float, claim: Claim) -> Claim:
    return claim.then(partial(_signed, signs))


def _signed(signs: Float, context: Context, body: Body) -> Body:
    axes = context.stated.rotation
    return body._replace(inertia=axes @ ((axes.T @ body.inertia @ axes) * signs) @ axes.T)
