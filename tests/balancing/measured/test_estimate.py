"""The stated uncertainty of a measured unbalance where trial weights are small: against machines of our own."""

import contextlib
import json
import math
from itertools import pairwise

import numpy as np
import pytest

from inertia import GeometryError, UsageError
from inertia.balancing.balance import balance
from inertia.balancing.bounds import measured
from inertia.balancing.measured.estimate import estimate
from inertia.balancing.measured.job import Job
from inertia.balancing.measured.measure import measure
from inertia.balancing.rotor import Rotor
from inertia.balancing.unbalance import plane_weights
from inertia.report.measurement.document import measurement_document
from inertia.report.measurement.html import certificate_html
from inertia.report.measurement.text import measurement_text
from inertia_meshes import path

SIZE = 500.0  # g mm, of the unbalance in every plane
OFF = 0.02  # half-width of readings, as a part of them and rad, which is what is stated


def job_of(matrix, unbalance, trials, random=None, **more):
    """A job with one trial (g at 100 mm) a plane; readings with noise, evenly spread, or exact ones."""
    planes = len(unbalance)
    runs = []
    for k, mass in enumerate([0.0, *trials]):
        mounted = np.zeros(planes, complex)
        weights = []
        if k:
            mounted[k - 1] = 100.0 * mass
            weights = [{"plane": f"P{k - 1}", "mass_g": mass, "angle": 0.0}]
        shown = matrix @ (unbalance + mounted)
        if random is not None:
            shown = shown * (1 + OFF * random.uniform(-1, 1, shown.shape))
            shown = shown * np.exp(1j * OFF * random.uniform(-1, 1, shown.shape))
        readings = [
            {"sensor": f"S{j}", "amplitude": abs(v), "phase": math.degrees(np.angle(v)) % 360}
            for j, v in enumerate(shown.tolist())
        ]
        runs.append({"id": str(k), "weights": weights, "readings": readings})
    return Job.from_dict(
        {
            "rpm": 1500,
            "conventions": {"angles": "with rotation", "phase": "lead"},
            "uncertainty": {"amplitude": OFF, "phase": math.degrees(OFF), "mass": 0.0, "angle": 0.0},
            "sensor": [{"id": f"S{j}", "unit": "mm/s"} for j in range(len(matrix))],
            "plane": [{"id": f"P{k}", "radius": 100} | more for k in range(planes)],
            "run": runs,
        }
    )


def machine(random, planes, channels):
    matrix = 1e-2 * (random.normal(size=(channels, planes)) + 1j * random.normal(size=(channels, planes)))
    return matrix, SIZE * np.exp(2j * np.pi * random.random(planes))


@pytest.mark.parametrize(("planes", "channels"), [(1, 1), (1, 3), (2, 2), (2, 4)])
@pytest.mark.parametrize("trial", [0.1, 0.02, 0.001])
def test_hopeless_trials_never_pass_nor_fail(planes, channels, trial):
    # The unbalance is 3.3 times one limit, and less than the other: neither may be said.
    random = np.random.default_rng([planes, channels])
    for _ in range(12):
        matrix, unbalance = machine(random, planes, channels)
        for limit in (SIZE / 3.3, 1.05 * SIZE):
            job = job_of(matrix, unbalance, [trial] * planes, random, permissible_gmm=limit)
            result = measure(job)
            assert result.outcome == "undecided"
            assert not any(plane.pieces for plane in result.planes)
            assert any("the readings do not bound the unbalance" in note for note in result.notes)


@pytest.mark.parametrize("trial", [0.3, 0.5, 1.0, 3.0, 10.0])
def test_what_passes_or_fails_by_a_small_trial_is_wrong_no_more_often_than_stated(trial):
    random = np.random.default_rng(5)
    wrong, judged = 0, 200
    for _ in range(judged):
        matrix, unbalance = machine(random, 1, 1)
        (plane,) = measure(job_of(matrix, unbalance, [trial], random)).planes
        size = 1e6 * abs(plane.unbalance)
        wrong += size + 1e6 * plane.expanded < SIZE or size - 1e6 * plane.expanded > SIZE
    assert wrong <= 0.05 * judged + 2 * math.sqrt(0.05 * 0.95 * judged)


def test_the_uncertainty_never_falls_as_trials_get_smaller():
    matrix, unbalance = machine(np.random.default_rng(3), 2, 2)
    stated = [
        [plane.expanded for plane in measure(job_of(matrix, unbalance, [trial, 8.0])).planes]
        for trial in (30.0, 10.0, 3.0, 1.0, 0.5, 0.3, 0.1, 0.05, 0.01, 0.001)
    ]
    for larger, smaller in pairwise(stated):
        assert all(after >= before for before, after in zip(larger, smaller, strict=True))
    assert math.isfinite(stated[0][0])
    assert math.isinf(stated[-1][0])


@pytest.mark.parametrize("trial", [10.0, 3.0, 1.5])
def test_the_uncertainty_is_that_of_draws_or_a_little_above(trial):
    random = np.random.default_rng(11)
    matrix, unbalance = np.array([[0.01 + 0.004j]]), np.array([SIZE * np.exp(1j)])
    (plane,) = measure(job_of(matrix, unbalance, [trial])).planes
    noise = [
        (1 + OFF * random.uniform(-1, 1, 100_000)) * np.exp(1j * OFF * random.uniform(-1, 1, 100_000)) for _ in "12"
    ]
    before = matrix[0, 0] * unbalance[0] * noise[0]
    after = matrix[0, 0] * (unbalance[0] + 100.0 * trial) * noise[1]
    drawn = before * 100.0 * trial / (after - before)
    off = np.percentile(np.abs(np.abs(drawn) - SIZE), 95)
    assert 0.97 * off <= 1e6 * plane.expanded <= 1.5 * off


@pytest.mark.parametrize(("unit", "size"), [("g.mm", 1.0), ("g·mm", 1.0), ("oz-in", 720.0779), ("oz*in", 720.0779)])
def test_stored_coefficients_are_per_unit_of_their_weights(unit, size, tmp_path):
    file = tmp_path / "coefficients.toml"
    file.write_text(
        f'weights = "{unit}"\n[[coefficient]]\nsensor = "S0"\nrpm = 1500\nplane = "P0"\nunit = "mm/s rms"\n'
        f"amplitude = {0.01 * size}\nphase = 0\n",
        encoding="utf-8",
    )
    table = job_of(np.array([[0.01 + 0j]]), np.array([20.0 + 0j]), []).to_dict() | {"coefficients": str(file)}
    assert 1e6 * measure(Job.from_dict(table)).planes[0].unbalance == pytest.approx(20.0, rel=1e-6)


def test_stored_coefficients_that_may_be_none_decide_nothing(tmp_path):
    matrix, unbalance = np.array([[0.01 + 0j]]), np.array([20.0 + 0j])
    for share, outcome in ((0.05, "pass"), (0.6, "undecided")):
        file = tmp_path / f"{share}.toml"
        file.write_text(
            'weights = "g.mm"\n[[coefficient]]\nsensor = "S0"\nrpm = 1500\nplane = "P0"\nunit = "mm/s rms"\n'
            f"amplitude = 0.01\nphase = 0\nuncertainty = {0.01 * share}\n",
            encoding="utf-8",
        )
        table = job_of(matrix, unbalance, [], permissible_gmm=40).to_dict()
        assert measure(Job.from_dict(table | {"coefficients": str(file)})).outcome == outcome


@pytest.mark.parametrize("angles", [(0, 90), (0, 120, 240)])
@pytest.mark.parametrize("trial", [0.02, 0.2])
def test_without_phase_hopeless_trials_decide_nothing(angles, trial):
    random = np.random.default_rng(8)
    for _ in range(6):
        runs = []
        for k, angle in enumerate([None, *angles]):
            weights = [] if angle is None else [{"plane": "P0", "mass_g": trial, "angle": angle}]
            mounted = 0j if angle is None else 100 * trial * np.exp(1j * math.radians(angle))
            size = 0.01 * abs(SIZE * np.exp(2j) + mounted) * (1 + OFF * random.uniform(-1, 1))
            runs.append({"id": str(k), "weights": weights, "readings": [{"sensor": "S0", "amplitude": size}]})
        table = job_of(np.array([[0.01]]), np.array([SIZE]), [], permissible_gmm=SIZE / 3.3).to_dict()
        table |= {"method": "without phase", "run": runs, "conventions": {"angles": "with rotation"}}
        outcome = "refused"
        with contextlib.suppress(GeometryError):  # no unbalance explains the amplitudes
            outcome = measure(Job.from_dict(table)).outcome
        assert outcome in ("undecided", "refused")


def spread_of(draws):
    """Twice the standard deviation of complex draws in the direction in which it is largest."""
    return 2 * math.sqrt(np.linalg.eigvalsh(np.cov(draws.real, draws.imag))[-1])


def off(random, size=200_000):
    return (1 + OFF * random.uniform(-1, 1, size)) * np.exp(1j * OFF * random.uniform(-1, 1, size))


def test_what_is_stated_of_readings_is_of_those_that_were_read_runout_and_all():
    # A runout of 10 µm at 90° beside 0.5 µm of 50 g·mm: 2 % of what is read are 20 g·mm.
    runout, unbalance = 10j, 50 * np.exp(0.7j)
    table = job_of(np.array([[0.01 + 0j]]), np.array([unbalance]), [5.0], permissible_gmm=60).to_dict()
    table["sensor"][0]["runout"] = {"amplitude": 10, "phase": 90}
    exact = [0.01 * unbalance + runout, 0.01 * (unbalance + 500) + runout]
    for run, shown in zip(table["run"], exact, strict=True):
        run["readings"][0] |= {"amplitude": abs(shown), "phase": math.degrees(np.angle(shown))}
    result = measure(Job.from_dict(table | {"tolerance": {"vibration": 0.6}}))
    random = np.random.default_rng(0)
    taken = runout * off(random)
    first, trial = (shown * off(random) - taken for shown in exact)
    (plane,) = result.planes
    assert 1e6 * plane.unbalance == pytest.approx(unbalance)
    drawn = spread_of(500 * first / (trial - first))
    assert 0.98 * drawn <= 1e6 * plane.expanded <= 1.1 * drawn
    assert 2 * result.estimate.present_uncertainty == pytest.approx([spread_of(first)], rel=0.01)
    assert (result.outcome, plane.outcome) == ("undecided", "undecided")
    assert "S0 at 1500 r/min, calculated: 0.5 ± 0.33 mm/s rms" in result.why[1]


def test_a_vibration_that_no_run_shows_is_known_as_well_as_what_it_is_calculated_from():
    # 1000 g·mm less 990 that stay, read with a trial weight of 500 beside: 10 mm/s and 5.1, and calculated 0.1.
    table = job_of(np.array([[0.01 + 0j]]), np.array([1000 + 0j]), [4.9]).to_dict()
    stays = {"plane": "P0", "mass_g": 9.9, "angle": 180, "stays": True}
    table["run"][1]["weights"] = [stays, {"plane": "P0", "mass_g": 5, "angle": 0}]
    table["run"][1]["readings"][0] |= {"amplitude": 5.1, "phase": 0}
    table["tolerance"] = {"vibration": 0.15}
    result = measure(Job.from_dict(table))
    random = np.random.default_rng(0)
    first, last = 10 * off(random), 5.1 * off(random)
    drawn = last + 500 * (last - first) / 490
    assert abs(result.present[0]) == pytest.approx(0.1)
    assert 2 * result.estimate.present_uncertainty == pytest.approx([spread_of(drawn)], rel=0.01)
    assert result.outcome == "undecided"
    # Read without the trial weight, it is off by what is stated of its amplitude.
    table["run"].append({"id": "2", "readings": [table["run"][0]["readings"][0] | {"amplitude": 0.1}]})
    assert "S0 at 1500 r/min: 0.1 ± 0.002 mm/s rms against 0.15: PASS" in measure(Job.from_dict(table)).why


def test_no_bound_is_null_in_the_document_and_said_in_words():
    matrix, unbalance = machine(np.random.default_rng(1), 1, 1)
    result = measure(job_of(matrix, unbalance, [0.01], np.random.default_rng(2), permissible_gmm=100))
    document = json.loads(json.dumps(measurement_document(result), allow_nan=False))
    assert document["planes"][0]["expanded_uncertainty_gmm"] is None
    assert "no bound" in measurement_text(result)
    assert "no bound" in certificate_html(result)
    assert " uncertainty</span>" not in certificate_html(result)  # no disc is drawn that a legend could name
    assert "nan" not in certificate_html(result)


def test_no_holes_are_planned_of_an_unbalance_without_bound():
    matrix, unbalance = machine(np.random.default_rng(1), 2, 2)
    table = job_of(matrix, unbalance, [0.01, 0.01], np.random.default_rng(2)).to_dict()
    table |= {"rotor": str(path("rotors/two_disc_rotor.toml")), "plane": [{"id": "I"}, {"id": "II"}]}
    for run in table["run"]:
        for weight in run.get("weights", ()):
            weight["plane"] = {"P0": "I", "P1": "II"}[weight["plane"]]
    result = measure(Job.from_dict(table))
    assert (result.outcome, result.balance) == ("undecided", None)
    assert "bearings: the readings do not bound the unbalance: UNDECIDED" in result.why


def test_a_weight_without_any_effect_gives_no_figure():
    matrix, unbalance = machine(np.random.default_rng(1), 1, 1)
    table = job_of(matrix, unbalance, [0.01]).to_dict()
    table["run"][1]["readings"] = table["run"][0]["readings"]
    with pytest.raises(GeometryError, match=r"the weights in plane 'P0' change no reading but by rounding, .* larger"):
        measure(Job.from_dict(table))


def cancelling(mass):
    """A job whose trial run has 1 g at 90° and some g at 270°."""
    return Job.from_dict(
        {
            "rpm": 1500,
            "conventions": {"angles": "with rotation", "phase": "lag"},
            "sensor": [{"id": "A", "unit": "mm/s"}],
            "plane": [{"id": "I", "radius": 100, "permissible_gmm": 20}],
            "run": [
                {"id": "1", "readings": [{"sensor": "A", "amplitude": 4, "phase": 10}]},
                {
                    "id": "2",
                    "weights": [
                        {"plane": "I", "mass_g": 1, "angle": 90},
                        {"plane": "I", "mass_g": mass, "angle": 270},
                    ],
                    "readings": [{"sensor": "A", "amplitude": 5, "phase": 40}],
                },
            ],
        }
    )


@pytest.mark.parametrize("power", range(2, 9))
def test_trial_weights_that_nearly_cancel_bound_nothing(power):
    """What they come to is less than they are uncertain by, half a percent and half a degree."""
    result = measure(cancelling(1 - 10.0**-power))
    assert (result.outcome, math.isfinite(result.planes[0].uncertainty)) == ("undecided", False)


def test_trial_weights_that_cancel_are_no_trial():
    assert measure(cancelling(0.9)).outcome == "pass"
    with pytest.raises(UsageError, match="2 runs cannot tell what a weight does in one plane"):
        measure(cancelling(1.0))


# What is uncertain in the bearings, A at 20 and B at 280 mm: of planes together, not of each by itself.
ENDS = (0.02, 0.28)
ROTOR = str(path("rotors/two_disc_rotor.toml"))


def lever(z):
    """Return what bearings A and B see (2, planes) of unbalance at places z (planes,) m, by the lever rule."""
    return np.array([ENDS[1] - np.asarray(z), np.asarray(z) - ENDS[0]]) / (ENDS[1] - ENDS[0])


def bounds_in_bearings(result, z):
    """Return ΔU (2,) g mm of an estimate of the planes at z (planes,) m."""
    sources = [measured(moves, z, 0.1) for moves in result.spreads]
    p, q = plane_weights(0.1, ENDS)
    return np.array([1e6 * sum(k.bound(*weight) for k in sources) for weight in zip(p, q, strict=True)])


def on_a_machine(readings, conventions=None):
    """A job on a balancing machine whose planes are those of the rotor: readings in g mm and degrees."""
    shown = [{"sensor": name, "amplitude": a, "phase": at} for name, (a, at) in zip(("I", "II"), readings, strict=True)]
    return Job.from_dict(
        {
            "method": "balancing machine",
            "rpm": 600,
            "rotor": ROTOR,
            "conventions": {"angles": "with rotation", "shows": "unbalance"} | (conventions or {}),
            "plane": [{"id": "I"}, {"id": "II"}],
            "run": [{"id": "only", "readings": shown}],
        }
    )


@pytest.mark.parametrize("conventions", [{}, {"angles": "against rotation", "zero": 40}])
def test_planes_of_a_machine_add_up_in_squares_in_the_bearings(conventions):
    # 2° are more than 2 %: the worst direction is across the vectors, which are parallel.
    result = measure(on_a_machine([(100.0, 30.0), (80.0, 30.0)], conventions))
    each = np.array([plane.expanded for plane in result.planes])
    assert 1e6 * each == pytest.approx(2 * np.array([100.0, 80.0]) * math.radians(2) / math.sqrt(3), rel=1e-9)
    stated = [bounds["measurement"] for bounds in result.balance.initial.bounds_in_planes(ENDS)]
    assert stated == pytest.approx(np.hypot(*(lever([0.09, 0.215]) * each).T), rel=1e-9)


def test_a_machine_passes_what_squares_leave_within_the_limit():
    # The sum of both planes' uncertainties would cover the limit in bearing B.
    result = measure(on_a_machine([(105.1, 0.0), (105.1, 0.0)]))
    seen = lever([0.09, 0.215]) @ [105.1, 105.1]
    sums = lever([0.09, 0.215]) @ [1e6 * plane.expanded for plane in result.planes]
    assert result.outcome == "pass"
    assert seen[1] + sums[1] > 1e6 * result.balance.tolerance.permissible[1]


def test_what_a_user_bounds_adds_up_as_it_is():
    found = balance(Rotor.load(ROTOR), measured=[(0.09, 5e-5, 2e-6), (0.215, 5e-5j, 1e-6)])
    stated = [bounds["measurement"] for bounds in found.initial.bounds_in_planes(ENDS)]
    assert stated == pytest.approx(lever([0.09, 0.215]) @ [2e-6, 1e-6], rel=1e-9)


def test_one_plane_is_as_uncertain_in_the_bearings_as_it_is():
    result = estimate(job_of(np.array([[0.01 + 0.004j]]), np.array([SIZE]), [1.5]))
    expected = np.abs(lever([0.09])[:, 0]) * 2e6 * result.uncertainty[0]
    assert bounds_in_bearings(result, [0.09]) == pytest.approx(expected, rel=1e-9)


NEAR = 1e-2 * lever([0.14, 0.16])  # sensors at the bearings, mm/s per g mm, and planes that lie near each other


def test_planes_that_are_hardly_told_apart_are_known_together():
    random, unbalance = np.random.default_rng(4), np.array([58.0, 58.0])
    result = estimate(job_of(NEAR, unbalance, [4.5, 4.5]))
    draws = np.array([estimate(job_of(NEAR, unbalance, [4.5, 4.5], random)).unbalance for _ in range(150)])
    seen = 1e6 * draws @ lever([0.14, 0.16]).T
    scatter = 2 * np.maximum(seen.real.std(axis=0), seen.imag.std(axis=0))
    stated = bounds_in_bearings(result, [0.14, 0.16])
    assert (stated > 0.95 * scatter).all()
    assert (stated < 2.0 * scatter).all()
    assert (stated < 0.25 * lever([0.14, 0.16]) @ (2e6 * result.uncertainty)).all()


@pytest.mark.parametrize("trial", [1.0, 6.0])
@pytest.mark.parametrize("kind", ["near", "apart", "overhung", "six sensors", "three planes"])
def test_in_the_bearings_the_size_is_within_what_is_stated_as_often_as_that_says(kind, trial):
    random = np.random.default_rng(18)
    z = {"overhung": [0.29, 0.33], "near": [0.14, 0.16], "three planes": [0.05, 0.14, 0.22]}.get(kind, [0.09, 0.215])
    matrix = NEAR if kind == "near" else machine(random, len(z), {"six sensors": 6, "three planes": 4}.get(kind, 2))[0]
    unbalance = 300.0 * np.exp(2j * np.pi * random.random(len(z)))
    true, inside, judged = np.abs(lever(z) @ unbalance), [], 60
    for _ in range(judged):
        result = estimate(job_of(matrix, unbalance, [5 * trial] * len(z), random))
        if result.bounded:
            size = np.abs(lever(z) @ (1e6 * result.unbalance))
            inside.append(np.abs(size - true) <= bounds_in_bearings(result, z))
    # Three standard deviations of the count aside.
    assert len(inside) < judged / 2 or (np.mean(inside, axis=0) >= 0.95 - 3 * math.sqrt(0.05 * 0.95 / judged)).all()
