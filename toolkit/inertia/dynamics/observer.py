"""Samples that a computation hands on while it goes on, before anything is known of their accuracy."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

import numpy as np

from inertia.arrays import Float

Take = Callable[[Float, Float, Float], None]
"""Takes instants (k,) s, attitudes (k, 4), part axes to space, and angular velocities (k, 3) rad/s, part axes."""

INTERVAL = 0.1
"""Seconds between two blocks of samples, at least."""


class Observer:
    """Hands on each instant once, in ascending order: what is computed again is left out.

    Parameters
    ----------
    take : what samples are handed to, by any thread, one at a time
    """

    def __init__(self, take: Take) -> None:
        self._take = take
        self._reached = -np.inf
        self._next = time.monotonic()

    @property
    def due(self) -> bool:
        """Whether it is time for the next block."""
        return time.monotonic() >= self._next

    def __call__(self, instants: Float, attitude: Float, angular_velocity: Float) -> None:
        """Hand samples (k,) on, those that are later than all before."""
        later = slice(int(np.searchsorted(instants, self._reached, side="right")), None)
        if len(instants[later]):
            self._reached = float(instants[-1])
            self._take(instants[later], attitude[later], angular_velocity[later])
        self._next = time.monotonic() + INTERVAL


_observer: ContextVar[Observer | None] = ContextVar("who observes the run", default=None)


@contextmanager
def observed(observer: Observer | None) -> Iterator[None]:
    """Let models hand on what they compute within."""
    token = _observer.set(observer)
    try:
        yield
    finally:
        _observer.reset(token)


def observing() -> Observer | None:
    """Return who observes the run, if anybody does."""
    return _observer.get()


@contextmanager
def meanwhile(look: Callable[[], None] | None) -> Iterator[None]:
    """Look every `INTERVAL` seconds while compiled code runs in this thread."""
    if look is None:
        yield
        return
    done, faults = threading.Event(), []

    def looking() -> None:
        try:
            while not done.wait(INTERVAL):
                look()
        except Exception as error:  # belongs to the thread that computes
            faults.append(error)

    thread = threading.Thread(target=looking, daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()
    if faults:
        raise faults[0]
    look()
