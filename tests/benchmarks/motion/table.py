"""Measurements → the text of docs/motion-benchmarks.md."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from .contestants import CLOSED, TAYLOR
from .loaded_ensembles import COUNT, KNOWN
from .scenes import MOTIONS

ACCURACIES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13)
ENSEMBLE_ACCURACIES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
DECADES = tuple(10.0**-k for k in range(3, 14))
NOISE = 1.15
"""Times that differ by less are the same."""

TEXT = """# Methods of motion

Attitude error against CPU time: the methods of `inertia` beside SciPy, heyoka and MuJoCo, all measured in one run by

```
{command}
```

(after `pip install -e .[benchmark]`). Every run is in [motion-benchmarks.json](motion-benchmarks.json).

{machine} The times are of this machine, of one core of it; read their ratios.

* **Error** is the angle in rad by which the attitude at the end is off. The truth has 50 digits: free tops by mpmath
  from the textbook's closed form (`tests/dynamics/models/free/free_oracle.py`), loaded ones by Taylor series in
  integers (`tests/dynamics/oracle.py`), each checked against the other. Beyond ten revolutions of loaded ones it has
  some 28: Taylor series in quadruple precision, checked against the integers (`tests/benchmarks/motion/truths.py`).
* **Time** is CPU time for that one attitude, the best of several calls after a first one, which compiles and loads. It
  holds no estimate of the error: no peer makes one (`inertia.simulate` does, at the price of one or two more runs).
* **Settings**: tolerances by half a decade (SciPy's by two), steps by the factor 1.7; the best that reaches an
  accuracy counts. The order that our Taylor method takes for a tolerance was chosen on the two loaded motions below.
* heyoka and SciPy integrate the quaternion and ω, all seven components, from Python; MuJoCo steps a ball joint in C.

![Time against error for the free asymmetric top](motion-benchmarks.svg)

## Against the targets

{targets}

## Which method is the fastest

CPU time of the method that `inertia` selects over that of the fastest method of all, itself included, that reaches the
accuracy: 1 is the fastest. “–”: no method reaches it. *Bettered by* names what is both faster, by more than the 15 %
by which times vary here, and at least as accurate at one accuracy or more, and so takes the selected method off the
Pareto front there.

{fastest}

## Time to reach an accuracy

Milliseconds of CPU time; “–”: never reached; the last column is the least error that was reached.

{motions}
## Many bodies at once

Free bodies (1, 2, 3) kg m², random spins, one core.

{ensembles}

### Loaded bodies

{draws} draws of the heavy asymmetric top with spins that are 1 % apart, followed for ten revolutions, on one core, by

```
{loaded_command}
```

{loaded_machine}

Draws a second by the fastest setting whose error is within the accuracy, and that error: the largest of {known} draws,
against Taylor series in integers. “–”: no setting reaches it. `inertia.ensemble` is the verb as it is called: it runs
each draw three times, and once more from roundings aside, to state an error for every draw; its settings are the
accuracies that it was asked for. The other rows run each draw once and know no error. heyoka's batches are its
`taylor_adaptive_batch`, of the size that it recommends here (4) and of 8 with `force_avx512`; our kernel is that which
is shipped, for AVX2. MuJoCo's bodies go through `mujoco.rollout` in one thread.

{loaded}
"""


def text(document: dict[str, Any]) -> str:
    """Return the document's tables in Markdown."""
    machine = document["machine"]
    versions = ", ".join(f"{name} {version}" for name, version in document["versions"].items())
    motions = document["motions"]
    return TEXT.format(
        command=document["command"],
        machine=f"Machine: {machine['cpu']}, {machine['cores']} cores, {machine['system']}; {versions}.",
        targets=_table(["", "target", "measured", ""], list(_targets(document))),
        fastest=_fastest(motions),
        motions="".join(_motion(name, durations) for name, durations in motions.items()),
        **_loaded(document["loaded ensembles"]),
        ensembles=_table(["", "measured"], [[name, f"{rate:.2g}"] for name, rate in document["ensembles"].items()]),
    )


def _loaded(measured: dict[str, Any]) -> dict[str, Any]:
    machine, versions = measured["machine"], measured["versions"]
    rows = []
    for name, runs in measured["methods"].items():
        cells = []
        for accuracy in ENSEMBLE_ACCURACIES:
            reaching = [run for run in runs if run[2] <= accuracy]
            best = max(reaching, key=lambda run: run[1], default=None)
            cells.append("–" if best is None else f"{best[1]:,.0f} ({best[2]:.0e})")
        rows.append([name, *cells])
    used = ", ".join(f"{name} {versions[name]}" for name in ("heyoka", "mujoco", "numpy", "numba"))
    return {
        "draws": COUNT,
        "known": KNOWN,
        "loaded_command": measured["command"],
        "loaded_machine": f"Machine: {machine['cpu']}, {machine['cores']} cores, {machine['system']}; {used}.",
        "loaded": _table(["draws a second (error, rad)", *(f"{a:.0e}" for a in ENSEMBLE_ACCURACIES)], rows),
    }


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def selected(methods: dict[str, Any]) -> str:
    """Return the method that the package selects for a motion."""
    return CLOSED if CLOSED in methods else TAYLOR


def cheapest(runs: Any, accuracy: float) -> Sequence[float] | None:
    """Return the fastest run [setting, s, rad] that reaches an accuracy."""
    reaching = [run for run in runs if run[2] <= accuracy] if isinstance(runs, list) else []
    return min(reaching, key=lambda run: run[1], default=None)


def bettered_by(methods: dict[str, Any], accuracy: float) -> list[str] | None:
    """Return the methods with a run that betters the selected one's for an accuracy; None where that has none."""
    own = cheapest(methods[selected(methods)], accuracy)
    if own is None:
        return None
    return [
        name
        for name, runs in methods.items()
        if isinstance(runs, list)
        and name != selected(methods)
        and any(NOISE * run[1] < own[1] and run[2] <= own[2] for run in runs)
    ]


def _ratio(methods: dict[str, Any], accuracy: float) -> str:
    times = {name: run[1] for name, runs in methods.items() if (run := cheapest(runs, accuracy))}
    if not times:
        return "–"
    own = times.get(selected(methods))
    return "not reached" if own is None else f"{own / min(times.values()):.3g}"


def _fastest(motions: dict[str, Any]) -> str:
    rows = []
    for name, durations in motions.items():
        for revolutions, methods in durations.items():
            result = [bettered_by(methods, accuracy) for accuracy in DECADES]
            names = dict.fromkeys(other for each in result for other in each or ())
            rows.append(
                [
                    name,
                    f"{int(revolutions):,}",
                    selected(methods).removeprefix("inertia, "),
                    *(_ratio(methods, accuracy) for accuracy in ACCURACIES),
                    ", ".join(other.removeprefix("inertia, ") for other in names) or "nothing",
                ]
            )
    return _table(["", "revolutions", "selected", *(f"{accuracy:.0e}" for accuracy in ACCURACIES), "bettered by"], rows)


def _motion(name: str, durations: dict[str, Any]) -> str:
    (motion,) = [motion for motion in MOTIONS if motion.name == name]
    spin = ", ".join(f"{x:.6g}" for x in motion.spin)
    lines = [f"### {name[:1].upper()}{name[1:]}\n\nMoments {motion.moments} kg m², starting with ({spin}) rad/s.\n"]
    for revolutions, methods in durations.items():
        rows = []
        for method, runs in methods.items():
            if isinstance(runs, str):
                rows.append([method, *[""] * len(ACCURACIES), f"not run: {runs}"])
                continue
            result = [cheapest(runs, accuracy) for accuracy in ACCURACIES]
            cells = ["–" if run is None else f"{1e3 * run[1]:.3g}" for run in result]
            rows.append([method, *cells, f"{min(run[2] for run in runs):.1e}"])
        head = [f"{int(revolutions):,} revolutions", *(f"{accuracy:.0e}" for accuracy in ACCURACIES), "least"]
        lines.append(f"{_table(head, rows)}\n")
    return "\n".join(lines) + "\n"


def _targets(document: dict[str, Any]) -> Iterator[list[str]]:
    motions = document["motions"]
    on_front, all_of_them = 0, 0
    for durations in motions.values():
        for methods in durations.values():
            result = [bettered_by(methods, accuracy) for accuracy in DECADES if _ratio(methods, accuracy) != "–"]
            on_front += sum(each == [] for each in result)
            all_of_them += len(result)
    yield _row(
        "selected method on the Pareto front, 1e-3 … 1e-13 rad, of all motions and durations",
        f"{all_of_them} of {all_of_them}",
        f"{on_front} of {all_of_them}",
        on_front == all_of_them,
    )
    free = motions["free asymmetric top"].get("1000")
    if free:
        ours, (_, seconds, error) = free[CLOSED][0], min(free["SciPy DOP853"])
        yield _above("free top, 1000 revolutions: error of DOP853 at its tightest ÷ ours", error / ours[2], 1e4)
        yield _above("… its CPU time ÷ ours, for the final attitude", seconds / ours[1], 1e4)
    near = motions["1e-12 from the separatrix"].get("1000")
    if near:
        finest = [runs[-1][2] for name, runs in near.items() if name != CLOSED and isinstance(runs, list)]
        ours = near[CLOSED][0][2]
        yield _row(
            "1e-12 from the separatrix, 1000 revolutions: our error, rad", "≤ 1e-11", f"{ours:.1e}", ours <= 1e-11
        )
        yield ["… of the stepping methods at their finest settings", "", f"{min(finest):.1e} … {max(finest):.1e}", ""]
    for name, least in zip(document["ensembles"], (2e5, 5e5, 5e7), strict=True):
        yield _above(name, document["ensembles"][name], least)


def _above(name: str, value: float, least: float) -> list[str]:
    return _row(name, f"≥ {least:.0e}", f"{value:.2g}", value >= least)


def _row(name: str, target: str, measured: str, reached: bool) -> list[str]:
    return [name, target, measured, "reached" if reached else "missed"]
