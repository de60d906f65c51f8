"""The rows of a trade: what was measured, and what was not."""

from __future__ import annotations

from dataclasses import dataclass

from inertia.mass.properties import MassProperties
from inertia.mass.triangles.arithmetic import Arithmetic
from inertia.work_precision.compare import Relative
from inertia.work_precision.stopwatch import Timing


@dataclass(frozen=True)
class Simplification:
    """How a simpler mesh was made.

    Attributes
    ----------
    share : the power of two nearest to how many times fewer triangles it has than the whole mesh
    tolerance : m; what the simplification was allowed, see `inertia.mesh.repairs.simplify`
    seconds : what making it took, with the meshes that it was made from
    """

    share: int
    tolerance: float
    seconds: float


@dataclass(frozen=True, eq=False)
class Row:
    """One method over one mesh.

    Attributes
    ----------
    method : the arithmetic
    triangles : of the mesh
    simplification : None for the whole mesh
    time : of the integration alone
    properties : the result
    error : distance of the result from the reference; None where the row is the reference and not exact itself
    bound : certified, on the arithmetic error for this mesh
    reached : what the row can be relied on for: the worst bound over the whole mesh, the worst error over a simpler one
    """

    method: Arithmetic
    triangles: int
    simplification: Simplification | None
    time: Timing
    properties: MassProperties
    error: Relative | None
    bound: Relative
    reached: float

    @property
    def mesh(self) -> str:
        """`"whole"`, or about which part of its triangles, as `"1/8"`."""
        return f"1/{self.simplification.share}" if self.simplification else "whole"


@dataclass(frozen=True)
class Skipped:
    """What was not measured, why, and the seconds that it is estimated to take (None where time is not the reason)."""

    what: str
    why: str
    seconds: float | None = None
