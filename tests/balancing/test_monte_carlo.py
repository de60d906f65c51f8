"""The Monte Carlo residuals against closed forms, and against a rotor that is built anew in every draw."""

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from tests.balancing.rotors import on_z

from inertia import MassProperties, UsageError
from inertia.balancing import bounds
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.monte_carlo import Term, monte_carlo
from inertia.balancing.monte_carlo_terms import ShopTolerance, Spread, operation_terms, rotor_terms
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


@pytest.mark.parametrize("scale", [1.0, 0.1])
def test_further_terms_may_be_as_large_as_leaves_the_share_that_is_asked_for(scale):
    # Rayleigh of σ² = 1 + (2 f)² within 2.6 with 95 %: 2.6² = 2 σ² ln 20.
    known, further = term("rayleigh", 1.0, 1.0), term("rayleigh", scale, 2.0j)
    factor = math.sqrt(2.6**2 / (2 * math.log(20)) - 1) / (2 * scale)
    spare = monte_carlo([0.0], [known], further=[further], permissible=[2.6]).spare
    assert spare == pytest.approx(min(factor, 1.0), rel=0.06)
    assert spare <= min(factor, 1.0)
    assert monte_carlo([0.0], [known], further=[further], permissible=[2.4]).spare is None  # 94.4 % without them
    assert monte_carlo([0.0], [known], permissible=[2.6]).spare is None


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


GAUSS = np.polynomial.legendre.leggauss(40)


def taken(work, depth=0.0, diameter=0.0, radius=0.0, mass=0.0):
    """Return the magnitude of an operation's unbalance, changed by so much, from the integral over its solid."""
    if work.kind == "weight":
        return work.mass * (1 + mass) * (work.radius + radius)
    h, r = work.depth + depth, work.radius + radius
    if work.kind == "mill_flat":
        s, weights = GAUSS
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
            vectors += list(zip(local[:, 2].tolist(), heavy.tolist(), strict=True))
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
SHOP = ShopTolerance().separately


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
            k: random.uniform(-1, 1) * getattr(SHOP, k).separate
            for k in ("depth", "diameter", "radius", "mass", "angle", "z")
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


def test_the_length_of_an_arc_scatters_by_the_sine_of_its_half():
    """An arc of U = c sin(φ/2) changes by c cos(φ/2)/2 for each radian of its length."""
    work = Operation("I-1", "I", 0.09, "remove", "mill_arc", 3.7, 0.1, 0, -1e-3, 0.09, depth=0.002, width=0.01, arc=0.9)
    (term,) = (k for k in operation_terms([work], Unbalance(10.0, 0.13, 0, 0), PLANES, SHOP) if k.name.endswith("arc"))
    assert term.sensitivities == pytest.approx(in_planes([(0.09, -1e-3 * 0.5 / math.tan(0.45))]), rel=1e-4)


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


class TestTheShareWithinTolerance:
    """Against closed forms of what is normal, uniform and a disc."""

    @pytest.mark.parametrize(
        ("start", "terms", "limit", "share"),
        [
            (0.3, [term("normal", 2.0, 0.25)], 1.0, stats.norm.cdf(1.4) - stats.norm.cdf(-2.6)),
            (0.3, [term("uniform", 2.0, 0.5)], 1.0, 0.85),
            (0.0, [term("disc", 2.0, 1.0)], 1.0, 0.25),
            # √(x² + y²) of two normal ones about a point beside the middle: Rice's distribution
            (0.8, [term("normal", 1.0, 0.4), term("normal", 1.0, 0.4j)], 1.0, stats.ncx2.cdf(6.25, 2, 4.0)),
        ],
    )
    def test_is_that_of_the_closed_form(self, start, terms, limit, share):
        scatter = monte_carlo([start], terms, permissible=[limit], draws=200_000)
        low, high = scatter.within_range
        assert low < share < high
        assert high - low < 0.01

    def test_its_range_is_that_of_wilson(self):
        scatter = monte_carlo([0.0], [term("uniform", 1.0, 1.0)], permissible=[0.9], draws=10_000)
        test = stats.binomtest(round(1e4 * scatter.within), 10_000)
        expected = test.proportion_ci(0.999, "wilson")
        assert scatter.within_range == pytest.approx((expected.low, expected.high), rel=1e-9)

    def test_near_the_edge_more_draws_are_made(self):
        terms = [term("uniform", 1.0, 1.0)]
        assert monte_carlo([0.0], terms, permissible=[0.96], draws=1000).draws > 1000
        edge = monte_carlo([0.0], terms, permissible=[0.9501], draws=1000)
        assert edge.draws == 256_000
        assert edge.within_range[0] < 0.95 < edge.within_range[1]
        assert monte_carlo([0.0], terms, permissible=[0.8], draws=1000).draws == 1000

    def test_one_drill_is_drawn_once_for_all_its_holes(self):
        holes = [
            replace(planned()[0], id=f"I-{k}", angle=a, unbalance=cmath.rect(1.0, a)) for k, a in enumerate((0, 0.1))
        ]
        rotor = Unbalance(10.0, 0.13, 0.0, 0.0)
        shop = ShopTolerance(*[Spread()] * 6)
        (together,) = operation_terms(holes, rotor, PLANES, replace(shop, diameter=Spread(common=1e-4)))
        apart = operation_terms(holes, rotor, PLANES, replace(shop, diameter=Spread(separate=1e-4)))
        assert together.name == "drill Ø12: diameter"
        assert together.sensitivities == pytest.approx(sum(k.sensitivities for k in apart))
        both = operation_terms(holes, rotor, PLANES, replace(shop, diameter=Spread(1e-4, 5e-5)))
        assert [k.spread for k in both] == [5e-5, 5e-5, 1e-4]

    @pytest.mark.parametrize(
        ("name", "groups"),
        [
            ("depth", {"drill Ø12", "drill Ø14", "plane III"}),
            ("angle", {"zero mark"}),
            ("z", {"plane I", "plane II", "plane III", "plane IV"}),
            ("mass", {"weights 5 g"}),
        ],
    )
    def test_what_is_common_goes_by_tool_zero_mark_and_plane(self, name, groups):
        works = [replace(k, item="5 g") if k.kind == "weight" else k for k in planned()]
        shop = replace(ShopTolerance(*[Spread()] * 6), **{name: Spread(common=1e-3)})
        terms = operation_terms(works, Unbalance(10.0, 0.13, 0.0, 0.0), PLANES, shop)
        assert {k.name for k in terms} == {f"{group}: {name}" for group in groups}

    def test_eight_holes_of_one_drill_scatter_as_one(self):
        """The share of eight holes side by side against the quadrature of one input, and of eight."""
        hole = planned()[0]
        angles = 0.12 * (np.arange(8) - 3.5)
        works = [
            replace(hole, id=f"I-{k}", angle=a, unbalance=-cmath.rect(taken(hole), a)) for k, a in enumerate(angles)
        ]
        rotor = Unbalance(10.0, 0.09, 0.0, 0.0)
        start = np.array(rotor.in_planes(*PLANES))
        half = 1e-4

        def left(off):  # of all holes together, at bearing A
            change = np.array([taken(hole, diameter=k) for k in np.atleast_1d(off)]) - taken(hole)
            return change * abs(np.exp(1j * angles).sum())

        arm = (PLANES[1] - hole.unbalance_z) / (PLANES[1] - PLANES[0])
        limit = 0.7 * float(left(half)[0]) * arm
        offs = np.linspace(-half, half, 2001)
        expected = np.mean(np.abs(left(offs) * arm) <= limit)
        shop = ShopTolerance(*[Spread()] * 6)
        limits = [limit, 1.0]
        one = operation_terms(works, rotor, PLANES, replace(shop, diameter=Spread(common=half)))
        each = operation_terms(works, rotor, PLANES, replace(shop, diameter=Spread(separate=half)))
        assert monte_carlo(start, one, permissible=limits).within == pytest.approx(expected, abs=0.02)
        assert monte_carlo(start, each, permissible=limits).within > 0.99
