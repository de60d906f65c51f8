"""Pictures of a recording, still (PNG) or moving (GIF), drawn by Rerun's viewer without a window."""

from __future__ import annotations

import io
import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from inertia.arrays import Progress
from inertia.errors import InertiaError, UsageError
from inertia.output import require_writable, temporary_folder, write_whole
from inertia.recording import viewer
from inertia.recording.provenance import playback_speed, properties

if TYPE_CHECKING:
    from PIL.Image import Image  # slow to import

_NANO = 1e9
_LARGEST = 4096  # pixels along an edge
_TICK = 100  # a second: what the durations of a GIF are counted in
_COLORS = 256
_BAR, _EDGE = 36, 1  # pixels of the window's own frame
_FRAME = 5, 34  # pixels of a view's own frame, across and down, with its name
_TOAST = 5.0  # s, for which the viewer shows a message in a corner after its first frame
_SAMPLED = 8  # frames that the colours of all are chosen from
_PATIENCE = 600.0  # s, for a recording to be loaded, or to be drawn

Answer = TypeVar("Answer")


def export_picture(
    recording: str | os.PathLike[str],
    path: str | os.PathLike[str],
    *,
    at: float = 0.0,
    view: str | None = None,
    size: tuple[int, int] = (1280, 800),
    frames: int = 60,
    fps: float = 15.0,
    force: bool = False,
    progress: Progress | None = None,
) -> None:
    """Write what the viewer shows of a recording: as PNG at one instant, or as GIF from there on, as fast as it plays.

    It needs a Vulkan driver, but no screen; one in software will do. A GIF ends where the recording does.

    Parameters
    ----------
    recording : of a file ending in .rrd
    path : of the file, ending in .png or .gif
    at : s from the start of the run
    view : the name of one view, or how it begins, which is then drawn alone; None for all of them
    size : of the picture, pixels
    frames : of a GIF
    fps : frames of a GIF in a second, 50 at most
    force : write over a file that is there
    progress : called with the fraction done

    Raises
    ------
    UsageError : a path, an instant, a view, a size or a rate that is not usable, or a file that is there
    ReadError : the recording is not one, not whole, or its name ends in something else
    InertiaError : there is no Vulkan driver, or the place cannot be written to
    """
    target = require_writable(path, ".png", ".gif", force=force)
    if not all(1 <= edge <= _LARGEST for edge in size):
        raise UsageError(f"a picture of {size[0]} by {size[1]} pixels: give 1 to {_LARGEST} each way")
    if not (frames >= 1 and 0 < fps <= _TICK / 2):
        raise UsageError(f"{frames} frames at {fps:.6g} a second: give 1 or more, and up to {_TICK // 2} a second")
    properties(recording)
    viewer.require_name(Path(recording))
    moving = target.suffix.lower() == ".gif"
    count, step = (frames, playback_speed(recording) / fps) if moving else (1, 0.0)
    drawn = size if view is None else (size[0] + _FRAME[0], size[1] + _FRAME[1])
    with temporary_folder() as home, _opened(Path(recording), home, drawn) as screen:
        if not 0 <= at <= screen.duration:
            raise UsageError(f"there is nothing to see at {at:.6g} s: the recording lasts {screen.duration:.6g} s")
        number = None if view is None else screen.maximise(view)
        instants = [t for k in range(count) if (t := at + k * step) <= screen.duration]
        images = []
        for k, instant in enumerate(instants):
            image = _image(screen.picture(instant, number, settled=k == 0))
            images.append(image.crop((_EDGE, _BAR, _EDGE + size[0], _BAR + size[1])) if view is None else image)
            if progress is not None:
                progress((k + 1) / len(instants))
    write_whole(target, _gif(images, fps) if moving else _png(images[0]))


class _Screen:
    """A viewer without a window that has loaded a recording."""

    def __init__(self, client: Any, waited: Callable[[Callable[[], Any]], Any]) -> None:
        self._client, self._waited = client, waited
        recording = waited(client.get_state).recordings[0]
        self._timeline = next(each for each in recording.timelines if each.name == recording.current_timeline)
        self.duration = (self._timeline.end - self._timeline.start) / _NANO

    def maximise(self, name: str) -> str:
        """Show the view whose name begins so alone, without the panel of the time; return the viewer's number of it."""
        views = [view for view in self._waited(self._client.get_state).views if view.visible]
        numbers = [view.view_id for view in views if view.name.lower().startswith(name.lower())]
        if not numbers:
            names = ", ".join(sorted(repr(view.name) for view in views))
            raise UsageError(f"the recording has no view {name!r}: its views are {names}")
        shown = self._waited(self._client.get_blueprint).blueprint
        shown["/viewport"]["ViewportBlueprint"]["maximized"] = str(numbers[0])
        shown["/time_panel"]["TimePanelBlueprint"]["state"] = "Hidden"
        self._client.set_blueprint(shown, of="recording")
        return str(numbers[0])

    def picture(self, instant: float, view: str | None, *, settled: bool) -> bytes:
        """Return the PNG of what is seen at an instant.

        `settled`: when no message is shown any more, and two in a row agree, as plots find their range late.
        """
        seconds = self._timeline.start / _NANO + instant
        last, begin = b"", 0.0

        def drawn() -> bytes:
            nonlocal last, begin
            if not last:
                self._client.set_time(self._timeline.name, duration=seconds, play_state="paused")
            last, before = self._client.take_screenshot(view), last
            begin = begin or time.monotonic()
            return last if not settled or (last == before and time.monotonic() > begin + _TOAST) else b""

        picture: bytes = self._waited(drawn)
        return picture


@contextmanager
def _opened(recording: Path, home: Path, size: tuple[int, int]) -> Iterator[_Screen]:
    """Open a viewer of a size in pixels that has no window, and a recording in it."""
    from rerun.experimental import ViewerClient

    window = f"{size[0] + 2 * _EDGE}x{size[1] + _BAR + _EDGE}"
    options = ("--headless", "--port", "0", "--window-size", window, "--hide-welcome-screen")
    with viewer.listening(home, *options) as (address, process, log):
        end = time.monotonic() + _PATIENCE

        def waited(ask: Callable[[], Answer]) -> Answer:
            """Return the first answer that is there."""
            while True:
                try:
                    if answer := ask():
                        return answer
                except (RuntimeError, OSError):  # it does not listen yet, or any more
                    process.poll()
                if process.poll() is not None:
                    raise _ended(log())
                if time.monotonic() > end:
                    raise InertiaError(
                        f"Rerun's viewer did not draw {recording} in {_PATIENCE:g} s: ask for less of it",
                        code="no_viewer",
                    )
                time.sleep(0.02)

        client: Any = waited(lambda: ViewerClient.connect(f"rerun+http://{address}/proxy") if address else None)
        waited(lambda: client.get_state() and client.open(str(recording.resolve())))

        def loaded() -> bool:
            state = client.get_state()
            return bool(state.recordings and state.views and not state.loading)

        waited(loaded)
        client.run_command("ui.toggle_top_panel")
        yield _Screen(client, waited)


def _ended(log: str) -> InertiaError:
    if "graphics adapter" in log:
        return InertiaError(
            "pictures need a Vulkan driver, and there is none on this machine: install one, in software will do "
            "(Debian and Ubuntu: apt install mesa-vulkan-drivers)",
            code="needs_package",
        )
    return InertiaError(
        "Rerun's viewer ended before the picture was drawn: see whether `inertia play` opens the recording",
        code="no_viewer",
    )


def _image(picture: bytes) -> Image:
    from PIL import Image

    return Image.open(io.BytesIO(picture)).convert("RGB")


def _png(image: Image) -> bytes:
    file = io.BytesIO()
    image.save(file, "PNG", optimize=True)
    return file.getvalue()


def _gif(images: list[Image], fps: float) -> bytes:
    """Return an endless GIF in colours that suit all of its frames."""
    from PIL import Image

    width, height = images[0].size
    some = images[:: max(1, len(images) // _SAMPLED)]
    sheet = Image.new("RGB", (width, height * len(some)))
    for k, image in enumerate(some):
        sheet.paste(image, (0, k * height))
    palette = sheet.quantize(_COLORS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)  # curves keep theirs
    flat = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    ends = [round((k + 1) * _TICK / fps) for k in range(len(images))]
    durations = [1000 * (end - start) // _TICK for start, end in zip([0, *ends], ends, strict=False)]
    file = io.BytesIO()
    flat[0].save(file, "GIF", save_all=True, append_images=flat[1:], duration=durations, loop=0, optimize=True)
    return file.getvalue()
