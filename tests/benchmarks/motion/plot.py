"""Measurements → docs/motion-benchmarks.svg: time against error for the free asymmetric top."""

from __future__ import annotations

from pathlib import Path
from typing import Any

MOTION = "free asymmetric top"
STYLES = {
    "inertia, closed form": ("#D55E00", "*"),
    "inertia, Taylor": ("#0072B2", "o"),
    "inertia, splitting 8": ("#009E73", "s"),
    "inertia, RK4": ("#56B4E9", "^"),
    "heyoka": ("#CC79A7", "D"),
    "MuJoCo, RK4": ("#E69F00", "v"),
    "SciPy DOP853": ("#000000", "<"),
    "SciPy LSODA": ("#777777", ">"),
    "SciPy RK45": ("#bbbbbb", "P"),
}
LEAST = 1e-17


def draw(document: dict[str, Any], file: Path) -> None:
    """Draw one panel for each duration."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    durations = document["motions"][MOTION]
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "inertia", "font.size": 9.0}):
        figure = Figure(figsize=(10.5, 4.8), layout="constrained")
        panels = figure.subplots(1, len(durations), sharey=True, squeeze=False)[0]
        for axes, (revolutions, methods) in zip(panels, durations.items(), strict=True):
            for name, (color, marker) in STYLES.items():
                runs = [run for run in methods[name] if run[2] < 1] if isinstance(methods.get(name), list) else []
                size = 13 if marker == "*" else 4
                axes.plot(
                    [max(run[2], LEAST) for run in runs],
                    [1e3 * run[1] for run in runs],
                    color=color,
                    marker=marker,
                    markersize=size,
                    linewidth=0.9,
                    label=name if axes is panels[0] else None,
                )
            axes.set_xscale("log")
            axes.set_yscale("log")
            axes.set_xlim(1.5, 1e-17)
            axes.grid(alpha=0.3)
            axes.set_title(f"{int(revolutions):,} revolutions", fontsize=10)
        panels[0].set_ylabel("CPU time for the final attitude, ms")
        panels[len(panels) // 2].set_xlabel("attitude error, rad (more accurate to the right)")
        figure.legend(loc="outside lower center", ncols=5, fontsize=8)
        figure.savefig(file, format="svg", metadata={"Date": None})
