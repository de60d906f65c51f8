"""The rows of a work-precision measurement: time against error, what was skipped, and the Pareto front."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Generic, TypeVar

from inertia.mass.properties import MassProperties
from inertia.records import dataclass
from inertia.work_precision.stopwatch import Timing


@dataclass(frozen=True, eq=False)
class Row:
    """One method, measured.

    Attributes
    ----------
    method : the arithmetic of an integration; that of a motion, of which a closed form says which
    time : of the integration alone; of the whole simulation, with the estimate of its error
    reached : the error that the row can be relied on for: relative for a part, rad for a scene
    """

    method: str
    time: Timing
    reached: float


R = TypeVar("R", bound=Row)


@dataclass(frozen=True)
class Relative:
    """Relative errors, or bounds on them.

    The centre of mass counts relative to the size of the part (its largest extent), the tensor in the Frobenius norm.
    """

    volume: float
    center_of_mass: float
    inertia: float

    @property
    def worst(self) -> float:
        """The largest of the three."""
        return max(self.volume, self.center_of_mass, self.inertia)


@dataclass(frozen=True)
class Simplification:
    """How a simpler mesh was made.

    Attributes
    ----------
    share : the power of two nearest to how many times fewer triangles it has than the whole mesh
    tolerance : m; what the simplification was allowed, see `inertia.halvings`
    seconds : what making it took, with the meshes that it was made from
    """

    share: int
    tolerance: float
    seconds: float


@dataclass(frozen=True, eq=False)
class PartRow(Row):
    """One method over one mesh.

    `reached` is the worst bound over the whole mesh, the worst error over a simpler one.

    Attributes
    ----------
    triangles : of the mesh
    simplification : None for the whole mesh
    properties : the result
    error : distance of the result from the reference; None where the row is the reference and not exact itself
    bound : certified, on the arithmetic error for this mesh
    """

    triangles: int
    simplification: Simplification | None
    properties: MassProperties
    error: Relative | None
    bound: Relative

    @property
    def mesh(self) -> str:
        """`"whole"`, or about which part of its triangles, as `"1/8"`."""
        return f"1/{self.simplification.share}" if self.simplification else "whole"


@dataclass(frozen=True, eq=False)
class SceneRow(Row):
    """One run of a scene.

    `reached` is the error and the doubt about the reference.

    Attributes
    ----------
    model : that ran
    asked : rad, the accuracies that all give this very run, the coarsest first
    planned : whether the planner selects it for these
    steps : that were taken; 0 for a closed form
    estimate : rad, what the run itself says of its error
    error : rad, the largest angle to the reference over the samples; None where the row is the reference
    """

    model: str
    asked: tuple[float, ...]
    planned: bool
    steps: int
    estimate: float
    error: float | None


@dataclass(frozen=True)
class Skipped:
    """What was not measured, why, and the seconds that it is estimated to take (None where time is not the reason)."""

    what: str
    why: str
    seconds: float | None = None


@dataclass(frozen=True, eq=False)
class Measurement(Generic[R]):
    """The rows, the one of them that errors are measured against, what was skipped, and times of other steps."""

    rows: tuple[R, ...]
    reference: R
    skipped: tuple[Skipped, ...]
    steps: Mapping[str, Timing] = field(default_factory=dict)


def front(rows: Sequence[R]) -> list[R]:
    """Return the rows on the Pareto front, the fastest first: no other row is as fast and reaches as much."""
    best: list[R] = []
    for row in sorted(rows, key=lambda row: (row.time.median, row.reached)):
        if not best or row.reached < best[-1].reached:
            best.append(row)
    return best
