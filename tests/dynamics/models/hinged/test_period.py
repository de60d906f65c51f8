"""How long a body on an axle takes to come back, near its unstable rests too, against quadruple precision."""

from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from tests.dynamics.models.hinged.hinged_oracle import angle_of

import inertia
from inertia.dynamics.models.hinged.period import Recurrence, recurrence
from inertia.dynamics.run import Run
from inertia.report.run.text import run_text

WELLS: dict[str, Any] = {
    "body": {
        "principal_moments": [1.0, 1.0, 1.0],
        "mass": 1.0,
        "center_of_mass": [0.8414709848078965, 0.0, 0.5403023058681398],
    },
    "constraint": {"kind": "hinge", "axis": [0, 1, 0], "stiffness": 5.0, "rest_angle": -1.0},
    "load": [{"kind": "gravity", "acceleration": [0, 0, -9.81]}],
}


def on_axle(spin: float, scene: dict[str, Any], duration: float = 0.1, accuracy: float = 1e-10) -> Run:
    """Run a body on an axle along y."""
    start = {"angular_velocity": [0, spin, 0], "frame": "part"}
    run = {"duration": duration, "samples": 2, "accuracy": accuracy}
    return inertia.simulate(inertia.Scene.from_dict({**scene, "start": start, "run": run}))


def figures(inertia: float, spin: float, torque: float, stiffness: float, cosine: float, sine: float) -> dict:
    names = "inertia", "spin", "torque", "stiffness", "cosine", "sine"
    each = dict(zip(names, map(Fraction, (inertia, spin, torque, stiffness, cosine, sine)), strict=True))
    return {**each, "damping": Fraction(0)}


def later(known: dict[str, Fraction], period: float) -> float:
    """Return θ after a period, to what δT ω is of the period: relative error of the period."""
    with mpmath.workdps(45):
        of = {name: mpmath.mpf(value.numerator) / value.denominator for name, value in known.items()}
        weight, tilt = mpmath.hypot(of["cosine"], of["sine"]), mpmath.atan2(of["cosine"], of["sine"])
        named = {"I": of["inertia"], "N": of["torque"], "c": 0, "k": of["stiffness"], "W": weight, "φ": tilt}
        return float(angle_of(named, of["spin"], period, 40) / (of["spin"] * period))


@pytest.mark.parametrize(
    "spin", [1.41761573405262, 1.41764, 1.41765, 1.41766, 1.41774, 1.41777, 1.41784, 1.4, 1.3, 5.0]
)
def test_the_period_is_stated_on_either_side_of_a_barrier_and_right_to_the_last_digits(spin: float) -> None:
    """Just under it the turning angle, and well over it the sum, were off where F was a difference in float64."""
    run = on_axle(spin, WELLS, accuracy=1e-5)
    x, z = (Fraction(WELLS["body"]["center_of_mass"][k]) for k in (0, 2))
    known = figures(0.0, spin, -5.0, 5.0, 0.0, 0.0)
    known |= {"inertia": 1 + x * x + z * z, "cosine": Fraction(9.81) * x, "sine": Fraction(9.81) * z}
    assert abs(later(known, float(run.quantities["period"]))) < 2e-15
    assert run.remarks == ("It swings to and fro between its turning angles.",)


@pytest.mark.parametrize("over", [1.0, -1.0], ids=["over", "under"])
@pytest.mark.parametrize("nearness", [1e-3, 1e-6, 1e-9, 1e-12, 1e-15])
@pytest.mark.parametrize("seed", range(3))
def test_the_period_keeps_its_digits_however_near_it_passes_an_unstable_rest(
    seed: int, nearness: float, over: float
) -> None:
    random = np.random.default_rng(seed)
    low = -1.0
    while low <= 0:  # an unstable rest at `top`, that takes an energy to reach
        moment, a, b = 10 ** random.uniform(-1, 1), *random.normal(size=2)
        stiffness = 10 ** random.uniform(-1, -0.1) * np.hypot(a, b)
        top = random.uniform(-4, 4)
        bend = -stiffness - a * np.sin(top) + b * np.cos(top)
        torque = stiffness * top - a * np.cos(top) - b * np.sin(top)
        rise = torque * top - stiffness * top**2 / 2 + a * np.sin(top) + b * (1 - np.cos(top))
        low = -rise if bend > 0.05 * stiffness else -1.0
    known = figures(moment, np.sqrt(2 * low / moment * (1 + over * nearness)), torque, stiffness, a, b)
    back = recurrence(known)
    assert back is not None
    assert back.period is not None
    assert abs(later(known, back.period)) < 5e-15


def beside_its_top(share: str) -> Recurrence | None:
    """Follow F(θ) = ω² − θ − θ² + 4 (1 − cos θ), with a top near θ = ½, past which ω² leads by a share."""
    with mpmath.workdps(60):
        rest = mpmath.findroot(lambda x: -0.5 - x + 2 * mpmath.sin(x), 0.5)
        square = (rest + rest**2 - 4 * (1 - mpmath.cos(rest))) * (1 + mpmath.mpf(share))
        spin = Fraction(str(mpmath.sqrt(square)))
    return recurrence(figures(1.0, 0.0, -0.5, 1.0, 0.0, 2.0) | {"spin": spin})


@pytest.mark.parametrize("share", ["1e-14", "-1e-12"])
def test_what_passes_a_top_by_far_less_than_float64_has_a_period(share: str) -> None:
    back = beside_its_top(share)
    assert back is not None
    assert back.period is not None


@pytest.mark.parametrize("share", ["1e-23", "-1e-23"])
def test_where_only_the_period_is_lost_in_rounding_a_remark_says_so(share: str) -> None:
    back = beside_its_top(share)
    assert back is not None
    assert list(back.quantities) == ["turning angle"]
    assert back.remark.endswith("so near an unstable rest that its period is not stated.")


def test_where_nothing_tells_whether_it_passes_a_top_nothing_is_stated() -> None:
    for back in (beside_its_top("1e-40"), recurrence(figures(1.0, 0.0, 1e-40, 1.0, 0.0, 2.0))):
        assert back == Recurrence(None)
        assert back.quantities == {}
        assert back.remark.endswith("no period is stated.")


@pytest.mark.parametrize("stiffness", [0.0, 1e-30])
@pytest.mark.parametrize("spin", [1e-3, 1e-6, 1e-9, 1e-12, 1e-15])
def test_a_small_swing_has_turning_angles_with_all_their_digits(spin: float, stiffness: float) -> None:
    """sin ½α = ω/2ω₀, ω₀² = m g l/I = 9/2."""
    body = {"principal_moments": [1.0] * 3, "mass": 1.0, "center_of_mass": [0, 0, -1]}
    load = [{"kind": "gravity", "acceleration": [0, 0, -9]}]
    run = on_axle(
        spin, {"body": body, "load": load, "constraint": {"kind": "hinge", "axis": [0, 1, 0], "stiffness": stiffness}}
    )
    reach = 2.0 * np.arcsin(0.5 * spin / np.sqrt(4.5))
    assert run.quantities["turning angle"] == pytest.approx([-reach, reach], rel=1e-15)


def test_the_period_of_the_separatrix_is_infinite_in_words() -> None:
    body = {"principal_moments": [1.0] * 3, "mass": 1.0, "center_of_mass": [0, 0, -1]}
    load = [{"kind": "gravity", "acceleration": [0.0, 0.0, -8.0]}]
    text = run_text(on_axle(4.0, {"body": body, "load": load, "constraint": {"kind": "hinge", "axis": [0, 1, 0]}}))
    assert [line.split() for line in text.splitlines() if line.startswith("Period")] == [["Period", "infinite"]]


@pytest.mark.parametrize("damping", [0.0, 0.5, 5e3])
@pytest.mark.parametrize("exponent", [-80, -45, -31, 33, 47, 53, 83, 96])
def test_the_angle_does_not_depend_on_what_a_second_is(exponent: int, damping: float) -> None:
    """Nothing is out of the order of 1 in units of the motion."""

    def angle(second: float) -> float:
        table = {
            "body": {"principal_moments": [1.0] * 3, "mass": 1.0, "center_of_mass": [0.5, 0, 0]},
            "constraint": {"kind": "hinge", "axis": [0, 1, 0], "stiffness": 2.0 / second**2},
            "load": [
                {"kind": "gravity", "acceleration": [0, 0, -9.0 / second**2]},
                {"kind": "damping", "coefficient": damping / second},
            ],
        }
        return float(on_axle(1.0 / second, table, 3.0 * second).quantities["angle"][-1])

    assert angle(2.0**exponent) == pytest.approx(angle(1.0), rel=1e-14)
