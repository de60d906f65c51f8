"""The text beside the views: what moves, by which model and why, how well it is known, and how it is shown."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.run import Run
from inertia.errors import visible

_MARKS = r"[\\`\[\]<>|*~&#$]|(?<![^\W_])_|_(?![^\W_])"  # of Markdown; _ between letters is none
_ZERO = 1e-12  # of the largest component: what is less is rounding


def summary(run: Run, notes: Iterable[str]) -> str:
    """Return Markdown, in paragraphs that fit a view of any width; `notes` say what is drawn, and how."""
    return "\n\n".join([_body(run), *_notes(run, notes), _model(run), _accuracy(run)])


def symbol(name: str) -> str:
    """Return what a screen calls something that is kept."""
    known = {"p_phi": "vertical L", "p_psi": "L along the axis"}
    return known.get(name, name.replace("angular momentum", "L").removesuffix(" in space"))


def title(run: Run) -> str:
    """Return what a viewer calls the recording: the scene's name, without its folder."""
    return visible(Path(run.scene.name).name)


def markdown(name: str) -> str:
    r"""Return a text from outside, as a name, for Markdown to show as it is: nothing in it is a mark.

    >>> print(markdown("![x](https://example.org/x.png)|<b> *a* _b_ a_b &lt;"))
    !\[x\](https://example.org/x.png)\|\<b\> \*a\* \_b\_ a_b \&lt;
    """
    return re.sub(_MARKS, r"\\\g<0>", visible(name))


def listed(values: Float) -> str:
    """Return a vector with six digits, times a power of ten where that is short, what rounding left of a zero as 0.

    >>> listed(np.array([2.5e-7, 1.25e-6, 1e-30])), listed(np.array([0.0, 1.5]))
    ('(0.25, 1.25, 0)·10⁻⁶', '0, 1.5')
    """
    size = float(np.abs(values).max(initial=0.0))
    power = math.floor(math.log10(size)) if 0 < size < math.inf else 0
    power = 0 if -4 <= power < 6 else power
    cleared = np.where(np.abs(values) <= _ZERO * size, 0.0, values / 10.0**power)
    numbers = ", ".join(f"{value:.6g}" for value in cleared.tolist())
    return f"({numbers})·{ten_to(power)}" if power else numbers


def ten_to(power: int) -> str:
    """Return a power of ten as it is printed.

    >>> ten_to(-15)
    '10⁻¹⁵'
    """
    return "10" + str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def figure(value: float) -> str:
    """Return a number with two digits, as it is printed.

    >>> figure(7.3e-08), figure(0.05), figure(1e-9)
    ('7.3·10⁻⁸', '0.05', '10⁻⁹')
    """
    if not math.isfinite(value) or value == 0 or 1e-3 <= abs(value) < 1e4:
        return f"{value:.2g}"
    digits, power = f"{value:.1e}".split("e")
    return f"{'' if digits == '1.0' else f'{float(digits):g}·'}{ten_to(int(power))}"


def _body(run: Run) -> str:
    scene, body = run.scene, run.scene.body
    facts = [f"**{markdown(title(run))}**: {scene.run.duration:g} s, {len(run.time)} samples"]
    if body.part is not None:
        facts.append(f"{markdown(Path(body.part.name).name)}, in {body.part.unit.name}")
    if body.mass is not None:
        facts.append(f"{body.mass:.6g} kg, centre of mass {listed(body.center_of_mass)} m")
    facts.append(f"{body.principal.kind}, moments {listed(body.moments)} kg m²")
    facts.append(f"spin {listed(scene.start.angular_velocity)} rad/s along {scene.start.frame} axes")
    return "; ".join(facts) + "."


def _model(run: Run) -> str:
    return f"**Model: {run.model}.** {markdown(' '.join([*run.why, *map(sentence, run.remarks)]))}"


def _accuracy(run: Run) -> str:
    error = run.error
    drifts = ", ".join(f"{symbol(name)} {_kept(each.largest_relative_drift)}" for name, each in run.invariants.items())
    return (
        f"**Accuracy: {figure(error.reached)} rad** of attitude, {figure(error.requested)} rad asked for. "
        f"{markdown(sentence(error.method))}{f' Kept: {drifts}.' if drifts else ''}"
    )


def _kept(drift: float) -> str:
    return f"to {figure(drift)} of its size" if drift else "exactly"


def _notes(run: Run, notes: Iterable[str]) -> Iterator[str]:
    yield f"**On the screen.** {markdown(' '.join(map(sentence, notes)))}"
    for warning in run.warnings:
        yield f"**Note.** {markdown(sentence(warning))}"


def sentence(text: str) -> str:
    """Return a text with a capital and a full stop; symbols keep their letter.

    >>> sentence("it turns"), sentence("ω: short")
    ('It turns.', 'ω: short.')
    """
    first = text[:1].upper() if text[:1].isascii() else text[:1]
    return f"{first}{text[1:]}{'' if text.endswith('.') else '.'}"
