"""The text beside the views: what moves, by which model and why, how well it is known, and how it is shown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from itertools import zip_longest
from pathlib import Path

from inertia.arrays import Float
from inertia.dynamics.run import Run
from inertia.errors import visible


def summary(run: Run, notes: Iterable[str], *, columns: int = 2) -> str:
    """Return Markdown; `notes` say what was chosen for display only, `columns` how many the table has."""
    return "\n".join([*_body(run, columns), "", *_model(run), "", *_accuracy(run), "", *_notes(run, notes)])


def symbol(name: str) -> str:
    """Return what a screen calls something that is kept."""
    return {"angular momentum": "L", "p_phi": "vertical L", "p_psi": "L along the axis"}.get(name, name)


def title(run: Run) -> str:
    """Return what a viewer calls the recording: the scene's name, without its folder."""
    return visible(Path(run.scene.name).name)


def markdown(name: str) -> str:
    r"""Return a name as Markdown shows it: no link, picture, tag or cell of a table begins in it.

    >>> print(markdown("![x](https://example.org/x.png)|<b>"))
    !\[x\](https://example.org/x.png)\|\<b\>
    """
    return re.sub(r"[\\`\[\]<>|]", r"\\\g<0>", visible(name))


def listed(values: Float) -> str:
    """Return a vector with six digits, what rounding left of a zero as 0."""
    least = 1e-12 * max(map(abs, values.tolist()), default=0.0)
    return ", ".join(f"{0.0 if abs(value) <= least else value:.6g}" for value in values.tolist())


def _body(run: Run, columns: int) -> Iterator[str]:
    scene, body = run.scene, run.scene.body
    cells = [("Scene", markdown(title(run))), ("Duration", f"{scene.run.duration:g} s, {len(run.time)} samples")]
    if body.part is not None:
        cells.append(("Part", f"{markdown(Path(body.part.name).name)}, in {body.part.unit.name}"))
    cells.append(("Class", body.principal.kind))
    if body.mass is not None:
        cells.append(("Mass", f"{body.mass:.6g} kg"))
        cells.append(("Centre of mass", f"{listed(body.center_of_mass)} m"))
    cells.append(("Moments", f"{listed(body.principal.moments)} kg m²"))
    cells.append(("Spin", f"{listed(scene.start.angular_velocity)} rad/s, {scene.start.frame} axes"))
    yield "| | " * columns + "|"
    yield "|-|-" * columns + "|"
    for row in zip_longest(*(cells[k::columns] for k in range(columns)), fillvalue=("", "")):
        yield f"| {' | '.join(text for cell in row for text in cell)} |"


def _model(run: Run) -> Iterator[str]:
    yield f"**Model: {run.model}.** {' '.join([*run.why, *map(sentence, run.remarks)])}"


def _accuracy(run: Run) -> Iterator[str]:
    error = run.error
    drifts = ", ".join(f"{symbol(name)} {_kept(each.largest_relative_drift)}" for name, each in run.invariants.items())
    yield (
        f"**Accuracy: {error.reached:.1e} rad** of attitude, {error.requested:g} rad asked for. "
        f"{sentence(error.method)}{f' Kept: {drifts}.' if drifts else ''}"
    )


def _kept(drift: float) -> str:
    return f"to {drift:.1e} of its size" if drift else "exactly"


def _notes(run: Run, notes: Iterable[str]) -> Iterator[str]:
    yield f"**On the screen.** {' '.join(map(sentence, notes))}"
    for warning in run.warnings:
        yield ""
        yield f"**Note.** {sentence(warning)}"


def sentence(text: str) -> str:
    """Return a text with a capital and a full stop."""
    return f"{text[:1].upper()}{text[1:]}{'' if text.endswith('.') else '.'}"
