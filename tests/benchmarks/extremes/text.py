"""Measurements → the text of docs/extremes.md."""

from __future__ import annotations

from statistics import median
from typing import Any

from inertia.mass.triangles.sums import MANY

from .answers import PROGRAMS
from .costs import BARE
from .growth import BODIES
from .prose import LARGE, NOTES, TEXT
from .rungs import RUNGS
from .tables import as_number, as_table

QUANTITIES = {
    "tensor": "Tensor",
    "smallest moment": "Smallest principal moment",
    "volume": "Volume",
    "centre": "Centre of mass",
}
SLENDER = ("Needles", "Plates")
TARGETS = (("float64", BARE, 1.5), ("double-double", "float64", 10.0))
TARGET_EXACT = 1000.0

Row = dict[str, Any]


def text(document: dict[str, Any]) -> str:
    """Return the page in Markdown."""
    counts = document["sweep"]
    families: dict[str, list[Row]] = {}
    for row in document["cases"]:
        families.setdefault(row["family"], []).append(row)
    rows = [row for rung in RUNGS for row in counts[rung].values()]
    return TEXT.format(
        versions=", ".join(f"{name} {number}" for name, number in document["versions"].items()),
        compared=sum(row["compared"] for row in rows),
        exceeded=exceeded(document),
        meshes=counts["meshes"],
        glance=_glance(families),
        families="\n\n".join(_family(name, rows) for name, rows in families.items()),
        axes=_axes(document["nearly_equal"]),
        refusals=_refusals(document["refused"]),
        commands=_commands(document["commands"]),
        large=_large(document.get("large")),
        sweep="\n\n".join(f"{rung}:\n\n{_sweep(counts[rung])}" for rung in RUNGS),
        typical=", ".join(f"{rung} {_typical(counts[rung])}" for rung in RUNGS),
        many=MANY,
        bodies=BODIES,
        growth=_growth(document["growth"]),
        refused=", ".join(f"{rung} {counts['refused'][rung]}" for rung in RUNGS),
        machine=document["costs"]["machine"],
        triangles=document["costs"]["triangles"],
        costs=_costs(document["costs"]["ns"]),
    )


def exceeded(document: dict[str, Any]) -> int:
    """Return how many errors are above their bounds."""
    rows = [*document["cases"], *([document["large"]] if "large" in document else [])]
    answers = [row[rung] for row in rows for rung in RUNGS if isinstance(row[rung], dict)]
    swept = [row for rung in RUNGS for row in document["sweep"][rung].values()]
    swept += [row for size in document["growth"] for row in size["ratios"].values()]
    beyond = sum(result["error"][name] > result["bound"][name] for result in answers for name in result["error"])
    return beyond + sum(row["exceeded"] for row in swept)


def _glance(families: dict[str, list[Row]]) -> str:
    lines = []
    for name, rows in families.items():
        quantity = "smallest moment" if name in SLENDER else "tensor"
        ours = [row.get(row["default"], row["default"]) for row in rows]
        answers = [result for result in ours if isinstance(result, dict)]
        error, bound = (max(result[kind][quantity] for result in answers) for kind in ("error", "bound"))
        lost = [row["lost"][quantity] for row in rows if "lost" in row]
        lines.append(
            [
                f"{name}: {quantity}",
                as_number(max(lost)) if lost else "–",
                f"{as_number(error)} ≤ {as_number(bound)}{_without(ours)}",
                *(_largest([row[program] for row in rows], quantity) for program in PROGRAMS),
            ]
        )
    return as_table(["largest error of", "lost in the file", "inertia", *PROGRAMS], lines)


def _largest(result: list[dict[str, float] | str], quantity: str) -> str:
    """Return the largest error; a program that gives only the volume counts by that."""
    values = [row.get(quantity, row["volume"]) for row in result if isinstance(row, dict)]
    return f"{as_number(max(values)) if values else ''}{_without(result)}".removeprefix(", ")


def _without(result: list[Any]) -> str:
    """Return in how many cases there was no answer."""
    missing = sum(isinstance(row, str) for row in result)
    return f", none in {missing} of {len(result)}" if missing else ""


def _family(name: str, rows: list[Row]) -> str:
    shown = ["tensor", "smallest moment"] if name in SLENDER else ["tensor"]
    hidden = ["volume", "centre"]
    return "\n\n".join(
        [
            f"### {name}",
            NOTES[name],
            *(_errors(rows, quantity) for quantity in shown),
            *_sentences(rows),
            "<details><summary>Volume and centre of mass</summary>",
            *(_errors(rows, quantity) for quantity in hidden),
            "</details>",
        ]
    )


def _errors(rows: list[Row], quantity: str) -> str:
    """Return the table of one quantity, with the programs that compute it."""
    programs = [
        program
        for program in PROGRAMS
        if any(isinstance(row.get(program), dict) and quantity in row[program] for row in rows)
    ]
    lines = [
        [
            row["case"],
            _figure(row.get("lost"), quantity),
            *(_bounded(row[rung], quantity) for rung in RUNGS),
            *([_chosen(row["chosen"])] if "chosen" in row else []),
            *(_figure(row.get(program), quantity) for program in programs),
        ]
        for row in rows
    ]
    asked = ["`1e-12` runs"] if "chosen" in rows[0] else []
    return as_table([QUANTITIES[quantity], "lost in the file", *RUNGS, *asked, *programs], lines)


def _sentences(rows: list[Row]) -> list[str]:
    """Return for each method the first sentence with which it refused."""
    lines = []
    for who, key in (("`--accuracy 1e-12`", "chosen"), *zip(RUNGS, RUNGS, strict=True)):
        said = {row["case"]: row[key] for row in rows if isinstance(row[key], str) and " " in row[key]}
        if said:
            case, sentence = next(iter(said.items()))
            lines.append(f"* {who}, {case}: “{sentence.removeprefix('part: ')}”")
    return ["\n".join(lines)] if lines else []


def _figure(result: dict[str, float] | str | None, quantity: str) -> str:
    if isinstance(result, str):
        return result
    return "–" if result is None or quantity not in result else as_number(result[quantity])


def _bounded(result: dict[str, dict[str, float]] | str, quantity: str) -> str:
    if isinstance(result, str):
        return "refuses"
    return f"{as_number(result['error'][quantity])} ≤ {as_number(result['bound'][quantity])}"


def _chosen(said: str) -> str:
    return "refuses" if " " in said else said


def _axes(rows: list[Row]) -> str:
    programs = [name for name in PROGRAMS if name in rows[0]]
    lines = []
    for row in rows:
        ours = []
        for rung in RUNGS:
            cell = row[rung]
            angle = "plane" if cell["bound"] is None else f"{as_number(cell['angle'])} ≤ {as_number(cell['bound'])}"
            ours.append(f"{cell['class']}, {angle}")
        others = (row[name] if isinstance(row[name], str) else as_number(row[name]) for name in programs)
        lines.append([as_number(row["stored"]), *ours, *others])
    return as_table(["gap", *RUNGS, *programs], lines)


def _refusals(rows: list[Row]) -> str:
    lines = [[row["case"], row["inertia"].removeprefix("part: "), *(row[name] for name in PROGRAMS)] for row in rows]
    return as_table(["", "inertia", *PROGRAMS], lines, words=True)


def _commands(rows: list[Row]) -> str:
    lines = []
    for row in rows:
        if row["code"]:
            answer = f"exit code {row['code']}: “{row['sentence']}”"
        else:
            error = f"{as_number(row['error'])} ≤ " if "error" in row else "≤ "
            answer = (
                f"volume {error}{as_number(row['volume'])}, tensor ≤ {as_number(row['inertia'])}, "
                f"centre of mass ≤ {as_number(row['centre'])} m; {row['method']}"
            )
        lines.append([row["part"], f"`{row['command']}`", answer])
    return as_table(["", "command", "answer"], lines, words=True)


def _large(row: Row | None) -> str:
    if row is None:
        return ""
    return "\n\n".join([LARGE, *(_errors([row], quantity) for quantity in ("tensor", "volume", "centre"))])


def _sweep(counts: dict[str, Row]) -> str:
    lines = []
    for quantity, result in counts.items():
        figures = [as_number(result[key]) if key in result else "–" for key in ("median", "95 %", "largest")]
        numbers = [f"{result[key]:,}" for key in ("compared", "exceeded", "without_error")]
        lines.append([quantity, *numbers, *figures])
    return as_table(["", "compared", "exceeded", "no error", "median", "95 %", "largest"], lines)


def _growth(sizes: list[Row]) -> str:
    lines = []
    for size in sizes:
        bound = "double-double" if size["triangles"] <= MANY else "more digits"
        medians = (as_number(row["median"]) for row in size["ratios"].values())
        lines.append([f"{size['triangles']:,}", bound, *medians])
    return as_table(["triangles", "bound", *sizes[0]["ratios"]], lines)


def _typical(counts: dict[str, Row]) -> str:
    medians = [counts[name]["median"] for name in ("volume", "mass", "centre of mass", "tensor")]
    return f"{as_number(min(medians))} to {as_number(max(medians))}"


def _costs(kinds: dict[str, dict[str, list[float]]]) -> str:
    medians = {kind: {name: median(runs) for name, runs in result.items()} for kind, result in kinds.items()}
    targets = {rung: (base, limit) for rung, base, limit in TARGETS}
    lines = []
    for name in next(iter(medians.values())):
        cells = [name, *(f"{result[name]:.3g}" for result in medians.values())]
        if name in targets:
            base, limit = targets[name]
            ratio = max(result[name] / result[base] for result in medians.values())
            cells += [f"{ratio:.2g}× {base}", f"≤ {limit:g}×", "reached" if ratio <= limit else "missed"]
        elif name == "exact":
            most = max(result[name] for result in medians.values())
            cells += [f"{most:.3g} ns", f"≤ {TARGET_EXACT:g} ns", "reached" if most <= TARGET_EXACT else "missed"]
        else:
            cells += ["", "", ""]
        lines.append(cells)
    return as_table(["ns a triangle", *(f"{kind} coordinates" for kind in medians), "", "target", ""], lines)
