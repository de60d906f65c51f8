"""`Assembly` and `Budget` → the text that the commands print."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from decimal import Decimal

from inertia.arrays import Float
from inertia.assembly.budget import Budget
from inertia.assembly.document import Assembly
from inertia.assembly.interference import Interference
from inertia.assembly.limits import COVERAGE, Limit, Verdict
from inertia.assembly.lines import Line
from inertia.report.budget.document import COLUMNS, contributors
from inertia.report.numerals import cleared, columns, fixed, number, row, table, wrapped
from inertia.units import Unit

_LISTED = 60  # lines of the tree
_CONTRIBUTORS = 8
_NAMED = 10  # parts
_DIGITS = 12  # more than usual that a limit and what it is on are told apart by, none included
_LIKELY = " (95 %)"
_NOTHING = 1e-9  # of the unit of length: what is less is rounding


def assembly_text(assembly: Assembly, pairs: Sequence[Interference] | None = None) -> str:
    """Return the whole's mass properties, the tree of its parts, and the interferences that were looked for."""
    properties, whole = assembly.mass_properties(), assembly.budget()
    lines = [
        row("Assembly", f"{assembly.name} ({assembly.path})"),
        row("Parts", f"{len(assembly.placed.moments)}, from {sum(1 for _ in assembly.root.leaves)} entries"),
        "",
        *_properties(whole),
        row("Principal moments", columns(properties.principal_moments) + "  kg m²"),
        row("Bounds", f"mass {properties.error.mass:.2g}, tensor {_relative(properties.error.inertia)}, centre of "
            f"mass {properties.error.center_of_mass:.2g} m; {properties.error.method}"),
        "",
        *_tree(whole.total, assembly.unit),
        *_interferences(pairs, assembly),
        *_notes(assembly.notes),
    ]  # fmt: skip
    return "\n".join(lines)


def budget_text(whole: Budget) -> str:
    """Return the budget as text: the verdict first, then the total, the limits, the parts and what is uncertain."""
    unit, total = whole.assembly.unit, whole.total
    verdict = "no limits are stated" if whole.verdict is None else whole.verdict.upper()
    share = 100 * total.allowance / total.basic_mass
    off = _tensor_bound(whole)
    lines = [
        row("Budget", f"{whole.assembly.name}: {verdict}"),
        row("Basic mass", f"{figure(total.basic_mass, total.sigma.mass)} kg"),
        row("Allowance", f"{number(total.allowance)} kg ({share:.3g} %)"),
        row("Predicted mass", f"{figure(total.predicted_mass, total.sigma.predicted_mass)} kg"),
        "",
        *_properties(whole),
        *(f"{'':18}± {_uncertain(u, off)}" for u in total.sigma.inertia if total.sigma.changes.size),
        "",
        *(row("Limit", limit_words(limit, unit)) for limit in whole.limits),
        *([""] if whole.limits else []),
        *_tree(total, unit),
        *_contributors(whole),
        *_notes(whole.notes),
    ]
    return "\n".join(lines)


def _relative(bound: float) -> str:
    return f"{bound:.2g} (relative)" if math.isfinite(bound) else "zero"


def _properties(whole: Budget) -> Iterator[str]:
    properties, unit = whole.properties, whole.assembly.unit
    center = properties.center_of_mass / float(unit.metres)
    bound = properties.error.center_of_mass / float(unit.metres)
    spread = whole.total.sigma.center_of_mass / float(unit.metres)
    yield row("Mass", f"{number(properties.mass)} kg")
    shown = [
        figure(cleared(k, bound), cleared(u, bound)) for k, u in zip(center.tolist(), spread.tolist(), strict=True)
    ]
    yield row("Centre of mass", f"{', '.join(shown)} {unit.name}")
    limit = _tensor_bound(whole)
    for k, label in enumerate(("Tensor about it", "", "")):
        values = [cleared(value, limit) for value in properties.inertia[k].tolist()]
        yield row(label, columns(values) + ("  kg m²" if k == 0 else ""))


def _tensor_bound(whole: Budget) -> float:
    size = float((whole.properties.inertia**2).sum() ** 0.5)
    return whole.properties.error.inertia * size if size else 0.0


def _tree(total: Line, unit: Unit) -> Iterator[str]:
    lines = list(total.lines())
    rows: list[tuple[str, ...]] = [
        ("part", "qty", "basic kg", "allow. kg", "predicted kg", "u kg", f"x {unit.name}", "y", "z")
    ]
    for line in lines[:_LISTED]:
        center = line.center_of_mass / float(unit.metres)
        rows.append(
            (
                "  " * line.level + line.name,
                str(line.quantity) if line.level else "",
                f"{line.basic_mass:.5g}",
                f"{line.allowance:.3g}",
                f"{line.predicted_mass:.5g}",
                f"{line.sigma.mass:.2g}",
                *(f"{k + 0.0:.5g}" if abs(k) > _NOTHING else "0" for k in center.tolist()),
            )
        )
    yield from table(rows)
    if len(lines) > _LISTED:
        yield f"… and {len(lines) - _LISTED} more: CSV, JSON and the report have them all"


def _interferences(pairs: Sequence[Interference] | None, assembly: Assembly) -> Iterator[str]:
    if pairs is None:
        return
    unit, unexamined = assembly.unit, assembly.unexamined()
    metres = float(unit.metres)
    yield ""
    if not pairs:
        yield row("Interference", "none of the parts that were looked at" if unexamined else "none")
    for each in pairs[:_LISTED]:
        place = ", ".join(f"{k / metres:.5g}" if abs(k) > _NOTHING * metres else "0" for k in each.place.tolist())
        what = f"{each.gap / metres:.4g} {unit.name} apart"
        if each.volume:
            what = f"share {each.volume / metres**3:.4g} {unit.name}³"
            what += f", {each.mass:.3g} kg of which counts twice" if each.mass else ""
        yield row("Interference", f"{each.first} and {each.second}: {what}, near ({place})")
    if len(pairs) > _LISTED:
        yield f"… and {len(pairs) - _LISTED} more: JSON has them all"
    for why in dict.fromkeys(unexamined.values()):
        names = [name for name, reason in unexamined.items() if reason == why]
        more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
        yield from wrapped("Not looked at", f"{', '.join(names[:_NAMED])}{more}: {why}")


def limit_words(limit: Limit, unit: Unit) -> str:
    """Return a limit, what it is on with its interval, and what became of it."""
    scale, name = limit_unit(limit, unit)
    name = f" {name}" if name else ""
    low, value, high = limit_figures(limit, scale)
    ends = ([f"≥ {low}"] if low else []) + ([f"≤ {high}"] if high else [])
    margin = f", margin {scale * limit.margin:.4g}" if math.isfinite(limit.margin) else ""
    return f"{limit.what} {' and '.join(ends)}{name}: {value}{name}{margin}: {limit.verdict.upper()}"


def limit_unit(limit: Limit, unit: Unit) -> tuple[float, str]:
    """Return what the figures of a limit, SI, are multiplied by to be shown, and the unit that they then have.

    Parameters
    ----------
    unit : of lengths; a ratio has none
    """
    length = limit.what.startswith("center_of_mass")
    name = unit.name if length else "kg" if limit.what.endswith("mass") else "kg m²"
    return 1.0 / float(unit.metres) if length else 1.0, "" if "/" in limit.what else name


def limit_figures(limit: Limit, scale: float) -> tuple[str, str, str]:
    """Return least value, value with its interval and largest value, with the digits that the verdict shows by.

    An end that is not limited is empty. What no digits show, as it is rounding that decides, has those of the others.
    """
    shown = [_limit_figures(limit, scale, more) for more in range(_DIGITS)]
    return next((figures for figures in shown if _verdict(*figures) == limit.verdict), shown[0])


def _limit_figures(limit: Limit, scale: float, more: int) -> tuple[str, str, str]:
    low, high = ("" if end is None else f"{scale * end:.{6 + more}g}" for end in (limit.low, limit.high))
    return low, figure(scale * limit.value, scale * limit.uncertainty, more), high


def _verdict(low: str, value: str, high: str) -> Verdict:
    """Return what a reader makes of figures."""
    middle, _, reach = value.removesuffix(_LIKELY).partition(" ± ")
    size, room = Decimal(middle), Decimal(reach or 0)
    margin = min(Decimal(high or "inf") - size, size - Decimal(low or "-inf"))
    return "pass" if margin >= room else "fail" if margin < -room else "undecided"


def _contributors(whole: Budget) -> Iterator[str]:
    sigma = whole.total.sigma
    first = contributors(sigma, _CONTRIBUTORS)
    if not first:
        return
    yield ""
    yield "What the variances are made of, in %:"
    shown = ("mass", *COLUMNS[1:4], "inertia.xx", "inertia.yy", "inertia.zz")
    bounds = [0.0, *3 * [whole.properties.error.center_of_mass], *3 * [_tensor_bound(whole)]]
    spread = [sigma.mass, *sigma.center_of_mass.tolist(), *sigma.inertia.diagonal().tolist()]
    real = [u > bound for u, bound in zip(spread, bounds, strict=True)]  # what is less is rounding
    heads = [name.removeprefix("center_of_mass.").replace("inertia.", "I").rjust(5) for name in shown]
    rows = [
        (
            each["input"],
            *(f"{100 * each['share'][name] * is_real:.1f}" for name, is_real in zip(shown, real, strict=True)),
        )
        for each in first
    ]
    yield from table([("", *heads), *rows])


def _notes(notes: tuple[str, ...]) -> Iterator[str]:
    if notes:
        yield ""
    for note in notes:
        yield from wrapped("Note", note)


def figure(value: float, uncertainty: float, more: int = 0) -> str:
    """Return a figure with its 95 % interval, to the digits that it has, or so many more."""
    if not uncertainty:
        return number(value, more)
    reach = COVERAGE * uncertainty
    places = max(0, 1 - math.floor(math.log10(reach)))
    if places > 12:
        return f"{number(value, more)} ± {reach:.{2 + more}g}"
    return f"{fixed(value, places + more)} ± {fixed(reach, places + more)}{_LIKELY}"


def _uncertain(values: Float, bound: float) -> str:
    words = (f"{COVERAGE * value:.2e}" if value > bound else "0" for value in values.tolist())
    return "".join(f"{word:>{18 if k else 16}}" for k, word in enumerate(words)) + "  (95 %)"
