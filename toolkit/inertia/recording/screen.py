"""What every kind of run hands to the writer: an application id, an arrangement of views, and what fills them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from inertia.recording.writer import Recording

if TYPE_CHECKING:
    import rerun.blueprint as rrb


@dataclass(frozen=True, eq=False)
class Screen:
    """A recording to be written.

    Attributes
    ----------
    application : the id that the viewer keeps blueprints by: one for each kind of run
    name : what the viewer calls the recording
    blueprint : the views, with which the file opens
    write : fills a recording
    """

    application: str
    name: str
    blueprint: rrb.Blueprint
    write: Callable[[Recording], None]
