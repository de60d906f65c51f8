"""The Monte Carlo residuals against closed forms, and against a rotor that is built anew in every draw."""

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest
from tests.balancing.rotors import on_z

from inertia import MassProperties, UsageError
from inertia.balancing import bounds
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.monte_carlo import Term, monte_carlo
from inertia.balancing.monte_carlo_terms import ShopTolerance, operation_terms, rotor_terms
from inertia.balancing.unbalance import Unbalance

PLANES = (0.02, 0.28)


def term(distribution, spread, sensitivity):
    return Term("input", distribution, spread, np.atleast_1d(sensitivity), 1.0, "1")


@pytest.mark.parametrize(
    ("terms", "expected"),
    [
        ([term("uniform", 2.0, 3.0)], 0.95 * 6.0),
        ([term("disc", 2.0, 3.0j)], math.sqrt(0.95) * 6.0),
        ([term("normal", 2.0, 3.0)], 1.959964 * 6.0),
        ([term("normal", 2.0, 3.0), term("normal", 2.0, 3.0j)], math.sqrt(-2 * math.log(0.05)) * 6.0),
    ],
)
def test_residuals_of_one_distribution_have_a_closed_form(terms, expected):
    scatter = monte_carlo([0.0], terms)
    assert scatter.residual_95[0] == pytest.approx(expected, rel=0.03)
    low, high = scatter.residual_95_range[0]
    assert low < scatter.residual_95[0] < high
    assert monte_carlo([0.0], terms, draws=400_000).residual_95[0] == pytest.approx(expected, rel=0.004)


def test_the_range_of_the_residual_covers_the_truth_as_often_as_it_says():
    ranges = [monte_carlo([0.0], [term("disc", 1.0, 1.0)], draws=1000, seed=k).residual_95_range[0] for k in range(300)]
    covered = np.mean([low <= math.sqrt(0.95) <= high for low, high in ranges])
    assert 0.91 < covered < 0.99


def test_without_uncertainty_the_residual_is_the_nominal_one():
    scatter = monte_carlo([3e-4 + 4e-4j, 0.0], [], permissible=[5.1e-4, 1e-9])
    assert scatter.residual_95 == pytest.approx([5e-4, 0.0])
    assert scatter.within == 1.0


def test_the_share_within_tolerance_counts_all_planes_together():
    terms = [Term("a", "uniform", 1.0, [1.0, 0.0], 1.0, "1"), Term("b", "uniform", 1.0, [0.0, 1.0], 1.0, "1")]
    assert monte_carlo([0.0, 0.0], terms, permissible=[0.5, 0.8]).within == pytest.approx(0.4, abs=0.02)


def test_the_table_is_sorted_by_what_matters_against_the_limit():
    terms = [
        Term("loose plane", "uniform", 1.0, [3.0, 0.0], 0.1, "0.1"),
        Term("tight plane", "uniform", 1.0, [0.0, 2.0], 0.5, "0.5"),
        Term("nothing", "disc", 0.0, [9.0, 9.0], 0.1, "0.1"),
    ]
    table = monte_carlo([0.0, 0.0], terms, permissible=[10.0, 1.0]).sensitivities
    assert [line.name for line in table] == ["tight plane", "loose plane", "nothing"]
    assert table[0].per_step == pytest.approx([0.0, 1.0])
    assert table[1].at_spread == pytest.approx([3.0, 0.0])
    assert sum(line.share for line in table) == pytest.approx([1.0, 1.0])


def test_the_same_seed_gives_the_same_draws():
    terms = [term("normal", 1.0, 1.0)]
    assert monte_carlo([0.0], terms, seed=7).residual_95 == monte_carlo([0.0], terms, seed=7).residual_95
    assert monte_carlo([0.0], terms, seed=7).residual_95 != monte_carlo([0.0], terms, seed=8).residual_95


HOLES = (
    Operation("I-1", "I", 0.09, "remove", "drill_radial", 3.7, 0.1, 0, 0, 0.09, 0.012, math.radians(118), 0.01),
    Operation("II-1", "II", 0.2, "remove", "drill_axial", 0.3, 0.07, 0, 0, 0.208, 0.014, math.radians(118), 0.015),
    Operation("III-1", "III", 0.15, "remove", "mill_flat", 2.0, 0.05, 0, 0, 0.15, depth=0.004, width=0.03),
    Operation("IV-1", "IV", 0.25, "add", "weight", 1.0, 0.06, 0.02, 0, 0.25),
)
DENSITY = 7850.0


def taken(work, depth=0.0, diameter=0.0, radius=0.0, mass=0.0):
    """Return the magnitude of an operation's unbalance, changed by so much, from the integral over its solid."""
    if work.kind == "weight":
        return work.mass * (1 + mass) * (work.radius + radius)
    h, r = work.depth + depth, work.radius + radius
    if work.kind == "mill_flat":
        s, weights = np.polynomial.legendre.leggauss(40)
        t = 0.5 * math.acos((r - h) / r) * (s + 1)  # s = r cos t
        chord = 2 * r * np.sin(t)
        inner = weights @ (chord * r * np.cos(t) * r * np.sin(t))
        return DENSITY * work.width * 0.5 * math.acos((r - h) / r) * inner
    a = 0.5 * (work.tool_diameter + diameter)
    tip = a / math.tan(work.point_angle / 2)
    area = math.pi * a**2
    if work.kind == "drill_axial":
        return DENSITY * r * area * (h + tip / 3)
    cylinder = area * (r * h - h**2 / 2) - math.pi * a**4 / 8
    return DENSITY * (cylinder + area * tip / 3 * (r - h - tip / 4))


def planned():
    """Return the operations with the unbalance that they have as planned."""
    sign = {"add": 1, "remove": -1}
    return tuple(replace(k, unbalance=sign[k.method] * cmath.rect(taken(k), k.angle)) for k in HOLES)


def in_planes(vectors):
    """Resolve (z, vector) pairs at the tolerance planes by the lever rule, in plain arithmetic."""
    a, b = PLANES
    at_b = sum(u * (z - a) / (b - a) for z, u in vectors)
    return np.array([sum(u for _, u in vectors) - at_b, at_b])


class Lumps:
    """A rotor of two bodies, each of many point masses, on a shaft whose bearings may be somewhere else."""

    def __init__(self):
        random = np.random.default_rng(11)
        self.bodies = [
            (random.normal([1e-4, 0, 0.1], [0.04, 0.04, 0.01], (60, 3)), random.uniform(0.05, 0.1, 60)),
            (random.normal([0, 2e-4, 0.2], [0.03, 0.03, 0.02], (50, 3)), random.uniform(0.05, 0.1, 50)),
        ]
        for points, masses in self.bodies:  # balanced but for a little
            points[:, :2] -= masses @ points[:, :2] / masses.sum() - 1e-5

    def on(self, shaft, densities):
        """Return (z, m r) of all point masses, from where they really are."""
        vectors = []
        for (points, masses), density in zip(self.bodies, densities, strict=True):
            local = shaft.to_shaft(points)
            heavy = masses * (1 + density) * (local[:, 0] + 1j * local[:, 1])
            vectors += list(zip(local[:, 2], heavy, strict=True))
        return in_planes(vectors)

    def unbalance(self, radial, relative):
        """Return the same rotor as an `Unbalance` with its uncertainties."""
        points = np.concatenate([points for points, _ in self.bodies])
        masses = np.concatenate([masses for _, masses in self.bodies])
        center = masses @ points / masses.sum()
        local = points - center
        tensor = np.einsum(
            "k,kij->ij", masses, (local**2).sum(1)[:, None, None] * np.eye(3) - local[:, :, None] * local[:, None]
        )
        body = on_z(*PLANES).resolve(MassProperties(masses.sum(), 1.0, center, tensor))
        parts = []
        for points_, masses_ in self.bodies:
            heavy = masses_ * (points_[:, 0] + 1j * points_[:, 1])
            parts.append((heavy.sum(), heavy @ (points_[:, 2] - center[2])))
        uncertain = (bounds.density(parts, relative), bounds.axis(body, PLANES[1] - PLANES[0], radial))
        return Unbalance(masses.sum(), center[2], *np.sum(parts, axis=0), uncertain)


RADIAL, RELATIVE = 1e-5, 0.02
SHOP = ShopTolerance()


def direct(lumps, works, random):
    """Draw every input and build the rotor and its corrections from them, with nothing made linear."""

    def disc():
        return RADIAL * math.sqrt(random.uniform()) * cmath.exp(2j * math.pi * random.uniform())

    a, b = disc(), disc()
    shaft = Shaft([a.real, a.imag, PLANES[0]], [b.real, b.imag, PLANES[1]], [1, 0, 0])
    scatter = lumps.on(shaft, random.uniform(-RELATIVE, RELATIVE, 2))
    vectors = []
    for work in works:
        off = {
            k: random.uniform(-1, 1) * getattr(SHOP, k) for k in ("depth", "diameter", "radius", "mass", "angle", "z")
        }
        if work.kind in ("drill_radial", "mill_flat"):
            off["radius"] = 0.0
        angle, z = off.pop("angle"), off.pop("z")
        sign = 1 if work.method == "add" else -1
        vectors.append((work.unbalance_z + z, sign * cmath.rect(taken(work, **off), work.angle + angle)))
    return scatter + in_planes(vectors)


def test_affine_draws_agree_with_rotors_built_anew_in_every_draw():
    lumps, works = Lumps(), planned()
    random = np.random.default_rng(3)
    rotor = lumps.unbalance(RADIAL, RELATIVE)
    nominal = np.array(rotor.in_planes(*PLANES)) + in_planes([(k.unbalance_z, k.unbalance) for k in works])
    terms = rotor_terms(rotor, PLANES) + operation_terms(works, rotor, PLANES, SHOP)
    # The residual starts from zero, so that what is seen is the scatter and not the nominal value.
    scatter = monte_carlo([0.0, 0.0], terms, draws=100_000)
    drawn = np.array([direct(lumps, works, random) - nominal for _ in range(3000)])
    assert scatter.residual_95 == pytest.approx(np.quantile(np.abs(drawn), 0.95, axis=0), rel=0.06)
    spread = np.sqrt(np.mean(np.abs(drawn) ** 2, axis=0))
    assert np.sqrt(sum(k.deviation**2 for k in terms)) == pytest.approx(spread, rel=0.04)


def test_each_bearings_sensitivity_is_that_of_a_shaft_that_is_moved():
    lumps = Lumps()
    rotor = lumps.unbalance(RADIAL, RELATIVE)
    a, b, uneven = rotor_terms(rotor, PLANES)[2:]
    for moved, bearing in ((a, 0), (b, 1)):
        for step in (1e-6, 1e-6j):
            places = [[0.0, 0.0, z] for z in PLANES]
            places[bearing][:2] = [complex(step).real, complex(step).imag]
            change = lumps.on(Shaft(*places, [1, 0, 0]), [0, 0]) - lumps.on(on_z(*PLANES), [0, 0])
            room = np.abs(uneven.sensitivities) * abs(step)
            assert (np.abs(change - moved.sensitivities * step) <= 1.001 * room + 1e-12).all()


@pytest.mark.parametrize("work", planned(), ids=lambda work: work.kind)
def test_sensitivities_of_the_shops_work_are_the_derivatives(work):
    rotor = Unbalance(10.0, 0.13, 0.0, 0.0)
    inputs = {
        "drill_radial": {"depth", "diameter"},
        "drill_axial": {"depth", "diameter", "radius"},
        "mill_flat": {"depth"},
        "weight": {"mass", "radius"},
    }[work.kind]
    terms = {k.name.split(": ")[1]: k.sensitivities for k in operation_terms([work], rotor, PLANES, SHOP)}
    assert set(terms) == inputs | {"angle", "z"}
    unit = work.unbalance / abs(work.unbalance)
    for name in inputs:
        step = 1e-7
        rate = (taken(work, **{name: step}) - taken(work, **{name: -step})) / (2 * step)
        assert terms[name] == pytest.approx(in_planes([(work.unbalance_z, rate * unit)]), rel=2e-4)
    assert terms["angle"] == pytest.approx(in_planes([(work.unbalance_z, 1j * work.unbalance)]))
    assert terms["z"] == pytest.approx(work.unbalance * np.array([-1, 1]) / 0.26)


def test_a_bound_moves_every_plane_by_no_more_than_itself():
    uncertain = (bounds.Uncertainty("tessellation", ((1e-6, 2e-7j), (0.0, 3e-7)), 1e-5),)
    rotor = Unbalance(10.0, 0.13, 0.0, 0.0, uncertain)
    (scatter,) = rotor_terms(rotor, PLANES)
    bound = [k["tessellation"] for k in rotor.bounds_in_planes(PLANES)]
    assert scatter.spread * np.abs(scatter.sensitivities) == pytest.approx(bound)


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: term("triangular", 1.0, 1.0), "distribution is 'triangular'"),
        (lambda: term("normal", -1.0, 1.0), "spread is -1.0"),
        (lambda: monte_carlo([0.0, 0.0], [term("normal", 1.0, 1.0)]), "one for each plane"),
        (lambda: monte_carlo([0.0], [], draws=10), "draws is 10"),
        (lambda: monte_carlo([], []), r"shape \(planes,\)"),
        (lambda: monte_carlo([0.0], [], permissible=[1.0, 2.0]), "permissible must have shape"),
    ],
)
def test_bad_input_is_refused_by_name(call, text):
    with pytest.raises(UsageError, match=text):
        call()
