"""`Run`: what a simulation hands back, in part axes and SI units, with the accuracy it reached."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from inertia import __version__
from inertia.arrays import Float, Int
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.kinematics.andoyer import Andoyer, to_andoyer
from inertia.dynamics.kinematics.canonical import momenta
from inertia.dynamics.kinematics.euler_angles import Convention, to_angles, unwrap
from inertia.dynamics.motion import Event, Motion
from inertia.dynamics.plan import Plan
from inertia.dynamics.scene.document import Scene
from inertia.errors import GeometryError, UsageError, visible
from inertia.records import dataclass

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from inertia.dynamics.columns import Table

_PAIRS = ("turning theta", "turning angle", "steady precession, slow and fast")
"""Quantities that are two numbers, however many samples there are."""

_CLOSE, _MOST = 0.1, 20_001  # rad between the instants that a drawing goes through, and how many they are at most
_BENT = 0.05  # of the largest ω, that it may be off the straight line from the instant before to the one after
_ROUNDS, _PARTS = 3, 10  # how often what is beside a bend is divided, and into how many parts

_SERIES = ("time", "attitude", "angular_velocity", "angular_momentum", "energy", "position")


@dataclass(frozen=True)
class RunError:
    """The accuracy of the attitude.

    Attributes
    ----------
    requested : rad, as asked for
    reached : rad, at the worst sample up to `until`, for the mass properties as they are
    method : that ran
    inputs : rad, how far the bounds of the mass properties may move the attitude by the end, π at most
    until : s, up to which they move it by no more than was asked for; later nothing is claimed
    """

    requested: float
    reached: float
    method: str
    inputs: float = 0.0
    until: float = math.inf


@dataclass(frozen=True, eq=False)
class Invariant:
    """Something that the equations keep: its value at every sample, (n,) or (n, 3), and how far it strayed.

    The drift is the largest |value(t) − value(0)|, relative to |value(0)| or to the model's own scale where that may
    vanish. `initial`, () or (3,), is its value at t = 0.
    """

    values: Float
    largest_relative_drift: float
    initial: Float


@dataclass(frozen=True, eq=False)
class Run:
    """The motion of a body at n instants.

    Attributes
    ----------
    plan : `Plan`: the model that ran, in which axes, and why
    time : (n,) s
    attitude : (n, 4) unit quaternions, scalar last, part axes to space, as `Rotation.from_quat` of scipy takes them
    angular_velocity : (n, 3) rad/s, part axes
    angular_momentum : (n, 3) kg m²/s, space axes, about the centre of mass or the fixed point
    energy : (n,) J: of the rotation about that point, and of gravity where it turns the body; of a rolling body, all;
        of a body that changes its shape, of all motion about its centre of mass
    position : (n, 3) m, the centre of mass in space; None where the scene leaves it at the origin
    error : `RunError`
    invariants : {name: `Invariant`}
    remarks : what kind of motion it is, in sentences
    events : `Event`, in the order of time
    warnings : sentences
    quantities : {name: (n, …) or a number} further outputs of the model, SI units
    steps : how many steps were taken; 0 for a closed form
    follow : takes instants (n,) s, ascending from 0 to the end, to the run sampled there; None where it stands alone
    """

    plan: Plan
    time: Float
    attitude: Float
    angular_velocity: Float
    angular_momentum: Float
    energy: Float
    position: Float | None
    error: RunError
    invariants: Mapping[str, Invariant] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    events: tuple[Event, ...] = ()
    warnings: tuple[str, ...] = ()
    quantities: Mapping[str, Float] = field(default_factory=dict)
    steps: int = 0
    follow: Callable[[Float], Run] | None = None

    @property
    def scene(self) -> Scene:
        """The scene that was followed."""
        return self.plan.problem.scene

    @property
    def model(self) -> str:
        """The name of the model that ran."""
        return self.plan.model

    @property
    def why(self) -> tuple[str, ...]:
        """The reasons for it, in sentences."""
        return self.plan.why

    @property
    def series(self) -> dict[str, Float]:
        """The quantities that go with the time, {name: (n, …)}; the others are figures of the whole run."""
        arrays = {name: np.asarray(values) for name, values in self.quantities.items()}
        return {
            name: values
            for name, values in arrays.items()
            if values.ndim and len(values) == len(self.time) and name not in _PAIRS
        }

    def at(self, time: ArrayLike) -> Run:
        """Return the run at other instants, with all that it has at its samples.

        A closed form is evaluated there; a rigid body that is stepped is stepped again from the samples before these
        instants to those after them, or, where that is no less work, from the start to its end; any other motion is
        followed again. Nothing is interpolated, and the claim `error` is that of the run or a larger one.

        Parameters
        ----------
        time : () or (n,) s, in any order, from 0 to the end of the run

        Raises `UsageError` where an instant is no number or outside of the run.

        >>> from inertia import Scene, simulate
        >>> run = simulate(Scene.from_dict({"body": {"principal_moments": [2, 2, 2]},
        ...     "start": {"angular_velocity": [0, 0, 1]}, "run": {"duration": 10, "samples": 2}}))
        >>> run.at(3.0).attitude.round(12).tolist()         # turned by 3 rad about axis 3
        [[0.0, 0.0, 0.997494986604, 0.070737201668]]
        """
        instants, end = np.atleast_1d(np.asarray(time, dtype=np.float64)), self.scene.run.duration
        if self.follow is None:
            raise UsageError("this run was put together by hand and cannot be followed again: simulate its scene")
        if instants.ndim != 1 or not instants.size:
            raise UsageError(f"the instants have shape {instants.shape}: give one number of seconds, or a row of them")
        if (outside := ~((instants >= 0) & (instants <= end))).any():
            raise UsageError(
                f"t = {instants[outside][0]:g} s is outside of the run, which goes from 0 to {end:g} s: ask for an "
                "instant within it, or simulate for longer"
            )
        # What is kept is measured from the start on, and steps are chosen for the whole run.
        all_of_them = np.unique(np.concatenate([[0.0], instants, [end]]))
        anew = self.follow(all_of_them)
        reached = max(self.error.reached, anew.error.reached)
        return replace(anew._rows(np.searchsorted(all_of_them, instants)), error=replace(anew.error, reached=reached))

    def _rows(self, rows: Int) -> Run:
        """Return the samples (m,) of a run alone."""
        return replace(
            self,
            time=self.time[rows],
            attitude=self.attitude[rows],
            angular_velocity=self.angular_velocity[rows],
            angular_momentum=self.angular_momentum[rows],
            energy=self.energy[rows],
            position=None if self.position is None else self.position[rows],
            invariants={name: replace(each, values=each.values[rows]) for name, each in self.invariants.items()},
            quantities={**self.quantities, **{name: values[rows] for name, values in self.series.items()}},
        )

    @property
    def columns(self) -> dict[str, Float]:
        """What goes with the time by the names of the columns of `to_csv`, each (n,), as data frames take it."""
        from inertia.dynamics.columns import Table

        return {name: values for name, (values, _) in Table(self._series, {}).columns.items()}

    def to_csv(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write all series of the run to a CSV file, SI, with names and units; every number reads back as it was.

        The first line is a comment with what the run is of, as JSON, ``inertia/run-table/1``; the second has the names.
        The file appears when it is whole; one that is there is written over with `force` only.
        """
        self._table().to_csv(path, force=force)

    def to_npz(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write all series of the run to a NumPy archive, arrays as they are, and `metadata`, JSON; see `to_csv`."""
        self._table().to_npz(path, force=force)

    def to_parquet(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write the columns of `to_csv` to a Parquet file, with the metadata under the key `inertia`.

        Raises `UsageError` where pyarrow is not installed.
        """
        self._table().to_parquet(path, force=force)

    def plot(self, kind: str | None = None, ax: Axes | None = None) -> Figure:
        """Draw the run by matplotlib, and return the figure, which shows itself in a notebook and has `savefig`.

        Where samples are too far apart for a line through them, the run is followed at more instants for the drawing.

        Parameters
        ----------
        kind : "effective potential", "phase portrait", "nutation", "polhode", "momentum sphere" or "angular velocity";
            all that suit the run, side by side, without it
        ax : axes to draw on, of any figure; one kind only, the most telling without `kind`

        Raises `UsageError` where a kind does not suit the run, or matplotlib is not installed.
        """
        from inertia.dynamics.plots.kinds import draw
        from inertia.plotting import quiet_matplotlib, require_matplotlib

        require_matplotlib()
        with quiet_matplotlib():
            name = visible(Path(self.scene.name).name)
            return draw(self._followed_closely(), kind, ax, f"{name}, {self.model}, {self.scene.run.duration:g} s")

    def _repr_html_(self) -> str:
        """Return a small table and a sketch of ω(t), as a notebook shows it."""
        from inertia.dynamics.notebook import curves_svg
        from inertia.dynamics.plots.subject import numbered
        from inertia.notebook import html_of

        error, deforms = self.error, self.scene.body.deforms
        count = f"{len(self.time)} {'sample' if len(self.time) == 1 else 'samples'}"
        until = "" if error.until >= self.scene.run.duration else f" up to {error.until:.3g} s"
        rows = [
            ("Scene", Path(self.scene.name).name),
            ("Model", f"{self.model}, {error.method}"),
            ("Run", f"{self.scene.run.duration:g} s, {count}"),
            ("Accuracy", f"attitude to {error.reached:.2g} rad{until}, {error.requested:g} rad asked for"),
            *(("Kept", f"{name}, drift {each.largest_relative_drift:.2g}") for name, each in self.invariants.items()),
            *(("Motion", remark) for remark in self.remarks),
            *(("Note", warning) for warning in self.warnings),
        ]
        along = np.eye(3) if deforms else numbered(self.plan)[1]
        unit = f"rad/s along the {'part' if deforms else 'principal'} axes"
        sketch = curves_svg(self.time, self.angular_velocity @ along, ("ω₁", "ω₂", "ω₃"), unit)
        return html_of(rows, sketch)

    def _followed_closely(self) -> Run:
        """Return the run at as many instants as a line needs, or as it is: where a stiff hinge comes to its pace, ω
        bends within far less than a turn takes."""
        settings = self.scene.run
        turned = float(np.linalg.norm(self.angular_velocity, axis=1).max()) * settings.duration
        whole = len(self.time) == settings.samples and self.time[-1] == settings.duration
        if not whole or self.follow is None:
            return self
        run = self
        try:
            if turned / (len(self.time) - 1) > _CLOSE:
                run = self.at(np.linspace(0.0, settings.duration, min(int(turned / _CLOSE) + 2, _MOST)))
            for _ in range(_ROUNDS):
                divided = _divided(run.time, run.angular_velocity)
                if len(run.time) == len(divided) or len(divided) > _MOST:
                    break
                run = self.at(divided)
        except GeometryError:  # which takes too long, or reaches less between the samples
            pass
        return run

    @property
    def _series(self) -> dict[str, Float]:
        return {name: getattr(self, name) for name in _SERIES if getattr(self, name) is not None} | self.series

    def _table(self) -> Table:
        """Return what goes with the time, and what it is of."""
        import hashlib

        from inertia.dynamics.columns import Table

        scene, body = self.scene, self.scene.body
        series = self._series
        text = scene.source_text
        figures = {name: _entry(values) for name, values in self.quantities.items() if name not in series}
        about = {
            "schema": "inertia/run-table/1",
            "inertia": __version__,
            "scene": visible(scene.name),
            "scene_sha256": None if text is None else hashlib.sha256(text.encode()).hexdigest(),
            "parts": {visible(part.name): part.source.sha256 for part in (body.part, *body.meshes) if part is not None},
            "run": {name: getattr(scene.run, name) for name in ("duration", "samples", "accuracy", "model", "method")},
            "model": self.model,
            "accuracy": {**vars(self.error), "until": min(self.error.until, scene.run.duration)},
            "warnings": list(self.warnings),
            "figures": figures,
        }
        if body.assembly is None:
            return Table(series, about)
        joints = ["rad" if joint.revolute else "m" for joint in body.assembly.joints]
        poses = [*("m",) * 3, *("1",) * 4] * len(body.assembly.parts)
        return Table(series, about, {"joint values": joints, "part poses": poses})

    def euler_angles(self, convention: Convention = "z-x-z") -> Float:
        """Return Euler angles (n, 3) of the part axes, rad, without jumps (`kinematics.euler_angles`)."""
        return unwrap(to_angles(self.attitude, convention), convention)

    def canonical_momenta(self, convention: Convention = "z-x-z") -> Float:
        """Return the momenta (n, 3) conjugate to `euler_angles`, kg m²/s (`kinematics.canonical.momenta`)."""
        return momenta(to_angles(self.attitude, convention), self.angular_momentum, convention, "space")

    def andoyer(self) -> Andoyer:
        """Return the Serret–Andoyer variables of the part axes (`inertia.dynamics.kinematics.andoyer`)."""
        return to_andoyer(self.attitude, quaternion.to_body(self.attitude, self.angular_momentum))


def _entry(values: Float) -> Any:
    """Return a figure as JSON takes it: null for what is not finite."""
    array = np.asarray(values)
    return np.where(np.isfinite(array), array, None).tolist()  # type: ignore[call-overload]


def invariants_of(motion: Motion, angular_momentum: Float) -> dict[str, Invariant]:
    """Return what a motion keeps, with its drift; L (n, 3) and its components are measured by the largest |L|,
    or by the model's scale where that is larger."""
    largest = float(np.linalg.norm(angular_momentum, axis=1).max())
    invariants = {}
    for name, values in motion.invariants.items():
        scale = motion.scales.get(name)
        if name.startswith("angular momentum"):
            scale = max(largest, scale or 0.0)
        invariants[name] = _invariant(values, scale)
    return invariants


def _invariant(values: Float, scale: float | None) -> Invariant:
    vectors = values if values.ndim == 2 else values[:, None]
    strayed = float(np.linalg.norm(vectors - vectors[0], axis=1).max())
    size = scale or float(np.linalg.norm(vectors[0]))
    drift = 0.0 if strayed == 0 else strayed / size if size else np.inf
    return Invariant(values, drift, np.asarray(values[0]))


def _divided(time: Float, omega: Float) -> Float:
    """Return instants (n,) s with others between those that are beside a bend of ω (n, 3) rad/s."""
    ahead = ((time[1:-1] - time[:-2]) / (time[2:] - time[:-2]))[:, None]
    off = np.linalg.norm(omega[1:-1] - omega[:-2] - ahead * (omega[2:] - omega[:-2]), axis=1)
    bends = np.flatnonzero(off > _BENT * float(np.linalg.norm(omega, axis=1).max()))
    beside = np.unique([bends, bends + 1])
    between = time[beside, None] + np.diff(time)[beside, None] * (np.arange(1, _PARTS) / _PARTS)
    return np.union1d(time, between)
