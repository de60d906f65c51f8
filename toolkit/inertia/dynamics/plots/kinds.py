"""The kinds of plots: angular velocity, polhode, momentum sphere, effective potential, nutation, phase portrait."""

from __future__ import annotations

from collections.abc import Callable
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.polhode import covered, polhode_family, separatrix
from inertia.dynamics.plots.projection import FAINT, INK, Projection
from inertia.dynamics.plots.subject import COARSE, Subject, is_coarse, numbered
from inertia.dynamics.plots.swing import Swing, Window, heavy_top_of, swing_of
from inertia.errors import UsageError
from inertia.palette import BLUE, GREEN, ORANGE, PLUM, VERMILLION
from inertia.plotting import bare, own_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LINES = (BLUE, VERMILLION, GREEN)
_EYE = (0.58, 0.46, 0.67)  # from where all three axes can be told apart
_SAMPLES = 361
_MOST = 4000  # points of a line
_VERTICAL = 1e-4  # rad from the vertical, nearer to which V is all rounding
_LONGEST = 30.0  # times as long as wide: longer ellipsoids are lines
_EQUAL = 1e-9  # relative difference up to which moments, or rates, are the same
_SUBSCRIPTS = "₁₂₃"


class Kind(NamedTuple):
    """A kind of plot: whether it suits a run, and what draws it."""

    suits: Callable[[Subject], bool]
    draw: Callable[[Axes, Subject], None]


def kinds_of(run: Subject) -> list[str]:
    """Return the kinds that suit a run, the most telling first."""
    return [name for name, kind in KINDS.items() if kind.suits(run)]


def require_kind(kind: str | None) -> None:
    """Raise `UsageError` where there is no such kind."""
    if kind is not None and kind not in KINDS:
        close = get_close_matches(kind, KINDS, n=1, cutoff=0.4)
        hint = f"did you mean {close[0]!r}?" if close else f"use one of {', '.join(map(repr, KINDS))}"
        raise UsageError(f"{kind!r} is no kind of plot: {hint}")


def draw(run: Subject, kind: str | None, axes: Axes | None, title: str) -> Figure:
    """Draw one kind on the axes that are given, or on a figure of its own; without a kind, all that suit.

    Raises `UsageError` where there is no such kind, or it does not suit the run.
    """
    suitable = kinds_of(run)
    require_kind(kind)
    if kind is not None and kind not in suitable:
        raise UsageError(f"a plot of the kind {kind!r} does not suit this run: use {' or '.join(map(repr, suitable))}")
    if axes is not None:
        KINDS[kind or suitable[0]].draw(axes, run)
        whole = axes.get_figure(root=True)
        assert whole is not None  # axes that are to be drawn on are on a figure
        return whole
    shown = suitable if kind is None else [kind]
    figure = own_figure(figsize=(5.6 * len(shown), 5.0), dpi=150, layout="constrained", facecolor="white")
    for axes, name in zip(np.atleast_1d(figure.subplots(1, len(shown))), shown, strict=True):
        KINDS[name].draw(axes, run)
    figure.suptitle(title, fontsize=12, x=0.01, ha="left", parse_math=False)
    return figure


def _style(coarse: bool, count: int, width: float) -> dict[str, Any]:
    """Return how samples are drawn: as a line, thinner where it winds a lot, or as dots where they are far apart."""
    if coarse:
        return {"linestyle": "none", "marker": ".", "markersize": 4 if count < 1000 else 1.5}
    return {"linewidth": width if count < 3 * _MOST else 0.5 * width}


def _line(axes: Axes, x: Float, y: Float, coarse: bool, **how: Any) -> None:
    """Draw samples as a line, or as dots where they are too far apart; of very many, what a line would show of them."""
    if len(x) > _MOST and coarse:
        x, y = x[:: len(x) // _MOST], y[:: len(x) // _MOST]
    elif len(x) > _MOST:
        width = -(-len(x) // (_MOST // 2))
        whole = len(x) // width * width
        blocks = y[:whole].reshape(-1, width)
        rows = np.sort(np.stack([blocks.argmin(axis=1), blocks.argmax(axis=1)], axis=1), axis=1)
        rows = (rows + np.arange(0, whole, width)[:, None]).ravel()
        x, y = np.append(x[rows], x[-1]), np.append(y[rows], y[-1])
    axes.plot(x, y, **_style(coarse, 0, 1.6), **how)


def _when(run: Subject, sample: int) -> str:
    time, end = float(run.time[sample]), run.plan.problem.duration
    return "at the start" if time == 0 else "at the end" if time == end else f"at {time:.4g} s"


def _plain(axes: Axes, x: str, y: str, title: str) -> None:
    axes.set_facecolor("white")
    axes.set_xlabel(x, fontsize=11)
    axes.set_ylabel(y, fontsize=11)
    axes.set_title(title, fontsize=12)
    axes.grid(color="#dddddd", linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def _angular_velocity(axes: Axes, run: Subject) -> None:
    deforms = run.plan.problem.scene.body.deforms
    along = np.eye(3) if deforms else numbered(run.plan)[1]
    omega, coarse = run.angular_velocity @ along, is_coarse(run.time, run.angular_velocity)
    for k in range(3):
        _line(axes, run.time, omega[:, k], coarse, color=_LINES[k], label=f"ω{_SUBSCRIPTS[k]}")
    which = "part" if deforms else "principal"
    _plain(axes, "time, s", f"along the {which} axes, rad/s", "Angular velocity")
    _legend_below(axes)


def _eye(vector: Float) -> Float:
    toward = np.where(vector < 0, -1.0, 1.0) * _EYE
    return np.asarray(toward / np.linalg.norm(toward))


def _polhode(axes: Axes, run: Subject) -> None:
    moments, along = numbered(run.plan)
    omega = run.angular_velocity[0] @ along
    double = float((moments * omega**2).sum())
    seen = Projection(np.sqrt(double / moments), _eye(omega), np.array([0.0, 0.0, 1.0]))
    seen.draw_surface(axes)
    momentum = float(np.linalg.norm(moments * omega))
    if _distinct(moments) == 3:
        for k, curve in enumerate(separatrix(moments, float(np.sqrt(double * np.median(moments))), _SAMPLES)):
            label = None if k else "separatrix"
            seen.draw(axes, curve, label, color=PLUM, linewidth=1.2)
    if np.ptp(moments):
        seen.draw(axes, covered(moments, omega, _SAMPLES), "polhode", color=VERMILLION, linewidth=2.6)
    axes.plot(*seen.at(omega), "o", color=INK, markersize=7, zorder=9, label=f"ω {_when(run, 0)}")
    ends = [f"{'−' if seen.toward[k] < 0 else ''}{size:.3g}" for k, size in enumerate(seen.semi_axes)]
    seen.draw_axes(axes, [f"ω{_SUBSCRIPTS[k]} = {end} rad/s" for k, end in enumerate(ends)])
    bare(axes)
    axes.set_title(f"Polhode on the inertia ellipsoid\n2T = {double:.4g} J, L = {momentum:.4g} kg m²/s", fontsize=12)
    _legend_below(axes)


def _momentum_sphere(axes: Axes, run: Subject) -> None:
    moments, along = numbered(run.plan)
    momentum = quaternion.to_body(run.attitude, run.angular_momentum) @ along
    size = np.linalg.norm(momentum, axis=1)
    turning = size > 1e-9 * size.max()  # at rest L has no direction
    path = momentum[turning] / size[turning, None]
    free = not run.plan.problem.torques
    seen = Projection(np.ones(3), _eye(path[0] if free else momentum[np.argmax(size)]), np.array([0.0, 0.0, 1.0]))
    seen.draw_surface(axes)
    curved = _distinct(moments) == 3
    if curved:
        for k, curve in enumerate(moments * separatrix(moments, 1.0, _SAMPLES)):
            seen.draw(axes, curve, None if k else "separatrix", color=PLUM, linewidth=1.2)
    if free and np.ptp(moments):
        if curved:
            for curve in polhode_family(moments, _SAMPLES):
                seen.draw(axes, curve, color=FAINT, linewidth=0.8)
        curve = moments * covered(moments, run.angular_velocity[0] @ along, _SAMPLES) / size[0]
        seen.draw(axes, curve, "path of L", color=VERMILLION, linewidth=2.6)
    elif not free:
        way = _in_pieces(path)
        seen.draw(
            axes,
            way,
            "path of L / |L|",
            color=VERMILLION,
            **_style(is_coarse(run.time, run.angular_velocity), len(path), 1.8),
        )
        axes.plot(*seen.at(path[-1]), "s", color=ORANGE, markersize=7, zorder=9, label=f"L {_when(run, -1)}")
    axes.plot(*seen.at(path[0]), "o", color=INK, markersize=7, zorder=9, label=f"L {_when(run, 0)}")
    seen.draw_axes(axes, [f"L{_SUBSCRIPTS[k]}{'' if seen.toward[k] >= 0 else ' < 0'}" for k in range(3)])
    bare(axes)
    extent = _extent(float(np.where(turning, size, 0.0).min()), float(size.max()))
    axes.set_title(f"Momentum sphere, along the principal axes\n|L| = {extent} kg m²/s", fontsize=12)
    _legend_below(axes)


def _in_pieces(path: Float) -> Float:
    """Return directions (m, 3) with a gap where they jump, as that of L does where L passes through zero."""
    jumps = np.flatnonzero(np.linalg.norm(np.diff(path, axis=0), axis=1) > COARSE) + 1
    return np.insert(path, jumps, np.nan, axis=0)


def _extent(one: float, other: float) -> str:
    return " … ".join(dict.fromkeys(f"{each:.4g}" for each in (one, other)))


def _distinct(moments: Float) -> int:
    """Return how many moments there are that differ by more than rounding."""
    return 1 + int((np.diff(np.sort(moments)) > _EQUAL * moments.max()).sum())


def _legend_below(axes: Axes) -> None:
    below = -0.12 if axes.axison else 0.0  # of the numbers and the name of the axis
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, below), ncols=4, fontsize=10, frameon=False, columnspacing=1.0)


def _effective_potential(axes: Axes, run: Subject) -> None:
    top = heavy_top_of(run)
    first, last = top.turning_angles
    beside = max(0.7 * (last - first), 0.15)
    theta = np.linspace(max(first - beside, _VERTICAL), min(last + beside, np.pi - _VERTICAL), 601)
    values, level = np.asarray(top.effective_potential(theta)), top.effective_energy
    low = float(values.min())
    depth = max(level - low, 0.05 * float(np.median(values) - low), 1e-9 * abs(level))
    axes.plot(theta, values, color=BLUE, linewidth=2.2, label="V(θ)")
    axes.plot(
        [first, last], [level, level], color=VERMILLION, linewidth=2.0, marker="|", markersize=12, label="energy E′"
    )
    tilt = float(run.quantities["theta"][0])
    at_start = top.effective_potential([np.clip(tilt, theta[0], theta[-1])])
    axes.plot([tilt], at_start, "o", color=INK, markersize=7, zorder=5, label=_when(run, 0))
    ceiling = level + 0.6 * depth
    shown = theta[values <= ceiling]
    shown = shown[np.abs(shown - 0.5 * (first + last)) <= 0.5 * (last - first) + beside]
    axes.set_ylim(low - 0.15 * depth, ceiling)
    axes.set_xlim(shown[0] - 0.1 * np.ptp(shown), shown[-1] + 0.1 * np.ptp(shown))
    _plain(axes, "tilt of the axis θ, rad", "V and E′, J", f"Effective potential\nθ = {_extent(first, last)} rad")
    _legend_below(axes)


def _axis_and_vertical(run: Subject) -> tuple[Float, Float]:
    """Return the axis (3,) that nutation is of, part axes, and what it nods about (3,), space axes."""
    problem = run.plan.problem
    scene = problem.scene
    if problem.rolls:
        return run.plan.axes[:, 2], np.array([0.0, 0.0, 1.0])
    if problem.slides:
        arm = scene.constraint.fixed_point - scene.body.center_of_mass
        return arm / np.linalg.norm(arm), np.asarray(scene.constraint.plane)
    return problem.axes @ problem.arm / np.linalg.norm(problem.arm), -scene.gravity / np.linalg.norm(scene.gravity)


def _nutation(axes: Axes, run: Subject) -> None:
    problem = run.plan.problem
    axis, up = _axis_and_vertical(run)
    path = quaternion.to_space(run.attitude, np.broadcast_to(axis, (len(run.time), 3)))
    side = path.mean(axis=0) - (path.mean(axis=0) @ up) * up
    if np.linalg.norm(side) < 1e-3:
        side = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
    heights = path @ up
    lift = 0.9 if heights.mean() >= 0 else -0.35  # from above, or from below where the axis hangs
    toward = side / np.linalg.norm(side) * np.sqrt(1.0 - lift**2) + lift * up
    seen = Projection(np.ones(3), toward, up)
    _draw_globe(axes, seen, up)
    seen.draw(
        axes,
        path,
        "path of the axis",
        color=VERMILLION,
        **_style(is_coarse(run.time, run.angular_velocity), len(path), 1.5),
    )
    circles = np.asarray(run.quantities.get("turning theta", []), dtype=np.float64)
    for k, angle in enumerate(circles):
        seen.draw(axes, _circle(up, float(angle)), None if k else "θ turns", color=GREEN, linewidth=1.4)
    axes.plot(*seen.at(path[0]), "o", color=INK, markersize=7, zorder=9, label=_when(run, 0))
    axes.plot(*seen.at(up), "^", color=BLUE, markersize=9, zorder=9, label="vertical")
    bare(axes)
    points = seen.at(np.concatenate([path, up[None], *(_circle(up, float(angle)) for angle in circles)]))
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    half = max(0.6 * float(np.ptp(points, axis=0).max()), 0.05)
    axes.set_xlim(middle[0] - half, middle[0] + half)
    axes.set_ylim(middle[1] - half, middle[1] + half)
    tilts = np.arccos(np.clip(heights, -1.0, 1.0))
    axes.set_title(
        f"Path of the {'symmetry axis' if problem.rolls else 'axis'} on the unit sphere\n"
        f"tilt {_extent(tilts.min(), tilts.max())} rad",
        fontsize=12,
    )
    _legend_below(axes)


def _circle(up: Float, angle: float) -> Float:
    first = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
    first /= np.linalg.norm(first)
    turn = np.linspace(0.0, 2.0 * np.pi, _SAMPLES)[:, None]
    return np.asarray(np.cos(angle) * up + np.sin(angle) * (np.cos(turn) * first + np.sin(turn) * np.cross(up, first)))


def _draw_globe(axes: Axes, seen: Projection, up: Float) -> None:
    """Draw the unit sphere with circles of latitude and longitude about the vertical."""
    edge = _circle(seen.toward, 0.5 * np.pi)
    axes.fill(*seen.at(edge).T, facecolor="#eef2f7", edgecolor=FAINT, linewidth=1.0, zorder=0)
    for degrees in range(15, 180, 15):
        seen.draw(axes, _circle(up, np.radians(degrees)), color="#c3ccd6", linewidth=0.7, zorder=1)
    pole, turn = _circle(up, 0.5 * np.pi), np.linspace(0.0, 2.0 * np.pi, _SAMPLES)[:, None]
    for k in range(0, (_SAMPLES - 1) // 2, 15):
        seen.draw(axes, np.cos(turn) * up + np.sin(turn) * pole[k], color="#c3ccd6", linewidth=0.7, zorder=1)


def _phase(run: Subject) -> tuple[Float, Float]:
    """Return the angle (n,) rad of an axle, or the tilt of a body that rolls, and its rate (n,) rad/s."""
    if "angle" in run.quantities:
        return run.quantities["angle"], run.angular_velocity @ run.plan.problem.axle
    return run.quantities["theta"], run.quantities["theta rate"]


def _phase_portrait(axes: Axes, run: Subject) -> None:
    angle, rate = _phase(run)
    name, what = "tilt of the axis θ, rad", "Phase portrait of the tilt"
    window = Window.around(angle, rate)
    if (swing := swing_of(run)) is not None:
        name, what = "angle θ from the start, rad", "Phase portrait"
        _draw_levels(axes, swing, window)
    every = slice(None, None, max(1, len(angle) // (4 * _MOST)))
    how = _style(is_coarse(run.time, run.angular_velocity), len(angle), 2.0)
    axes.plot(angle[every], rate[every], color=VERMILLION, label="the run", zorder=4, **how)
    axes.plot(angle[:1], rate[:1], "o", color=INK, markersize=7, zorder=5, label=_when(run, 0))
    axes.set_xlim(window.left, window.right)
    axes.set_ylim(window.low, window.high)
    _plain(axes, name, "its rate θ̇, rad/s", what)
    _legend_below(axes)


def _draw_levels(axes: Axes, swing: Swing, window: Window) -> None:
    """Draw curves of other energies, and those through the rest that is not stable."""
    if not swing.draws_levels(window):
        return
    angles = np.linspace(window.left, window.right, 721)
    curves = [(energy, FAINT, 0.8, 1, "equal energy") for energy in swing.levels(window).tolist()]
    if swing.barrier is not None:
        curves.append((swing.barrier, PLUM, 1.3, 2, "separatrix"))
    named: set[str] = set()
    for energy, color, width, order, label in curves:
        for rates in (each * swing.rates(energy, angles) for each in (1.0, -1.0)):
            if window.shows(rates):
                shown = None if label in named else label
                axes.plot(angles, rates, color=color, linewidth=width, zorder=order, label=shown)
                named.add(label)


def _swings(run: Subject) -> bool:
    """Whether there is a phase portrait that is more than a point or a line."""
    if not {"angle", "theta rate"} & run.quantities.keys():
        return False
    return float(np.ptp(_phase(run)[1])) > _EQUAL * float(np.abs(run.angular_velocity).max())


def _is_free(run: Subject) -> bool:
    problem = run.plan.problem
    moments, _ = numbered(run.plan)
    turns = problem.rigid and not problem.torques and not problem.weight and run.angular_velocity[0].any()
    return bool(turns) and _distinct(moments) > 1


def _has_ellipsoid(run: Subject) -> bool:
    moments, _ = numbered(run.plan)
    return _is_free(run) and float(moments.max() / moments.min()) <= _LONGEST**2


def _has_momentum_sphere(run: Subject) -> bool:
    problem = run.plan.problem
    return _is_free(run) or bool(
        problem.rigid and problem.torques and not problem.weight and run.angular_momentum.any()
    )


def _has_axis(run: Subject) -> bool:
    problem = run.plan.problem
    scene = problem.scene
    if problem.slides:
        return bool(np.any(scene.constraint.fixed_point - scene.body.center_of_mass))
    return problem.rolls or (problem.rigid and problem.weight > 0)


KINDS = {
    "effective potential": Kind(lambda run: "effective potential energy" in run.quantities, _effective_potential),
    "phase portrait": Kind(_swings, _phase_portrait),
    "nutation": Kind(_has_axis, _nutation),
    "polhode": Kind(_has_ellipsoid, _polhode),
    "momentum sphere": Kind(_has_momentum_sphere, _momentum_sphere),
    "angular velocity": Kind(lambda run: True, _angular_velocity),
}
"""The kinds by their names, the most telling first."""
