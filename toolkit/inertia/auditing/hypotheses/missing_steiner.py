"""Tensors of several meshes added without the terms of Steiner's theorem."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from inertia.auditing.claim import Context, Mistake


def mistakes(context: Context) -> Iterator[Mistake]:
    """Yield the sum of the meshes' own tensors, where there are several."""
    if len(context.shapes) > 1:
        words = f"the tensors of its {len(context.shapes)} meshes are added without their Steiner terms"
        remedy = "shift each to the common centre of mass before adding"
        yield Mistake("missing_steiner", 2, words, remedy, lambda claim: replace(claim, steiner=False))
