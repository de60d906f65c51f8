"""Random solids whose volumes have to add up: V(A ∪ B) + V(A ∩ B) = V(A) + V(B), V(A \\ B) + V(A ∩ B) = V(A).

``python -m tests.benchmarks.shapes.random_solids 250`` takes 250 pairs of either kind, 2,250 solids: two primitives,
known in closed form, or something made of splines and a primitive, where A is also moved.
"""

import math
import random
import sys
from typing import Any

from inertia.errors import GeometryError
from inertia.mass.shapes.solids import solid_moments

from . import kernel as k


def integrated(solid: Any, accuracy: float = 1e-12) -> tuple[float, float]:
    """The volume and its bound."""
    shape = k.taken_over(solid)
    answers = [solid_moments(one, shape.tolerances, accuracy).moments for one in shape.solids]
    return float(sum(one.zeroth for one in answers)), float(sum(one.zeroth_bound for one in answers))


def primitive(draw: random.Random) -> tuple[Any, float]:
    """A box, cylinder, frustum, ball or torus, placed anyhow, and its volume."""
    a, b, c = draw.uniform(0.3, 2), draw.uniform(0.5, 4), draw.uniform(0.3, 2)
    solid, volume = draw.choice(
        [
            lambda: (k.box((2 * a, b, 2 * c), (-a, -b / 2, -c)), 4 * a * b * c),
            lambda: (k.cylinder(a, b, (0, 0, -b / 2)), math.pi * a * a * b),
            lambda: (k.cone(a, c, b, (0, 0, -b / 2)), math.pi * b / 3 * (a * a + a * c + c * c)),
            lambda: (k.sphere(a), 4 / 3 * math.pi * a**3),
            lambda: (k.torus(a + c, 0.9 * a), 2 * math.pi**2 * (a + c) * 0.81 * a * a),
        ]
    )()
    shift = [draw.uniform(-1.5, 1.5) for _ in range(3)]
    return k.moved(solid, shift, [draw.gauss(0, 1) for _ in range(3)], draw.uniform(0, 6)), volume


def curved(draw: random.Random) -> Any:
    """A loft, an extruded or revolved spline, a rounded box or extrusion, or a primitive as rational splines."""
    a, b, c = draw.uniform(0.5, 2), draw.uniform(1, 3), draw.uniform(0.05, 0.3)
    square = k.polygon([(1, 1, 0), (-1, 1, 0), (-1, -1, 0), (1, -1, 0)])
    return draw.choice(
        [
            lambda: k.lofted([k.ring(a, 0.0), k.ring(draw.uniform(0.5, 2), b, c), k.ring(1.5, 2 * b)]),
            lambda: k.lofted([square, k.ring(a, b)]),
            lambda: k.filleted(k.box((a + 1, b, 2), (-1, -1, -1)), c),
            lambda: k.extruded(k.wavy(draw.randint(2, 7), c), (c, -c, b)),
            lambda: k.filleted(k.extruded(k.wavy(draw.randint(2, 7), c), (0, 0, b)), 0.1),
            lambda: k.revolved(k.wavy(draw.randint(2, 7), c), (a + 2.5, 0, 0), (0, 1, 0), 2 * b),
            lambda: k.nurbs(primitive(draw)[0]),
        ]
    )()


def of_primitives(seed: int) -> list[tuple[float, float]]:
    """Errors and bounds: of both primitives, and of what they unite and share."""
    draw = random.Random(seed)
    (a, of_a), (b, of_b) = primitive(draw), primitive(draw)
    own, other, united, shared, rest = map(integrated, (a, b, k.fused(a, b), k.common(a, b), k.cut(a, b)))
    least = 1e-15 * (of_a + of_b)  # of the closed forms
    return [
        (abs(own[0] - of_a), own[1] + least),
        (abs(other[0] - of_b), other[1] + least),
        (abs(united[0] + shared[0] - of_a - of_b), united[1] + shared[1] + least),
        (abs(rest[0] + shared[0] - of_a), rest[1] + shared[1] + least),
    ]


def of_splines(seed: int) -> list[tuple[float, float]]:
    """Errors and bounds: of what is cut off and left, and of the solid moved."""
    draw = random.Random(seed)
    a, (b, _) = curved(draw), primitive(draw)
    whole, shared, rest = map(integrated, (a, k.common(a, b), k.cut(a, b)))
    moved = integrated(k.moved(a, (30, 40, 50), (1, 2, 3), 0.7))
    return [
        (abs(shared[0] + rest[0] - whole[0]), shared[1] + rest[1] + whole[1]),
        (abs(moved[0] - whole[0]), moved[1] + whole[1]),
    ]


def main(count: int) -> None:
    """Print how many errors are within their bounds."""
    for pairs in (of_primitives, of_splines):
        within, beyond, refused, ratio = 0, 0, 0, 0.0
        for seed in range(count):
            try:
                results = pairs(seed)
            except GeometryError as fault:
                refused += 1
                print(f"{pairs.__name__}({seed}): {fault}")
                continue
            for error, bound in results:
                within, beyond = within + (error <= bound), beyond + (error > bound)
                ratio = max(ratio, error / bound)
                if error > bound:
                    print(f"{pairs.__name__}({seed}): {error:.2e} is above {bound:.2e}")
        print(f"{pairs.__name__}: {within} errors within their bounds, the largest by {ratio:.2g} of it; ", end="")
        print(f"{beyond} beyond, {refused} pairs refused")


if __name__ == "__main__":
    main(int(sys.argv[1]))
