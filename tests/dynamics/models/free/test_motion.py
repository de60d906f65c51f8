"""Free rotation is right to the last digits at any time, for any body, as near to the separatrix as numbers go."""

from collections.abc import Callable
from itertools import permutations

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.dynamics.models.free.free_oracle import angle, errors, free_top, matrix

from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.free.motion import (
    ENSEMBLE_BLOCK,
    free_ensemble,
    free_motion,
    input_rounding,
    rounding,
    solve_free,
)
from inertia.errors import GeometryError, UsageError

DISTANT_TIMES = [0.0, 10.0, 1e6]
MILLION_TURNS = 2e6 * np.pi
SEPARATRIX = (4.0, 5.0, 9.0), (3.0, 2.0, 1.0)
"""4·1·3² = 9·4·1²: on the separatrix, in numbers that float64 holds."""


def check(
    moments: tuple[float, ...], spin: tuple[float, ...], times: list[float], limit: float, digits: int = 60
) -> None:
    for motion in (free_motion(moments, spin, times), one_by_one(moments, spin, times)):
        turned, off = errors(moments, spin, times, motion, digits)
        assert turned.max() < limit
        assert off.max() < limit
        assert (turned <= rounding(moments, spin, times)).all()
        assert np.linalg.norm(motion[0], axis=-1) == pytest.approx(1.0, abs=1e-15)


def one_by_one(moments: object, spin: object, times: object) -> tuple[np.ndarray, np.ndarray]:
    """Return what `free_motion` returns for all instants at once: the arithmetic on a single one is on floats."""
    attitude, omega = zip(*(free_motion(moments, spin, [t]) for t in times), strict=True)  # type: ignore
    return np.concatenate(attitude), np.concatenate(omega)


@pytest.mark.parametrize(
    "spin", [(1.0, 0.4, -0.3), (-0.2, 0.5, 1.3), (0.6, -1.0, 0.1), (0.0, 1.0, -0.9), (1.0, 0.2, 0)]
)
def test_error_does_not_grow_with_the_number_of_revolutions(spin: tuple[float, ...]) -> None:
    check((1.0, 1.7, 2.2), spin, [0.0, 1.0, -123.4, 1e3, MILLION_TURNS, 1e3 * MILLION_TURNS], 3e-15)


@pytest.mark.parametrize(
    ("moments", "spin"), [((0.1, 0.7, 0.75), (3.0, 2.0, 0.1)), ((1.0, 1.7, 2.2), (1.0, 0.4, -0.3))]
)
def test_half_periods_are_told_apart_beyond_the_whole_numbers_of_float64(
    moments: tuple[float, ...], spin: tuple[float, ...]
) -> None:
    check(moments, spin, np.linspace(1.1e16, 1e18, 12).tolist(), 1e-11)


@pytest.mark.parametrize("order", list(permutations(range(3))))
def test_moments_may_come_in_any_order(order: tuple[int, ...]) -> None:
    moments, spin = (1.0, 1.7, 2.2), (0.4, -0.8, 0.5)
    check(tuple(moments[k] for k in order), tuple(spin[k] for k in order), [3.0, -1e5], 3e-15)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("distance", [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14, 4e-16])
def test_digits_survive_next_to_the_separatrix(distance: float, side: int) -> None:
    moments, (x, y, z) = SEPARATRIX
    check(moments, (x * (1 + side * distance), y, z), [7.0, 60.0, 1e3], 2e-14)
    check(moments, (x * (1 + side * distance), y, z), [MILLION_TURNS], 1e-11)


def test_on_the_separatrix_the_body_ends_up_in_steady_rotation() -> None:
    check(*SEPARATRIX, [0.0, 1.0, -3.0, 30.0, MILLION_TURNS], 1e-14)
    _, omega = free_motion(*SEPARATRIX, [MILLION_TURNS])
    assert np.abs(omega[0, [0, 2]]).max() < 1e-300


@pytest.mark.parametrize("wobble", [1e-3, 1e-8, 1e-12, 1e-16, 1e-30])
def test_tiny_wobble_about_the_intermediate_axis_turns_the_body_over_in_time(wobble: float) -> None:
    check((1.0, 2.0, 3.0), (wobble, 1.0, -0.3 * wobble), [5.0, 70.0, 150.0, 1e3], 2e-14, digits=90)


@pytest.mark.parametrize("difference", [1e-3, 1e-8, 1e-12, 2.3e-16])
@pytest.mark.parametrize("third", [0.4, 1.9])
def test_nearly_symmetric_bodies_lose_nothing(third: float, difference: float) -> None:
    check((1.0, 1.0 + difference, third), (0.5, -0.7, 0.9), [10.0, 1e6], 3e-15)


def test_nearly_spherical_bodies_lose_nothing() -> None:
    check((1.0, 1.0 + 1e-12, 1.0 + 3e-12), (0.5, -0.7, 0.9), [10.0, 1e9], 3e-15)


@pytest.mark.parametrize("slender", [1e-4, 1e-8, 1e-12])
def test_needles_lose_nothing(slender: float) -> None:
    check((slender, 1.0, 1.0 + 0.5 * slender), (300.0, 1.0, 0.3), [10.0, 1e4], 3e-15)
    check((1.0, slender, 1.0 - 0.9 * slender), (0.1, -1e-3, 1.0), [10.0, 1e4], 3e-15)


@pytest.mark.parametrize("speed", [1e-300, 1e-6, 1e6, 1e200])
@pytest.mark.parametrize("size", [1e-200, 1e200])
def test_scale_of_spin_and_of_body_does_not_matter(size: float, speed: float) -> None:
    moments, spin = (1.7 * size, 1.0 * size, 2.2 * size), (0.4 * speed, -0.8 * speed, 0.5 * speed)
    check(moments, spin, [1e3 / speed, 1e6 / speed], 3e-15)


@settings(deadline=None, max_examples=60)
@given(
    st.tuples(*[st.floats(-12, 0)] * 3),
    st.tuples(*[st.floats(-12, 0)] * 3),
    st.tuples(*[st.sampled_from([1.0, -1.0])] * 3),
    st.floats(-2, 9),
)
def test_any_body_with_any_spin(
    extents: tuple[float, ...], magnitudes: tuple[float, ...], signs: tuple[float, ...], turns: float
) -> None:
    second = 10.0 ** np.array(extents)  # ∫x² dm, ∫y² dm, ∫z² dm: their sums in pairs are the moments of some body
    moments = second.sum() - second
    if len(set(moments.tolist())) < 3:
        return
    spin = np.array(signs) * 10.0 ** np.array(magnitudes)
    time = [10.0**turns / np.linalg.norm(spin)]
    turned, off = errors(moments, spin, time, free_motion(moments, spin, time), digits=90)
    estimate = rounding(moments, spin, time)
    assert turned[0] <= estimate[0] < 1e-9
    assert off[0] <= estimate[0]


def symmetric_top(moments: tuple[float, ...], axis: int, spin: tuple[float, ...], time: float) -> object:
    """Return the rotation of a symmetric top from its Euler angles: L along space axis 3, precession, tilt, own turn.

    φ' = G/I, θ constant, ψ' = G cosθ (1/I_s − 1/I) (textbook § 13.20); in the body frame in which ψ starts at zero.
    """
    momentum = [mp.mpf(i) * mp.mpf(w) for i, w in zip(moments, spin, strict=True)]
    across = [0 if k == axis else x for k, x in enumerate(momentum)]
    third = [mp.mpf(int(k == axis)) for k in range(3)]
    second = [x / mp.norm(across) for x in across]
    first = [second[k - 2] * third[k - 1] - second[k - 1] * third[k - 2] for k in range(3)]
    frame = mp.matrix([first, second, third]).T
    length = mp.norm(momentum)
    cosine, sine = momentum[axis] / length, mp.norm(across) / length
    tilt = mp.matrix([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]])
    i_s, i_t = mp.mpf(moments[axis]), mp.mpf(moments[axis - 1])
    precession, own = length / i_t * time, length * cosine * (1 / i_s - 1 / i_t) * time
    turns = [mp.matrix([[mp.cos(x), -mp.sin(x), 0], [mp.sin(x), mp.cos(x), 0], [0, 0, 1]]) for x in (precession, own)]
    return frame * tilt.T * turns[0] * tilt * turns[1] * frame.T


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("along", [1e-8, 0.3, 1.0 + 1e-12, 1.9])
def test_symmetric_tops_keep_their_digits_for_a_million_turns(along: float, axis: int) -> None:
    moments = tuple(along if k == axis else 1.0 for k in range(3))
    spin = (0.4, -0.8, 0.5)
    times = [0.0, 1.0, MILLION_TURNS, -1e3 * MILLION_TURNS]
    together, alone = free_motion(moments, spin, times), one_by_one(moments, spin, times)
    with mp.workdps(60):
        for t, q, w in zip(times * 2, np.concatenate([together[0], alone[0]]), [*together[1], *alone[1]], strict=True):
            true = symmetric_top(moments, axis, spin, t)
            assert angle(matrix(q.tolist()), true) < 2e-15
            momentum = true.T * mp.matrix([i * x for i, x in zip(moments, spin, strict=True)])
            expected = [float(x / i) for x, i in zip(momentum, moments, strict=True)]
            assert w == pytest.approx(expected, abs=2e-15)


@pytest.mark.parametrize(("moments", "spin"), [((2.0, 2.0, 2.0), (0.4, -0.8, 0.5)), ((1.0, 2.0, 3.0), (0, -0.7, 0))])
@pytest.mark.parametrize("motion_of", [free_motion, one_by_one])
def test_steady_rotation_is_about_the_axis_it_starts_about(
    moments: tuple[float, ...], spin: tuple[float, ...], motion_of: Callable[..., tuple[np.ndarray, np.ndarray]]
) -> None:
    attitude, omega = motion_of(moments, spin, [1.0, MILLION_TURNS])
    assert omega.tolist() == [list(map(float, spin))] * 2
    with mp.workdps(60):
        speed = mp.norm([mp.mpf(w) for w in spin])
        for q, t in zip(attitude, (1, mp.mpf(MILLION_TURNS)), strict=True):
            half = speed * t / 2
            true = [*(mp.sin(half) * mp.mpf(w) / speed for w in spin), mp.cos(half)]
            assert angle(matrix(q.tolist()), matrix(true)) < 2e-15


def test_a_rod_turns_uniformly_about_its_momentum_and_keeps_the_spin_about_itself() -> None:
    attitude, omega = free_motion((0.0, 1.0, 1.0), (5.0, 0.6, 0.8), np.linspace(0, 3, 7))
    rod = quaternion.to_space(attitude, (1.0, 0.0, 0.0))
    t = np.linspace(0, 3, 7)
    assert rod == pytest.approx(np.stack([np.cos(t), 0.8 * np.sin(t), -0.6 * np.sin(t)], axis=-1), abs=1e-15)
    assert omega[:, 0].tolist() == [5.0] * 7
    momentum = quaternion.to_space(attitude, omega * (0.0, 1.0, 1.0))
    assert momentum == pytest.approx(np.tile((0.0, 0.6, 0.8), (7, 1)), abs=1e-15)


def test_a_body_at_rest_stays() -> None:
    attitude, omega = free_motion((1.0, 2.0, 3.0), (0.0, 0.0, 0.0), [0.0, 1e9])
    assert attitude.tolist() == [[0.0, 0.0, 0.0, 1.0]] * 2
    assert not omega.any()


moderate = st.tuples(*[st.floats(0.1, 1.0)] * 3).filter(lambda second: len(set(second)) == 3)
spins = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda spin: np.linalg.norm(spin) > 0.1)


@settings(deadline=None, max_examples=40)
@given(moderate, spins, st.integers(-1000, 1000), st.integers(-1000, 1000))
def test_two_legs_are_one_way(second: tuple[float, ...], spin: tuple[float, ...], one: int, other: int) -> None:
    """The second leg starts from the rounded end of the first, which its own condition magnifies."""
    moments = sum(second) - np.array(second)
    attitude, omega = free_motion(moments, spin, [one, one + other])
    onward, arrived = free_motion(moments, omega[0], [other])
    slack = 1e-14 + 10 * float(input_rounding(moments, omega[0], [other])[0])
    assert quaternion.angle_between(quaternion.multiply(attitude[0], onward[0]), attitude[1]) < slack
    assert arrived[0] == pytest.approx(omega[1], abs=slack)


@settings(deadline=None, max_examples=40)
@given(moderate, spins)
def test_a_motion_starts_from_what_was_given(second: tuple[float, ...], spin: tuple[float, ...]) -> None:
    for times in ([0.0], [-1.0, 0.0, 2.0]):
        attitude, omega = free_motion(sum(second) - np.array(second), spin, times)
        begun = times.index(0.0)
        assert attitude[begun].tolist() == [0.0, 0.0, 0.0, 1.0]
        assert omega[begun] == pytest.approx(spin, rel=0, abs=1e-69)  # below this a component is none


@settings(deadline=None, max_examples=40)
@given(moderate, spins, st.floats(0, 1e3))
def test_a_reversed_spin_runs_the_motion_backwards(
    second: tuple[float, ...], spin: tuple[float, ...], time: float
) -> None:
    moments = sum(second) - np.array(second)
    backwards, omega = free_motion(moments, -np.array(spin), [time])
    attitude, before = free_motion(moments, spin, [-time])
    slack = 2.0 * float(rounding(moments, spin, [time])[0])  # two answers, each as far off as it says
    assert quaternion.angle_between(backwards[0], attitude[0]) < slack
    assert omega[0] == pytest.approx(-before[0], abs=1e-14)


@settings(deadline=None, max_examples=40)
@given(moderate, spins, st.sampled_from([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]))
def test_half_a_turn_of_the_axes_changes_nothing_but_signs(
    second: tuple[float, ...], spin: tuple[float, ...], signs: tuple[int, ...]
) -> None:
    moments, times = sum(second) - np.array(second), [3.0, 1e6]
    attitude, omega = free_motion(moments, spin, times)
    turned, turned_omega = free_motion(moments, np.array(signs) * spin, times)
    assert quaternion.angle_between(turned * (*signs, 1), attitude).max() < 1e-14
    assert turned_omega == pytest.approx(omega * signs, abs=1e-14)


@settings(deadline=None, max_examples=40)
@given(moderate, spins)
def test_momentum_in_space_and_energy_are_kept_to_rounding(second: tuple[float, ...], spin: tuple[float, ...]) -> None:
    moments = sum(second) - np.array(second)
    attitude, omega = free_motion(moments, spin, np.linspace(0, 1e7, 50))
    momentum = quaternion.to_space(attitude, moments * omega)
    assert momentum == pytest.approx(np.tile(moments * spin, (50, 1)), abs=5e-15 * np.linalg.norm(moments * spin))
    energy = (moments * omega**2).sum(axis=-1)
    assert energy == pytest.approx(np.full(50, (moments * np.square(spin)).sum()), rel=5e-15)


def test_attitude_varies_smoothly_from_sample_to_sample() -> None:
    attitude, _ = free_motion((1.0, 2.0, 3.0), (1e-3, 1.0, 0.0), np.linspace(0, 100, 5001))
    assert np.abs(np.diff(attitude, axis=0)).max() < 0.02


def test_bodies_of_all_kinds_go_together() -> None:
    moments = np.array([[1, 2, 3], [2, 2, 1], [1, 1, 1], [0, 1, 1], [3, 1, 2], [1, 2, 3]], dtype=float)
    spin = np.array([[1, 1, 1], [1, 0, 1], [1, 2, 3], [1, 1, 0], [1e-9, 0, 1], [0, 1, 0]], dtype=float)
    times = np.arange(12.0).reshape(6, 2) * 100
    attitude, omega = free_motion(moments, spin, times)
    assert attitude.shape == (6, 2, 4)
    for k in range(6):
        for alone in (free_motion(moments[k], spin[k], times[k]), one_by_one(moments[k], spin[k], times[k])):
            assert quaternion.angle_between(attitude[k], alone[0]).max() < 3e-15
            assert omega[k] == pytest.approx(alone[1], abs=3e-15)
    assert free_motion(moments.reshape(2, 3, 3), spin.reshape(2, 3, 3), [1.0])[0].shape == (2, 3, 1, 4)
    assert free_motion((1, 2, 3), spin, [1.0, 2.0])[1].shape == (6, 2, 3)


def test_long_series_are_worked_on_in_blocks() -> None:
    times = np.linspace(0, 1e4, 40_000)
    attitude, _ = free_motion((1.0, 2.0, 3.0), (0.3, 1.0, 0.2), times)
    some = slice(16_380, 16_390)
    assert (
        quaternion.angle_between(attitude[some], free_motion((1.0, 2.0, 3.0), (0.3, 1.0, 0.2), times[some])[0]).max()
        < 1e-15
    )


@pytest.mark.parametrize(
    ("moments", "spin", "time", "error", "words"),
    [
        ((1, 2, np.nan), (1, 0, 0), [1], UsageError, "moments holds a value that is not finite"),
        ((1, 2, 3), (1, np.inf, 0), [1], UsageError, "angular_velocity holds a value that is not finite"),
        ((1, 2, 3), (1, 0), [1], UsageError, "angular_velocity has shape (2,)"),
        ((1, 2, 3), [(1, 0, 0), (0, np.nan, 0)], [1], UsageError, "angular_velocity[1]"),
        ([(1, 2, 3)] * 2, [(1, 0, 0)] * 3, [1], UsageError, "do not broadcast"),
        ((1, 2, 3), (1, 0, 0), 1.0, UsageError, "give the instants as an array"),
        ((1, 2, 3), (1, 0, 0), [0, np.nan], UsageError, "time[1] is not finite"),
        ((1, 2, 3), [(1, 0, 0)] * 2, [[0], [1], [2]], UsageError, "time has shape (3, 1)"),
        ((1, 2, 3), (1, 0, 0), [0, 1e30], UsageError, "1e+30 s, more than 1e+20 rad"),
        ((1, 2, 4), (1, 0, 0), [1], GeometryError, "above the sum of the other two"),
        ((-1, 2, 2), (1, 0, 0), [1], GeometryError, "none may be negative"),
        ((0, 0, 0), (1, 0, 0), [1], GeometryError, "nor all zero"),
        ([(1, 2, 3), (0, 0, 1)], (1, 0, 0), [1], GeometryError, "moments[1] are [0.0, 0.0, 1.0] kg m²"),
    ],
)
def test_bad_input_is_named(moments: object, spin: object, time: object, error: type[Exception], words: str) -> None:
    with pytest.raises(error) as raised:
        free_motion(moments, spin, time)  # type: ignore[arg-type]
    assert words in str(raised.value)


def perturbed(moments: np.ndarray, spin: np.ndarray, time: float) -> float:
    """Return what one rounding of each input does, by the oracle: forward differences of 2⁻⁵²."""
    (true, _), *_ = free_top(moments, spin, [time])
    total, step = 0.0, 2.0**-52
    for k in range(3):
        for i, w in ((moments.copy(), spin), (moments, spin.copy())):
            if i is not moments:
                i[k] *= 1 + step
            else:
                w[k] += step * np.abs(spin).max()
            (moved, _), *_ = free_top(i, w, [time])
            total += angle(moved, true) ** 2
    return float(np.sqrt(total))


@pytest.mark.parametrize(
    ("spin", "time"), [((1.0, 0.4, -0.3), 1e4), ((1e-6, 1.0, 1e-6), 75.0), ((1e-9, 1.0, 0.3e-9), 110.0)]
)
def test_condition_is_what_one_rounding_of_the_input_does(spin: tuple[float, ...], time: float) -> None:
    moments = np.array([1.0, 1.7, 2.2])
    assert input_rounding(moments, spin, [time])[0] == pytest.approx(perturbed(moments, np.array(spin), time), rel=0.1)


def test_motion_keeps_its_invariants_and_tells_its_flips() -> None:
    time = np.linspace(0, 60, 601)
    motion = solve_free((1.0, 2.0, 3.0), (1e-3, 10.0, 0.0), time)
    assert motion.invariants["energy"] == pytest.approx(np.full(601, 100.0000005), rel=5e-15)
    assert motion.invariants["angular momentum"] == pytest.approx(np.tile((1e-3, 20.0, 0.0), (601, 1)), abs=5e-14)
    assert motion.reached < 1e-13
    assert motion.steps == 0
    changes = np.flatnonzero(np.diff(np.sign(motion.angular_velocity[:, 1])))
    assert [event.name for event in motion.events] == ["flip"] * len(changes)
    for event, k in zip(motion.events, changes, strict=True):
        assert time[k] <= event.time <= time[k + 1]
    assert not motion.warnings


def test_a_body_that_does_not_tumble_has_no_flips() -> None:
    assert not solve_free((1.0, 2.0, 3.0), (0.1, 0.1, 1.0), [0.0, 100.0]).events


def test_motion_too_close_to_the_separatrix_for_its_inputs_warns() -> None:
    motion = solve_free((1.0, 2.0, 3.0), (1e-12, 1.0, 0.0), np.linspace(0, 200, 11))
    assert "grow at 0.577 1/s" in motion.warnings[0]


@pytest.mark.parametrize(
    ("moments", "spin", "end", "unstable"),
    [
        ((1.0, 2.0, 3.0), (0.0, 1.0, 0.0), 60.0, True),
        ((3.0, 1.0, 2.0), (1e-300, 0.0, -1.0), -60.0, True),
        ((1.0, 2.0, 3.0), (0.0, 1.0, 0.0), 1.5, False),  # too short for a disturbance to grow
        ((1.0, 2.0, 3.0), (0.0, 0.0, 1.0), 60.0, False),
        ((1.0, 2.0, 3.0), (1.0, 0.0, 0.0), 60.0, False),
        ((2.0, 2.0, 3.0), (0.0, 1.0, 0.0), 60.0, False),
        ((2.0, 2.0, 2.0), (1.0, 2.0, 1.0), 60.0, False),
        ((1.0, 2.0, 3.0), (0.0, 0.0, 0.0), 60.0, False),
    ],
)
def test_a_steady_spin_about_the_intermediate_axis_is_said_to_be_unstable(
    moments: tuple[float, ...], spin: tuple[float, ...], end: float, unstable: bool
) -> None:
    """Linearised, a wobble grows at ω √((I2 − I1)(I3 − I2)/(I1 I3)) = 1/√3 per second: by e in 1.73 s."""
    warnings = solve_free(moments, spin, [0.0, end]).warnings
    assert len(warnings) == unstable
    assert all("unstable" in says and "grows by a factor e in 1.73 s" in says for says in warnings)


@pytest.mark.parametrize(
    ("equal", "moments", "spin"),
    [
        (2, (1.0, 1.0 + 1e-9, 1.8), (0.3, 0.1, 1.0)),
        (3, (1.0, 1.0 + 1e-9, 1.0 - 2e-9), (0.3, 0.1, 1.0)),
        (3, (1.0, 2.0, 3.0), (1e-9, 2e-9, 1.0)),
    ],
)
def test_a_model_simpler_than_the_body_owns_up_to_what_it_costs(
    equal: int, moments: tuple[float, ...], spin: tuple[float, ...]
) -> None:
    motion = solve_free(moments, spin, [0.0, 10.0], equal)
    turned, _ = errors(moments, spin, [0.0, 10.0], (motion.attitude, motion.angular_velocity))
    assert 1e-10 < turned.max() <= motion.reached < 1.01 * turned.max()


def test_a_model_that_fits_costs_rounding() -> None:
    for equal, moments in ((2, (1.0, 2.0, 1.0)), (3, (2.0, 2.0, 2.0))):
        assert solve_free(moments, (1.0, 2.0, 3.0), [0.0, 1e9], equal).reached < 3e-15
    assert solve_free((1.0, 2.0, 3.0), (0.0, 2.0, 0.0), [0.0, 1e9], 3).reached < 3e-15


def test_another_number_of_equal_moments_is_refused() -> None:
    with pytest.raises(UsageError, match="equal is 4: take 1, 2 or 3 moments as equal"):
        solve_free((1, 2, 3), (1, 0, 0), [1.0], 4)


def random_bodies(count: int) -> tuple[np.ndarray, np.ndarray]:
    chance = np.random.default_rng(7)
    second = chance.random((count, 3)) + 0.01
    return second.sum(axis=-1, keepdims=True) - second, chance.normal(size=(count, 3))


def test_each_body_moves_as_it_does_alone() -> None:
    moments, spins = random_bodies(2 * ENSEMBLE_BLOCK + 100)
    attitude, omega = free_ensemble(moments, spins, DISTANT_TIMES)
    assert attitude.shape == (len(spins), 3, 4)
    for k in (0, 1, ENSEMBLE_BLOCK - 1, ENSEMBLE_BLOCK, len(spins) - 1):
        alone = free_motion(moments[k], spins[k], DISTANT_TIMES)
        assert quaternion.angle_between(attitude[k], alone[0]).max() < 3e-15
        assert omega[k] == pytest.approx(alone[1], abs=3e-15)


def test_momentum_in_space_is_kept_by_all() -> None:
    moments, spins = random_bodies(5000)
    attitude, omega = free_ensemble(moments, spins, DISTANT_TIMES)
    momentum = quaternion.to_space(attitude, moments[:, None] * omega)
    drift = np.linalg.norm(momentum - (moments * spins)[:, None], axis=-1)
    assert (drift / np.linalg.norm(moments * spins, axis=-1)[:, None]).max() < 4e-15


def test_one_body_with_many_spins_and_progress() -> None:
    _, spins = random_bodies(ENSEMBLE_BLOCK + 1)
    shares: list[float] = []
    _, omega = free_ensemble((1.0, 2.0, 2.5), spins, [0.0], shares.append)
    assert omega[:, 0] == pytest.approx(spins, abs=3e-15)
    assert shares == [pytest.approx(ENSEMBLE_BLOCK / len(spins)), 1.0]


@pytest.mark.parametrize(
    ("moments", "spins", "time"),
    [
        ((1, 2, 3), (1, 0, 0), [1.0]),
        ((1, 2, 3), [(1, 0, 0)], 1.0),
        ([(1, 2, 3)], [(1, 0, 0)] * 2, [1.0]),
    ],
)
def test_shapes_that_are_no_ensemble_are_refused(moments: object, spins: object, time: object) -> None:
    with pytest.raises(UsageError, match="an ensemble takes"):
        free_ensemble(moments, spins, time)  # type: ignore[arg-type]


def test_a_body_that_cannot_be_is_named() -> None:
    moments, spins = random_bodies(10)
    moments[7] = 1.0, 1.0, 3.0
    with pytest.raises(GeometryError, match=r"moments\[7\]"):
        free_ensemble(moments, spins, DISTANT_TIMES)
