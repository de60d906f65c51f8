"""Where loaded motions end after so many revolutions that the oracle in integers takes too long.

heyoka's Taylor method in quadruple precision, some 33 digits, at its tightest tolerance; each motion is first compared
with the integers after ten revolutions. The ends are kept in truths.json; `python -m tests.benchmarks.motion.truths`
makes them anew (twenty minutes).
"""

from __future__ import annotations

import json
import sys
from typing import Any

import mpmath as mp
import numpy as np

from .peers import equations
from .scenes import EXACT, MOTIONS, TRUTHS, Motion, end

AGREED = 1e-31


def main() -> None:
    """Make the file."""
    result: dict[str, dict[str, list[str]]] = {}
    for motion in MOTIONS:
        if motion.free:
            continue
        with mp.workdps(50):
            apart = max(abs(mp.mpf(a) - b) for a, b in zip(_end(motion, EXACT), end(motion, EXACT), strict=True))
        if apart > AGREED:
            raise SystemExit(f"{motion.name}: quadruple precision and integers are {float(apart):.2g} apart")
        later = [revolutions for revolutions in motion.revolutions if revolutions > EXACT]
        result[motion.name] = {str(revolutions): _end(motion, revolutions) for revolutions in later}
        print(f"{motion.name}: {float(apart):.1e} from the integers after {EXACT} revolutions", file=sys.stderr)
    TRUTHS.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


def _end(motion: Motion, revolutions: int) -> list[str]:
    import heyoka

    quad = heyoka.real128
    state = np.array([quad(x) for x in (0.0, 0.0, 0.0, 1.0, *motion.spin)])
    system = equations(motion, lambda x: heyoka.expression(quad(x)))
    stepper: Any = heyoka.taylor_adaptive(system, state, fp_type=quad, compact_mode=True)
    stepper.propagate_until(quad(motion.duration(revolutions)))
    return [str(x) for x in stepper.state[:4]]


if __name__ == "__main__":
    main()
