"""Print the table of docs/shapes.md: errors of volumes, and times."""

import sys
import time
from collections.abc import Callable
from typing import TypeVar

from inertia.mass.shapes.solids import solid_moments

from .kernel import facets, gprops, meshed, taken_over
from .solids import SAMPLES

T = TypeVar("T")


def main() -> None:
    """Measure the solids whose names have one of the words of the command line in them, or all."""
    print("| solid | faces | triangles | own faces | bound | GProps | ms: triangles | own faces | GProps |")
    print("|---|---|---|---|---|---|---|---|---|")
    for sample in SAMPLES:
        if len(sys.argv) > 1 and not any(word in sample.name for word in sys.argv[1:]):
            continue
        solid = sample.make()
        shape = taken_over(solid)
        answers, own = _timed(lambda: [solid_moments(one, shape.tolerances, 1e-10) for one in shape.solids])  # noqa: B023
        volume = float(sum(answer.moments.zeroth for answer in answers))
        bound = float(sum(answer.moments.zeroth_bound for answer in answers)) / volume
        kernel, theirs = _timed(lambda: gprops(solid))  # noqa: B023
        triangles, meshing = _timed(lambda: meshed(solid), once=True)  # noqa: B023
        mesh = facets(triangles)
        truth = volume if sample.volume is None else sample.volume()
        error = f"{abs(volume / truth - 1):.1e}" if sample.volume else "·"
        faces = sum(len(one.faces) for one in shape.solids)
        print(
            f"| {sample.name} | {faces} | {abs(mesh / truth - 1):.1e} | {error} | {bound:.1e} | "
            f"{abs(kernel / truth - 1):.1e} | {meshing:.1f} | {own:.1f} | {theirs:.1f} |",
            flush=True,
        )


def _timed(work: Callable[[], T], once: bool = False) -> tuple[T, float]:
    """Return a result and the least of three times, ms."""
    times = []
    for _ in range(1 if once else 3):
        start = time.perf_counter()
        result = work()
        times.append(1e3 * (time.perf_counter() - start))
    return result, min(times)


main()
