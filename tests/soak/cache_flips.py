"""Compiled kernels in the cache, and their key, with bits flipped, bytes lost or put in: compiled again, never run."""

from __future__ import annotations

import os
import shutil
import signal
import warnings
from functools import cache
from pathlib import Path

import numpy as np

from inertia import native
from inertia.errors import CacheWarning
from inertia.mesh.geometry import corner_keys
from inertia.native import Kernel, address

from .workers import Outcome

_SAME, _AGAIN, _WRONG = 10, 11, 12  # exit codes


def _answer() -> bytes:
    """Return what a new process gets from the kernel, by the cache that `INERTIA_CACHE` names."""
    vertices, salt = np.arange(24.0).reshape(-1, 3), np.arange(1, 25, dtype=np.uint64) << np.uint64(40)
    keys = np.zeros(len(vertices), np.uint64)
    native.SHIPPED = native.SHIPPED / "none"  # in this process, which runs this campaign alone
    kernel = Kernel(corner_keys.KEYS.module, corner_keys.KEYS.name, corner_keys.KEYS.abi)
    kernel.function(address(vertices), len(vertices), address(salt), address(keys))
    return keys.tobytes()


@cache
def _cached(folder: Path) -> tuple[dict[str, bytes], bytes]:
    """Return the files of a cache with one kernel, and the kernel's answer."""
    import numba  # noqa: F401  # so that the forks need not

    store = folder / "store"
    os.environ["INERTIA_CACHE"] = str(store)
    answer = _answer()
    files = {file.name: file.read_bytes() for file in store.iterdir() if file.is_file()}
    assert any(name.endswith(".kernel") for name in files), files.keys()
    return files, answer


def case(seed: int, number: int, folder: Path) -> Outcome:
    """Damage a file of the cache, and let a fork of this process load the kernel."""
    rng = np.random.default_rng([seed, number])
    files, answer = _cached(folder)
    store = folder / "damaged"
    shutil.rmtree(store, ignore_errors=True)
    store.mkdir(mode=0o700)
    chosen = sorted(files)[rng.integers(len(files))]
    for name, data in files.items():
        changed = bytearray(data)
        if name == chosen:
            at = int(rng.integers(len(data)))
            match rng.integers(6):
                case 0 | 1 | 2 | 3:
                    changed[at] ^= 1 << int(rng.integers(8))
                case 4:
                    del changed[at:]
                case 5:
                    changed[at:at] = rng.bytes(int(rng.integers(1, 9)))
        descriptor = os.open(store / name, os.O_WRONLY | os.O_CREAT, 0o600)
        os.write(descriptor, changed)
        os.close(descriptor)
    pid = os.fork()
    if pid == 0:
        _load(store, answer)
    code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    if code not in (_SAME, _AGAIN):
        said = signal.Signals(-code).name if code < 0 else {_WRONG: "another answer"}.get(code, f"exit code {code}")
        return Outcome("fault", f"{chosen}: {said}")
    return Outcome("refused" if code == _AGAIN else "answered")


def _load(store: Path, answer: bytes) -> None:
    code = 1
    try:
        os.environ["INERTIA_CACHE"] = str(store)
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            same = _answer() == answer
        again = any(issubclass(warning.category, CacheWarning) for warning in told)
        code = (_AGAIN if again else _SAME) if same else _WRONG
    finally:
        os._exit(code)
