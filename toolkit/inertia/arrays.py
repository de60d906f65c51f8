"""Types that signatures share: arrays by the kind of their entries, reports of progress, how windings are read."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Bool = NDArray[np.bool_]

Progress = Callable[[float], None]
"""Called with the fraction of the work that is done, from 0 to 1."""

Orientation = Literal["stored", "absolute"]
"""Whether the sign of a shell's volume follows from the winding of its triangles, or from how shells are nested."""

Parts = Literal["together", "separate"]
"""Whether the bodies of a part are one solid, in which nothing may count twice, or each is integrated by itself."""
