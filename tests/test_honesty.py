"""A short form of the campaign of `tests.benchmarks.honesty`: no error exceeds its claim."""

import numpy as np
import pytest

pytest.importorskip("heyoka", reason="the truth is integrated by heyoka")

from tests.benchmarks.honesty import judge as judging
from tests.benchmarks.honesty.page import summary
from tests.benchmarks.honesty.rigid import Truth
from tests.benchmarks.honesty.scenes import KINDS, Case, case
from tests.dynamics import oracle

from inertia import Scene
from inertia.arrays import Float

SLOW = "functions", "rolling", "stiff", "deforming", "orbiting", "sliding", "tables", "methods", "extreme"


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in SLOW])
def test_the_claim_holds(kind: str) -> None:
    verdicts = [judging.judge(case(kind, 0, number)) for number in range(2)]
    assert summary(verdicts)["exceeded"] == 0
    assert {each.outcome for each in verdicts} <= {"held", "refused", "undecided"}


@pytest.mark.parametrize("number", [6011, 2029, 10762])
def test_what_moments_about_a_far_point_are_rounded_by_is_in_the_claim(number: int) -> None:
    """Those across the arm, 82 to 2e5 lengths of the body, are up to 1e11 times the smallest."""
    assert judging.judge(case("nearly", 1, number)).outcome == "held"


def test_a_claim_that_does_not_hold_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    one = case("free", 0, 0)
    honest = judging.judge(one)
    assert honest.outcome == "held"
    true = judging.truth_of

    def a_little_later(case: Case, scene: Scene, times: Float) -> Truth:
        return true(case, scene, times * (1.0 + 1e-9))

    monkeypatch.setattr(judging, "truth_of", a_little_later)
    assert judging.judge(one).outcome == "exceeded"


def test_the_truth_agrees_with_series_in_integers() -> None:
    moments, spin, attitude = [1.0, 2.0, 2.75], [1.0, 0.5, 2.0], [0.1, -0.3, 0.5, 0.8]
    attitude = (np.array(attitude) / np.linalg.norm(attitude)).tolist()
    scene = {
        "body": {"principal_moments": moments},
        "start": {"angular_velocity": spin, "attitude": attitude},
        "load": [
            {"kind": "torque", "torque": [1.0, 0.25, 0.3], "frame": "space"},
            {"kind": "torque", "torque": [0.1, -0.2, 0.0]},
            {"kind": "damping", "coefficient": 0.1},
        ],
        "run": {"duration": 5.0},
    }
    times = np.array([0.0, 2.5, 5.0])
    truth = judging.rigid.follow(scene, judging.rigid.body_of(scene["body"], np.eye(3)), times)
    series = oracle.rotate(
        moments,
        spin,
        times.tolist(),
        attitude=attitude,
        space_torque=(1.0, 0.25, 0.3),
        body_torque=(0.1, -0.2, 0.0),
        damping=0.1,
    )
    assert truth.error.max() < 1e-26
    assert series.error < 1e-26
    assert truth.off(series.attitude.astype(float)).max() < 4e-16
