"""Types that signatures share: arrays by their entries, progress, how windings are read; and scipy's rotations."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Bool = NDArray[np.bool_]


def of_rotation(value: Any, size: int) -> Any:
    """Return what a `Rotation` of scipy stands for, and anything else as it is.

    Parameters
    ----------
    size : of the last axis that is asked for: 4 for quaternions, scalar last, 3 for matrices
    """
    if hasattr(value, "as_quat") and size in (3, 4):
        return value.as_quat() if size == 4 else value.as_matrix()
    return value


Progress = Callable[[float], None]
"""Called with the fraction of the work that is done, from 0 to 1."""

Orientation = Literal["stored", "absolute"]
"""Whether the sign of a shell's volume follows from the winding of its triangles, or from how shells are nested."""

Parts = Literal["together", "separate"]
"""Whether the bodies of a part are one solid, in which nothing may count twice, or each is integrated by itself."""
