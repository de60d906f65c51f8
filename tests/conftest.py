"""What every test stands on: a cache of compiled kernels that lives as long as the session."""

import os
import tempfile

import pytest


def pytest_configure(config: pytest.Config) -> None:
    """Keep the machine code of this session's kernels apart from the user's (doctests included)."""
    folder = tempfile.TemporaryDirectory(prefix="inertia-cache-")
    config.add_cleanup(folder.cleanup)
    os.environ["INERTIA_CACHE"] = folder.name
