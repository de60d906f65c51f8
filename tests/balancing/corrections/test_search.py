"""Plans against all plans tried, and against plans within tighter limits."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, seed, settings
from hypothesis import strategies as st
from tests.balancing.corrections.workpieces import POINT, STEEL, drilled

from inertia.balancing.correction_loop import tools_of_density
from inertia.balancing.corrections import sharing as sharing_module
from inertia.balancing.corrections.correction_plane import CorrectionPlane, KitWeight, Sector, evenly
from inertia.balancing.corrections.drilling import radial_unbalance
from inertia.balancing.corrections.least_residual import least_residual
from inertia.balancing.corrections.places import Places
from inertia.balancing.corrections.search import AIM, best_plan
from inertia.balancing.corrections.sharing import Sharing
from inertia.balancing.corrections.steps import steps_of
from inertia.balancing.unbalance import plane_weights

LIMIT = 1e-4  # kg m
CLOSE = 1e-6


def searched(planes, levers, start, seconds=60.0, limit=LIMIT, aim=AIM):
    """Return the plan for a vector in each tolerance plane (kg m), and its places as (plane, tool, angle, setting)."""
    steps = [
        steps_of(number, tool, 2 * np.abs(start).max())
        for number, plane in enumerate(planes)
        for tool in tools_of_density(plane, STEEL)
    ]
    gains = [np.tile(each.tool.sign * levers[:, each.plane] / limit, (len(each.settings), 1)) for each in steps]
    plan = best_plan(Places(steps, gains, np.asarray(start, complex) / limit, seconds), aim)
    return plan, [(steps[k].plane, steps[k].tool, steps[k].angles[a], steps[k].settings[s]) for k, a, s in plan.spots]


def rank(plan):
    """Return what a plan is judged by: how far it is out of tolerance, its places, what it leaves."""
    return max(plan.worst, 1.0), len(plan.spots), plan.worst


def test_case_9_the_smallest_error_over_sixteen_holes():
    angles = np.radians(30 + 7.5 * np.arange(16))
    counts = np.array(list(itertools.product((0, 1), repeat=16)))
    expected = 1e-6 * (178.484 + 614.491j)
    smallest = np.abs(142e-6 * counts @ np.exp(1j * angles) - expected).min()
    plane = CorrectionPlane("I", 0.0, "kit", 1.0, angles=tuple(angles.tolist()), kit=(KitWeight("142 mg", 142e-6),))
    plan, places = searched([plane], np.ones((1, 1)), [-expected], limit=1e-6)
    assert plan.worst * 1e-6 == pytest.approx(smallest, rel=1e-9)
    assert smallest == pytest.approx(2.10035e-6, abs=5e-10)  # the note's, from a vector with more digits
    assert len({angle for _, _, angle, _ in places}) == len(places)


@pytest.mark.parametrize("count", [3, 4, 12])
@pytest.mark.parametrize("method", ["add", "remove"])
def test_what_nothing_caps_is_shared_by_two_positions(count, method):
    # Any vector is the sum of two at neighbouring positions; at one alone, a sine of the angle to it is left.
    plane = CorrectionPlane("I", 0.0, method, 0.08, angles=evenly(count))
    middle = 1.73e-3 * np.exp(1j * (math.pi / count))
    plan, places = searched([plane], np.ones((1, 1)), [-middle if method == "add" else middle], limit=1e-5)
    assert plan.worst <= 1
    assert len(places) == 2
    masses = np.array([mass for *_, mass in places])
    assert masses.sum() <= 4 * 1.73e-3 / 0.08


def test_no_plan_keeps_a_place_that_it_is_better_without():
    """Weights whose levers differ, in plans that are the first found: none is as good as asked for with one less."""
    kit = tuple(KitWeight(f"{k}", k * 1e-3) for k in np.linspace(0.1, 1.0, 10).tolist())
    planes = [CorrectionPlane(str(z), z, "kit", 0.04, angles=evenly(72), kit=kit) for z in (0.0, 0.05)]
    steps = [
        steps_of(number, tool, 1e-3) for number, plane in enumerate(planes) for tool in tools_of_density(plane, STEEL)
    ]
    levers = np.array([[1.2, 0.3], [-0.2, 0.7]]) / LIMIT
    gains = [
        each.tool.sign * levers[:, each.plane] * (1 + 0.1 * np.linspace(0, 1, len(each.settings)))[:, None]
        for each in steps
    ]
    for number in range(40):
        rng = np.random.default_rng(number)
        start = rng.uniform(1.0, 3.0, 2) * np.exp(2j * np.pi * rng.random(2))
        places = Places(steps, gains, start, 0.0)
        plan = best_plan(places, AIM)
        rests = [places.rest(plan.spots[:k] + plan.spots[k + 1 :]) for k in range(len(plan.spots))]
        goal = next((each for each in (AIM, 1.0) if plan.worst <= each), 0.0)
        assert all(np.abs(rest).max() > goal for rest in rests)


@pytest.mark.parametrize("count", [5, 12])
def test_of_many_planes_no_more_is_looked_at_than_there_is_time_for(count, monkeypatch):
    solved = 0

    def counted(*arguments):
        nonlocal solved
        solved += 1
        assert solved < 300  # of the millions of ways to share eight holes
        return least_residual(*arguments)

    monkeypatch.setattr(sharing_module, "least_residual", counted)
    planes = [drilled(str(k), 20 + 10 * k, 40, 4, max_depth=12, depth_step=0.1) for k in range(count)]
    at = np.linspace(0.0, 1.0, count)
    start = 3e-4 * np.array([0.8, 1.0]) * np.exp(0.7j)
    plan, places = searched(planes, np.array([1 - at, at]), start, seconds=0.0, limit=1e-5)
    assert places
    assert plan.cut_short
    assert plan.worst < np.abs(start / 1e-5).max()
    assert plan.fewest <= len(places) or plan.worst > 1
    monkeypatch.undo()
    plan, places = searched(planes, np.array([1 - at, at]), start, seconds=2.0, limit=1e-5)
    assert plan.worst <= 1
    assert plan.fewest <= len(places)


@pytest.mark.parametrize("heavy", [10e-3, 60e-3, 1.0])
@pytest.mark.parametrize("most", [1, 2])
def test_a_weight_too_heavy_to_use_does_not_spoil_the_others(heavy, most):
    light = 1e-3 * np.array([1.0, 2.0, 5.0])
    kit = (KitWeight("heavy", heavy), *(KitWeight(f"{k}", k) for k in light.tolist()))
    plane = CorrectionPlane("I", 0.0, "kit", 0.1, angles=evenly(8), kit=kit, most_per_position=most)
    start, limit = 0.9e-3 * np.exp(2.1j), 6e-5
    ways = 0.1 * np.append(light, heavy)[:, None] * np.exp(2j * np.pi * np.arange(8) / 8)
    fewest = next(
        n
        for n in range(1, 6)
        if any(
            abs(start + sum(way)) <= limit
            for which in itertools.combinations_with_replacement(range(8), n)
            if all(which.count(k) <= most for k in which)
            for way in itertools.product(*(ways[:, k] for k in which))
        )
    )
    plan, places = searched([plane], np.ones((1, 1)), [start], limit=limit, aim=1.0)
    assert plan.worst <= 1
    assert len(places) == fewest > 1


def test_clips_at_free_angles_do_not_overlap_on_their_track():
    kit = (KitWeight("10 g", 10e-3, width=0.03), KitWeight("25 g", 25e-3, width=0.06))
    plane = CorrectionPlane("I", 0.0, "kit", 0.1, kit=kit)
    plan, places = searched([plane], np.ones((1, 1)), [5.2e-3 * np.exp(0.7j)])
    assert plan.worst <= 1
    assert len(places) == 3  # two of 25 g side by side make up 4.8 kg mm at most
    for (_, one, a, _), (_, other, b, _) in itertools.combinations(places, 2):
        away = abs((a - b + math.pi) % math.tau - math.pi)
        assert away * 0.1 >= 0.5 * (one.weight.width + other.weight.width) - 1e-9


def test_set_screws_of_several_lengths_count_at_their_own_radius():
    kit = (KitWeight("M6 x 6", 1.0e-3, radius=0.097), KitWeight("M6 x 12", 2.0e-3, radius=0.094))
    plane = CorrectionPlane("I", 0.0, "kit", 0.1, angles=evenly(12), kit=kit)
    plan, places = searched([plane], np.ones((1, 1)), [-(1.0 * 0.097 + 2.0 * 0.094 * 1j) * 1e-3], limit=1e-9)
    assert plan.worst < 1e-3
    assert sorted((round(math.degrees(a)), tool.weight.name) for _, tool, a, _ in places) == [
        (0, "M6 x 6"),
        (90, "M6 x 12"),
    ]


class TestBruteForce:
    """Every plan with up to three places in a plane, written down with the formulas of the worked cases alone."""

    @pytest.mark.parametrize("seeds", [range(k, 200, 8) for k in range(8)])
    def test_no_plan_is_better(self, seeds):
        for number in seeds:
            self.compare(number)

    def compare(self, number):
        draw = np.random.default_rng(number)
        count = 1 + number % 2
        kit = number % 4 >= 2
        levers = np.array([[0.75, 0.2], [0.25, 0.8]])[:, :count]
        planes, options = [], []
        for k in range(count):
            angles = tuple(np.sort(draw.choice(24, 5 if kit else 4, replace=False)) * math.tau / 24)
            if kit:
                masses = tuple(draw.choice([2e-3, 3e-3, 5e-3, 8e-3], 2, replace=False).tolist())
                weights = tuple(KitWeight(f"{m}", m, 2) for m in masses)
                plane = CorrectionPlane(f"{k}", 0.1 + 0.1 * k, "kit", 0.1, angles=angles, kit=weights)
                options.append([(t, m, 0.1 * m * np.exp(1j * t)) for t in angles for m in masses])
            else:
                plane = drilled(f"{k}", 100 + 100 * k, 100, 8, 12, max_depth=10, depth_step=5, angles=angles)
                options.append(
                    [
                        (t, (d, h), -radial_unbalance(STEEL, 0.1, d, h, POINT) * np.exp(1j * t))
                        for t in angles
                        for d in (0.008, 0.012)
                        for h in (0.0, 0.005, 0.01)
                    ]
                )
            planes.append(plane)
        size = 2e-3 if kit else 1.5e-3
        start = draw.uniform(0.1, 1.0) * size * (draw.normal(size=2) + 1j * draw.normal(size=2))
        if count == 1:
            start = levers[:, 0] * start[0]
        best = self.best(options, levers, start, 3, kit)
        plan, _ = searched(planes, levers, start)
        assert not plan.cut_short
        # What leaves less than a five-hundredth of the limit counts as nothing.
        assert rank(plan)[:2] <= (best[0] * (1 + CLOSE), best[1])
        assert plan.worst <= max(best[2], 0.002) * (1 + CLOSE) or rank(plan)[:2] < best[:2]
        assert plan.bound <= plan.worst
        if number % 10 == 0:
            least, _ = searched(planes, levers, start, aim=0.0)
            assert least.worst <= max(best[3], 0.002) * (1 + CLOSE)

    def best(self, options, levers, start, most, kit):
        """Return the rank of the best plan with at most so many places in a plane."""
        tables = []
        for choices in options:
            plans = [
                plan for n in range(most + 1) for plan in itertools.combinations(choices, n) if self.possible(plan, kit)
            ]
            tables.append((np.array([sum(k[2] for k in plan) for plan in plans]), np.array([len(k) for k in plans])))
        left = np.abs(start[:, None] + levers[:, :1] * tables[0][0])[:, :, None] / LIMIT
        number = tables[0][1][:, None]
        if len(tables) == 2:
            vectors = (
                start[:, None, None] + levers[:, :1, None] * tables[0][0][:, None] + levers[:, 1:, None] * tables[1][0]
            )
            left = np.sqrt(vectors.real**2 + vectors.imag**2) / LIMIT
            number = number + tables[1][1]
        worst = left.max(axis=0)
        if (worst <= 1).any():
            fewest = number[worst <= 1].min()
            return 1.0, fewest, worst[number == fewest].min(), worst.min()
        return worst.min(), number[worst <= worst.min() * (1 + CLOSE)].min(), worst.min(), worst.min()

    def possible(self, plan, kit):
        if len({angle for angle, _, _ in plan}) < len(plan):
            return False
        if kit:
            return all(sum(m == k for _, k, _ in plan) <= 2 for _, m, _ in plan)
        for (one, (d, h), _), (other, (e, g), _) in itertools.combinations(plan, 2):
            away = abs((one - other + math.pi) % math.tau - math.pi)
            if 2 * (0.1 - min(h, g)) * math.sin(away / 2) < (d + e) / 2 + 0.001 - 1e-12:
                return False
        return True


@pytest.mark.parametrize("number", [0, 7, 25])
def test_of_holes_that_would_run_into_those_of_another_plane_the_next_best_are_taken(number):
    draw = np.random.default_rng(number)
    angles = [tuple(sorted(draw.choice(evenly(12), 4, replace=False).tolist())) for _ in range(2)]
    planes = [
        drilled(f"{z}", z, 100, 8, 12, max_depth=10, depth_step=5, angles=listed)
        for z, listed in zip((100, 106), angles, strict=True)
    ]
    start = draw.uniform(0.1, 1) * 1.5e-3 * (draw.normal(size=2) + 1j * draw.normal(size=2)) / LIMIT
    steps = [steps_of(k, tool, 4e-3) for k, plane in enumerate(planes) for tool in tools_of_density(plane, STEEL)]
    levers = np.array([[0.75, 0.2], [0.25, 0.8]]) / LIMIT
    places = Places(steps, [np.tile(-levers[:, k.plane], (len(k.settings), 1)) for k in steps], start)
    spots = [(k, a, s) for k, a, s in itertools.product(range(4), range(4), (1, 2))]
    ways = [
        [way for n in range(3) for way in itertools.combinations(each, n) if places.fits(way)]
        for each in (spots[:16], spots[16:])
    ]
    left = {(*one, *other): np.abs(places.rest((*one, *other))).max() for one, other in itertools.product(*ways)}
    least = next(left[way] for way in sorted(left, key=left.get) if places.fits(way))
    assert best_plan(places, 0.0).worst <= least * (1 + CLOSE)


class TestFewWeights:
    """All ways to put weights of a kit, or masses by steps, at few positions of two planes, with their stock."""

    def plane(self, draw, name, z, radius):
        """Return a plane, and what each way adds (kg m), and its number of places."""
        angles = np.radians(15) * draw.integers(3) + np.arange(count := int(draw.integers(4, 6))) * math.tau / count
        most = 1 + int(draw.random() < 0.15)
        if draw.random() < 0.7:
            masses = sorted({round(float(k), 4) for k in draw.uniform(2e-3, 15e-3, 2)})
            stock = [None if draw.random() < 0.7 else int(draw.integers(1, 4)) for _ in masses]
            kit = tuple(KitWeight(f"{k}", k, n) for k, n in zip(masses, stock, strict=True))
            plane = CorrectionPlane(
                name, z, "kit", radius, angles=tuple(angles.tolist()), kit=kit, most_per_position=most
            )
        else:
            step, most = float(draw.choice([3e-3, 5e-3])), 1
            masses, stock = [step, 2 * step], [None, None]
            plane = CorrectionPlane(
                name, z, "add", radius, angles=tuple(angles.tolist()), max_mass=2 * step, mass_step=step
            )
        each = [way for n in range(most + 1) for way in itertools.combinations_with_replacement((0, 1), n)]
        size = np.array([sum(masses[k] for k in way) for way in each])
        used = np.array([[way.count(k) for k in (0, 1)] for way in each])
        which = np.array(list(itertools.product(range(len(each)), repeat=count)))
        total = used[which].sum(axis=1)
        which = which[(total <= [math.inf if n is None else n for n in stock]).all(axis=1)]
        return plane, radius * size[which] @ np.exp(1j * angles), used[which].sum(axis=(1, 2))

    def case(self, number):
        """Return planes, what they do at A and B, what is there (kg m), a limit, and the least with n places."""
        draw = np.random.default_rng(number)
        a, b = [(-0.03, 0.25), (0.04, 0.18), (0.06, 0.25)][draw.integers(3)]
        (one, first, n), (other, second, m) = (
            self.plane(draw, name, z, radius) for name, z, radius in (("I", 0.01, 0.09), ("II", 0.21, 0.07))
        )
        levers = np.array([[(b - k.z) / (b - a) for k in (one, other)], [(k.z - a) / (b - a) for k in (one, other)]])
        start = draw.uniform(0.1, 1.0) * 1e-3 * (draw.normal(size=2) + 1j * draw.normal(size=2))
        limit = float(draw.choice([0.5e-4, 1e-4, 2e-4]))
        best = np.full(n.max() + m.max() + 1, math.inf)
        for vector, count in zip(first, n, strict=True):
            left = start[:, None] + levers[:, :1] * vector + levers[:, 1:] * second
            np.minimum.at(best, count + m, np.abs(left).max(axis=0) / limit)
        return [one, other], levers, start, limit, best

    @pytest.mark.parametrize("numbers", [range(k, 48, 4) for k in range(4)])
    def test_no_way_is_better(self, numbers):
        for number in numbers:
            planes, levers, start, limit, best = self.case(number)
            for aim in (AIM, 0.0):
                goal = next((k for k in (aim, 1.0) if aim and best.min() <= k), max(best.min(), 0.002))
                fewest = int(np.argmax(best <= goal * (1 + CLOSE)))
                plan, _ = searched(planes, levers, start, limit=limit, aim=aim)
                assert len(plan.spots) == fewest or goal == 0.002
                assert plan.worst <= max(best[fewest], 0.002) * (1 + CLOSE)
                assert plan.bound <= best[: len(plan.spots) + 1].min() * (1 + CLOSE)
                assert plan.lowest <= best.min() * (1 + CLOSE)
                assert plan.settled == (plan.worst > 0.002)


class TestHolesAlongTheShaft:
    """Every plan with up to three holes in a plane, with the mass and the place along the shaft of each."""

    def hole(self, diameter, depth, radius, point):
        """Return what an axial hole takes, kg m, and how far under its face, m."""
        area, tip = math.pi * diameter**2 / 4, 0.5 * diameter / math.tan(0.5 * point)
        shaft, cone = area * depth, area * tip / 3
        under = (0.5 * shaft * depth + cone * (depth + 0.25 * tip)) / (shaft + cone)
        return STEEL * (shaft + cone) * radius, under

    def case(self, number):
        """Return planes, each one's holes (angle, diameter, what they do at A and B), and what is there, kg m."""
        draw = np.random.default_rng(number)
        span = float(draw.choice([0.1, 0.2, 0.3]))
        planes, options = [], []
        for k in range(1 + number % 2):
            point, face = math.radians(draw.choice([118, 140, 180])), str(draw.choice(["a", "b"]))
            z, radius = float(draw.uniform(-0.05, span + 0.05)), float(draw.uniform(0.05, 0.12))
            angles = tuple(np.sort(draw.choice(24, 4 + 2 * (1 - number % 2), replace=False)) * math.tau / 24)
            diameters = tuple(sorted(draw.choice([0.006, 0.01, 0.014], 2 - number % 2, replace=False).tolist()))
            depths = 0.01 * np.arange(draw.integers(3, 5))
            planes.append(
                CorrectionPlane(
                    f"{k}", z, "drill_axial", radius, diameters=diameters, max_depth=float(depths[-1]),
                    depth_step=0.01, angles=angles, face=face, point_angle=point,
                )
            )  # fmt: skip
            holes = []
            for angle, diameter, depth in itertools.product(angles, diameters, depths):
                size, under = self.hole(diameter, depth, radius, point)
                share = (z + (under if face == "a" else -under)) / span
                holes.append((angle, diameter, -size * np.exp(1j * angle) * np.array([1 - share, share])))
            options.append(holes)
        most = max(np.abs(hole[2]).max() for holes in options for hole in holes)
        start = 0.1 * most * (draw.normal(size=2) + 1j * draw.normal(size=2))
        for holes in options:
            start = start - sum(holes[draw.integers(len(holes))][2] for _ in range(2))
        return planes, options, (0.0, span), start, float(draw.uniform(0.05, 0.4)) * most

    def possible(self, holes, radius):
        return all(
            2 * radius * math.sin(abs((a - b + math.pi) % math.tau - math.pi) / 2) >= (d + e) / 2 + 0.001 - 1e-12
            for (a, d, _), (b, e, _) in itertools.combinations(holes, 2)
        )

    def least(self, planes, options, start, limit):
        """Return what the best of all plans with at most 0, 1, ... holes leaves, over the limit."""
        sums = [{0: start[None]}]
        for plane, holes in zip(planes, options, strict=True):
            sums.append({})
            for n in range(4):
                plans = [plan for plan in itertools.combinations(holes, n) if self.possible(plan, plane.radius)]
                vectors = np.array([sum((k[2] for k in plan), np.zeros(2, complex)) for plan in plans])
                for before, left in sums[-2].items() if plans else ():
                    sums[-1].setdefault(before + n, []).append((left[:, None] + vectors).reshape(-1, 2))
            sums[-1] = {n: np.concatenate(each) for n, each in sums[-1].items()}
        return np.minimum.accumulate([np.abs(sums[-1][n]).max(axis=1).min() / limit for n in sorted(sums[-1])])

    @pytest.mark.parametrize("number", range(16))
    def test_no_plan_beats_the_bound_or_the_plan(self, number):
        planes, options, at, start, limit = self.case(number)
        steps = [
            steps_of(k, tool, 2 * np.abs(start).max())
            for k, plane in enumerate(planes)
            for tool in tools_of_density(plane, STEEL)
        ]
        gains = [
            np.array([-plane_weights(each.tool.unbalance_z(h), at)[0] for h in each.settings.tolist()]) / limit
            for each in steps
        ]
        best = self.least(planes, options, start, limit)
        sharing = Sharing(Places(steps, gains, start / limit))
        bounds = [sharing.bound(n) for n in range(4)]
        assert (np.array(bounds) <= best[:4] * (1 + CLOSE)).all()
        assert sharing.lowest <= best[-1] * (1 + CLOSE)
        plan = best_plan(Places(steps, gains, start / limit), AIM)
        goal = next((k for k in (AIM, 1.0) if best[-1] <= k), best[-1])
        fewest = int(np.argmax(best <= goal * (1 + CLOSE)))
        assert plan.worst <= goal * (1 + CLOSE)
        assert plan.bound <= plan.worst
        if goal <= 1:
            assert len(plan.spots) <= fewest
            assert plan.worst <= max(best[fewest], 0.002) * (1 + CLOSE) or len(plan.spots) < fewest
            assert plan.fewest <= np.argmax(best <= 1)


WEIGHTS = (KitWeight("3 g", 3e-3), KitWeight("5 g", 5e-3, 2), KitWeight("8 g", 8e-3, 1))


@st.composite
def shops(draw):
    """Return planes, and the same with looser limits: depths, diameters, sectors, positions and kits."""
    depth = draw(st.sampled_from([6, 8, 12]))
    deeper = depth + draw(st.sampled_from([0, 2, 10]))
    drills = draw(st.sampled_from([(8,), (10,), (6, 12)]))
    more = tuple(sorted({*drills, *draw(st.sampled_from([(), (8,), (14,)]))}))
    width = draw(st.sampled_from([0.0, 1.0, 2.0]))
    sector = (Sector(0.5, 0.5 + width),) if width else ()
    narrower = (Sector(0.5, 0.5 + 0.5 * width),) if width and draw(st.booleans()) else ()
    count = draw(st.sampled_from([8, 12]))
    listed = draw(st.booleans())
    tight = {"angles": evenly(count)} if listed else {"angle_step": math.radians(2)}
    loose = {"angles": evenly(2 * count)} if listed else {"angle_step": math.radians(1)}
    weights = draw(st.integers(1, 2))
    kit = draw(st.booleans())

    def planes(drills, depth, sectors, options, weights, most):
        second = (
            CorrectionPlane("II", 0.2, "kit", 0.1, angles=evenly(8), kit=WEIGHTS[:weights], most_per_position=most)
            if kit
            else drilled("II", 200, 100, *drills, max_depth=depth, depth_step=1)
        )
        return [
            drilled("I", 100, 100, *drills, max_depth=depth, depth_step=0.5, forbidden=sectors, **options),
            second,
        ]

    most = draw(st.integers(1, 2))
    return (
        planes(drills, depth, sector, tight, weights, 1),
        planes(more, deeper, narrower, loose, weights + 1, most),
    )


@seed(20)
@given(shops(), st.floats(0.2, 1.2), st.floats(0, math.tau), st.floats(0.2, 1.2), st.floats(0, math.tau))
@settings(deadline=None, max_examples=8)
def test_looser_limits_never_give_a_worse_plan(both, a, first, b, second):
    levers = np.array([[0.75, 0.2], [0.25, 0.8]])
    start = 1e-3 * np.array([a * np.exp(1j * first), b * np.exp(1j * second)])
    (tight, _), (loose, _) = (searched(planes, levers, start, seconds=4.0) for planes in both)
    if tight.cut_short or loose.cut_short:
        return  # the best so far, of which nothing is promised
    assert (max(loose.worst, 1.0), len(loose.spots)) <= (max(tight.worst, 1.0) * (1 + CLOSE), len(tight.spots)) or (
        loose.worst <= 1 and tight.worst > 1
    )
    if len(loose.spots) == len(tight.spots):
        assert loose.worst <= max(tight.worst, 0.01) * (1 + CLOSE)
