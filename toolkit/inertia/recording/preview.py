"""A run on an open viewer while it is computed: poses and ω as they come, before their accuracy is known.

What came before an interruption can be recorded to a file, too.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack, suppress
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

import numpy as np

from inertia import __version__
from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.deforming.jointed_body import JointedBody
from inertia.dynamics.plots.subject import is_coarse
from inertia.dynamics.scene.document import Scene
from inertia.errors import InertiaError, visible
from inertia.recording import entities
from inertia.recording.display import display_of, solids_of
from inertia.recording.drawing import COLORS, write_axes, write_place, write_text
from inertia.recording.live import ViewerError, to_viewer
from inertia.recording.playback import scale_of
from inertia.recording.provenance import of_scene
from inertia.recording.screen import eye, following, plot, space_view, text_view
from inertia.recording.summary import markdown, sentence
from inertia.recording.writer import Recording, to_file

if TYPE_CHECKING:
    import rerun.blueprint as rrb

APPLICATION = "inertia-live"

_ROOM, _AXES, _THICK = 1.4, 1.15, 0.012  # over the radius of the body
_Samples = tuple[Float, Float, Float]


class Preview:
    """Shows samples on an open viewer; a context, which is left when the run is computed, or fails.

    Attributes
    ----------
    lost : why the viewer shows no more, if it does not
    reached : s, the last instant that was computed
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._samples: list[_Samples] = []
        self._open = ExitStack()
        self._write: Callable[[_Samples], None] | None = None
        self._recording: Recording | None = None
        self.lost: ViewerError | None = None
        self.reached = 0.0

    def __enter__(self) -> Preview:
        """Open the viewer's recording.

        Raises `ViewerError` where no viewer listens.
        """
        self._recording = self._open.enter_context(to_viewer(APPLICATION, self._blueprint(), self._second))
        self._guarded(self._begin)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Say on the viewer how it ended."""
        if error is not None:
            self._guarded(lambda recording: write_text(recording, self._text(self._end_of(error))))
        self._guarded(lambda _: self._open.close())

    def take(self, time: Float, attitude: Float, angular_velocity: Float) -> None:
        """Show samples (k,), part axes (`inertia.simulate`)."""
        samples = time, attitude, angular_velocity
        self._samples.append(samples)
        self.reached = float(time[-1])
        self._guarded(lambda _: self._write and self._write(samples))

    def save(self, path: Path) -> bool:
        """Record the samples so far to a file; say no, and write none, where there are fewer than two."""
        if sum(len(time) for time, _, _ in self._samples) < 2:
            return False
        time, attitude, omega = map(np.concatenate, zip(*self._samples, strict=True))
        with to_file(path, APPLICATION, self._blueprint(), self._second) as recording:
            self._begin(recording)
            assert self._write is not None
            self._write((time, attitude, omega))
            write_text(recording, self._text(self._end_of(KeyboardInterrupt())))
        return True

    def _guarded(self, act: Callable[[Recording], object]) -> None:
        """Act on the viewer's recording while there is one: the run goes on without."""
        if self.lost is not None or self._recording is None:
            return
        try:
            act(self._recording)
        except ViewerError as error:
            self.lost = error
            with suppress(ViewerError):
                self._open.__exit__(ViewerError, error, None)

    @property
    def _axes(self) -> Float:
        """The axes (3, 3), columns in part axes, that ω is along: the principal ones of a body that has them."""
        body = self._scene.body
        return np.eye(3) if body.deforms else body.axes

    @property
    def _apart(self) -> float:
        """Seconds from one sample to the next."""
        return self._scene.run.duration / max(self._scene.run.samples - 1, 1)

    @property
    def _second(self) -> float:
        return float(10.0 ** scale_of(self._apart, self._scene.run.duration))

    def _begin(self, recording: Recording) -> None:
        """Write what does not move."""
        import rerun as rr

        for name, values in {"tool": {"name": "inertia", "version": __version__}, **of_scene(self._scene)}.items():
            recording.properties(name, values)
        recording.properties("timeline", {"second_s": self._second})
        recording.name(visible(Path(self._scene.name).name))
        recording.static(entities.WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        write_text(recording, self._text("Poses are shown as they are computed; the finished screen follows them."))
        assembly = self._scene.body.assembly if self._scene.body.deforms else None
        place = self._rigid(recording) if assembly is None else self._jointed(recording, assembly)
        joined = not is_coarse(np.array([0.0, self._apart]), self._scene.start.angular_velocity[None])

        def write(samples: _Samples) -> None:
            time, attitude, omega = samples
            place(time, attitude)
            names = [f"ω{axis}, rad/s" for axis in ("xyz" if self._scene.body.deforms else "123")]
            along = omega @ self._axes
            recording.scalars(
                entities.PLOT_ANGULAR_VELOCITY, time, lambda rows: along[rows], names, COLORS[:3], joined=joined
            )

        self._write = write

    def _rigid(self, recording: Recording) -> Callable[[Float, Float], None]:
        """Write a body that keeps its shape; return what turns it."""
        body = display_of(self._scene.body)
        recording.static(entities.MESH, body.archetype())
        write_axes(recording, entities.BODY_AXES, _AXES * body.radius * self._axes, _THICK * body.radius)
        center = np.zeros(3, np.float32)
        return lambda time, attitude: write_place(
            recording, entities.BODY, time, np.broadcast_to(center, (len(time), 3)), attitude
        )

    def _jointed(self, recording: Recording, assembly: JointedBody) -> Callable[[Float, Float], None]:
        """Write a body of parts; return what moves them."""
        import rerun as rr

        unit = self._reach(assembly)
        paths = [f"{entities.PARTS}/{rr.escape_entity_path_part(part.name)}" for part in assembly.parts]
        for k, (path, solid) in enumerate(zip(paths, solids_of(assembly, self._scene.body.meshes), strict=True)):
            recording.static(f"{path}/solid", solid.archetype(unit, k))

        def place(time: Float, attitude: Float) -> None:
            shape = assembly.shape(time)
            root = quaternion.to_space(attitude, -shape.center_of_mass / unit)
            write_place(recording, entities.BODY, time, root, attitude)
            for k, path in enumerate(paths):
                write_place(recording, path, time, shape.part_position[:, k] / unit, shape.part_attitude[:, k])

        return place

    def _reach(self, assembly: JointedBody) -> float:
        """Return how far a body of parts reaches from its centre of mass at the start, m."""
        shape = assembly.shape(np.zeros(1))
        solids = solids_of(assembly, self._scene.body.meshes)
        centers = [
            quaternion.to_space(shape.part_attitude[0, k], solid.center) + shape.part_position[0, k]
            for k, solid in enumerate(solids)
        ]
        return max(
            float(np.linalg.norm(center - shape.center_of_mass[0])) + solid.radius
            for center, solid in zip(centers, solids, strict=True)
        )

    def _blueprint(self) -> rrb.Blueprint:
        import rerun.blueprint as rrb

        radius = 1.0 if self._scene.body.deforms else display_of(self._scene.body).radius
        view = space_view(
            entities.CENTER, contents=f"/{entities.WORLD}/**", name="As computed", eye_controls=eye(_ROOM * radius)
        )
        omega = plot(
            entities.PLOT_ANGULAR_VELOCITY,
            f"Angular velocity along the {'part' if self._scene.body.deforms else 'principal'} axes, rad/s",
            self._scene.run.duration / self._second,
        )
        return following(view, rrb.Vertical(omega, text_view(), row_shares=[2, 1]))

    def _text(self, how: str) -> str:
        return f"**Not judged yet.** {how} Nothing is known of their accuracy before all of them are there."

    def _end_of(self, error: BaseException) -> str:
        """Say how the run ended, and what there is of it."""
        why = markdown(sentence(str(error))) if isinstance(error, InertiaError) else "The run was interrupted."
        return f"{why} These are the poses of the first {self.reached:.4g} of {self._scene.run.duration:g} s."
