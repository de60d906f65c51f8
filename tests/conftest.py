"""What every test stands on: a cache of compiled kernels for the session, and generated examples that can be repeated.

The examples are the same in every run, so that a gate that has passed passes again; where `INERTIA_FUZZ` is set they
are drawn anew.
"""

import os
import tempfile

import pytest
from hypothesis import settings

settings.register_profile("gate", derandomize="INERTIA_FUZZ" not in os.environ)
settings.load_profile("gate")


def pytest_configure(config: pytest.Config) -> None:
    """Keep the machine code of this session's kernels apart from the user's (doctests included)."""
    if "PYTEST_XDIST_WORKER" in os.environ:
        return  # that of the process that began them
    folder = tempfile.TemporaryDirectory(prefix="inertia-cache-")
    config.add_cleanup(folder.cleanup)
    os.environ["INERTIA_CACHE"] = folder.name
