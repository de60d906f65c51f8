"""Jobs whose rotor was turned on its tooling, V = A (T + e^{iθ} (R + w)), on machines whose R and T are known."""

import cmath
import math

import numpy as np
import pytest

from inertia import UsageError
from inertia.balancing.measured.job import Job
from inertia.balancing.measured.measure import measure


def job_of(matrix, rotor, tooling, runs, *, angles="with rotation", stated=(0.0, 0.0), **more):
    """A job of runs (degrees turned, [(plane, g at 100 mm, degrees, stays)])."""
    kept, entries = np.zeros(len(rotor), complex), []
    for number, (turn, weights) in enumerate(runs):
        mounted = kept.copy()
        for plane, mass, angle, stays in weights:
            mounted[plane] += cmath.rect(100 * mass, math.radians(angle))
            kept[plane] += stays * cmath.rect(100 * mass, math.radians(angle))
        shown = np.asarray(matrix) @ (tooling + np.exp(1j * math.radians(turn)) * (rotor + mounted))
        shown = shown if angles == "with rotation" else shown.conj()
        readings = [
            {"sensor": f"S{k}", "amplitude": abs(v), "phase": math.degrees(cmath.phase(v)) % 360}
            for k, v in enumerate(shown.tolist())
        ]
        weights = [{"plane": f"P{p}", "mass_g": m, "angle": a, "stays": s} for p, m, a, s in weights]
        entries.append({"id": str(number), "indexed": turn, "weights": weights, "readings": readings})
    return Job.from_dict(
        {
            "rpm": 1500,
            "conventions": {"angles": angles, "phase": "lead"},
            "uncertainty": {"amplitude": stated[0], "phase": stated[1], "mass": 0, "angle": 0},
            "sensor": [{"id": f"S{k}", "unit": "mm/s"} for k in range(len(matrix))],
            "plane": [{"id": f"P{k}", "radius": 100} | more for k in range(len(rotor))],
            "run": entries,
        }
    )


TRIAL = [(0, []), (0, [(0, 5.0, 0.0, False)]), (180, [])]


def test_trial_runs_and_turned_runs_of_one_job_give_the_rotor():
    # R = 300 g·mm at 0°, T = 150 g·mm at 90°: the runs show T + R, T + R + 500 and T − R.
    result = measure(job_of([[0.01 * cmath.exp(-0.5j)]], np.array([300 + 0j]), 150j, TRIAL, permissible_gmm=200))
    assert 1e6 * result.planes[0].unbalance == pytest.approx(300, rel=1e-9)
    assert 1e6 * result.estimate.tooling == pytest.approx([150j], rel=1e-9)
    assert (result.outcome, result.notes) == ("fail", ())


@pytest.mark.parametrize("angles", ["with rotation", "against rotation"])
@pytest.mark.parametrize("channels", [2, 4])
@pytest.mark.parametrize("turns", [(180,), (90, 180, 270), (120,), (0, 180, 0)])
def test_rotor_and_tooling_are_recovered_in_every_sense_with_weights_that_stay(angles, channels, turns):
    random = np.random.default_rng(4)
    matrix = 1e-2 * (random.normal(size=(channels, 2)) + 1j * random.normal(size=(channels, 2)))
    rotor, tooling = (size * (random.normal(size=2) + 1j * random.normal(size=2)) for size in (300, 150))
    runs = [(0, []), (0, [(0, 5.0, 30.0, False)]), (0, [(1, 4.0, 200.0, True)]), *((turn, []) for turn in turns)]
    result = measure(job_of(matrix, rotor, tooling, runs, angles=angles))
    kept = np.array([0, cmath.rect(400, math.radians(200))])
    assert [1e6 * plane.unbalance for plane in result.planes] == pytest.approx(rotor + kept, rel=1e-9)
    assert 1e6 * result.estimate.tooling == pytest.approx(tooling, rel=1e-8)
    for run in result.runs:
        assert run.predicted is None or run.predicted == pytest.approx(run.readings, rel=1e-9)
    assert result.runs[-1].predicted is not None or 0 not in turns
    assert not any("contradict" in note for note in result.notes)


def test_a_trial_weight_may_be_in_a_turned_run():
    runs = [(0, []), (180, []), (180, [(0, 5.0, 40.0, False)])]
    (plane,) = measure(job_of([[0.02j]], np.array([70 + 20j]), 40 - 9j, runs)).planes
    assert 1e6 * plane.unbalance == pytest.approx(70 + 20j, rel=1e-9)


def test_the_stated_uncertainty_is_that_of_draws():
    # R̂ = w (V₀ − V₂)/(2 (V₁ − V₀)), of readings that are off by up to 2 % and as much across.
    off, rotor, tooling = 0.02, 300.0, 150j
    (plane,) = measure(job_of([[0.01]], np.array([rotor + 0j]), tooling, TRIAL, stated=(off, math.degrees(off)))).planes
    random = np.random.default_rng(1)
    first, trial, turned = (
        (tooling + each)
        * (1 + off * random.uniform(-1, 1, 200_000))
        * np.exp(1j * off * random.uniform(-1, 1, 200_000))
        for each in (rotor, rotor + 500, -rotor)
    )
    drawn = 500 * (first - turned) / (2 * (trial - first))
    within = np.percentile(np.abs(np.abs(drawn) - rotor), 95)
    largest = 2 * math.sqrt(np.linalg.eigvalsh(np.cov(drawn.real, drawn.imag))[-1])
    assert 0.97 * within <= largest <= 1e6 * plane.expanded <= 1.2 * largest


@pytest.mark.parametrize(("factor", "outcome"), [(1.0, "pass"), (1.3, "undecided")])
def test_positions_that_contradict_each_other_are_named(factor, outcome):
    runs = [*TRIAL[:2], *((turn, []) for turn in (90, 180, 270))]
    table = job_of([[0.01]], np.array([100 + 0j]), 150j, runs, stated=(0.01, 0.5), permissible_gmm=200).to_dict()
    table["run"][3]["readings"][0]["amplitude"] *= factor
    result = measure(Job.from_dict(table))
    assert result.outcome == outcome
    assert any("the runs contradict each other" in note for note in result.notes) == (factor != 1.0)


def test_runs_that_cannot_tell_rotor_tooling_and_weight_apart_are_refused():
    job = job_of([[0.01]], np.array([100 + 0j]), 150j, [(0, []), (180, [(0, 5.0, 0.0, False)])])
    with pytest.raises(UsageError, match=r"2 runs, which have to tell rotor and tooling apart too, cannot tell what"):
        measure(job)


def test_without_phase_no_run_is_turned():
    table = job_of([[0.01]], np.array([100 + 0j]), 0, TRIAL).to_dict() | {"method": "without phase"}
    with pytest.raises(UsageError, match=r'run\[2\].indexed goes with phases, not with "without phase": leave it out'):
        Job.from_dict(table)
