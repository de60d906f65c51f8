"""Periods and flips of free bodies."""

import mpmath as mp
import numpy as np
import pytest
from tests.dynamics.models.free.free_oracle import free_top

from inertia.dynamics.models.free.flips import flip_period, flip_times, polhode_period, tumbles
from inertia.dynamics.models.free.motion import free_motion
from inertia.errors import GeometryError, UsageError


def true_period(moments: tuple[float, ...], spin: tuple[float, ...]) -> float:
    """Return 4 K/λ for ascending moments (Landau & Lifshitz, Mechanics, eq. 37.12)."""
    with mp.workdps(60):
        (a, b, c), w = (mp.matrix([mp.mpf(x) for x in row]) for row in (moments, spin))
        energy, square = a * w[0] ** 2 + b * w[1] ** 2 + c * w[2] ** 2, mp.norm([a * w[0], b * w[1], c * w[2]]) ** 2
        if square < energy * b:
            a, c = c, a
        m = (b - a) * (energy * c - square) / ((c - b) * (square - energy * a))
        return float(4 * mp.ellipk(m) * mp.sqrt(a * b * c / ((c - b) * (square - energy * a))))


@pytest.mark.parametrize(
    "spin",
    [(1.0, 0.4, 0.3), (0.2, 0.5, 1.3), (1e-3, 10.0, 0.0), (0.0, 1.0, 1e-9), (1e-20, -1.0, 1e-21), (0.0, 1e6, 3e6)],
)
def test_period_is_the_complete_integral(spin: tuple[float, ...]) -> None:
    moments = (1.0, 1.7, 2.2)
    assert polhode_period(moments, spin).item() == pytest.approx(true_period(moments, spin), rel=1e-15)
    assert flip_period(moments, spin).item() == pytest.approx(0.5 * true_period(moments, spin), rel=1e-15)


def test_period_of_a_symmetric_top_is_that_of_its_body_precession() -> None:
    """Ω = (I3 − I1) ω3/I1 (textbook § 13.20); a lamina's is ω3, Feynman's plate."""
    assert polhode_period((1.0, 1.0, 2.0), (0.1, 0.0, 5.0)).item() == pytest.approx(2 * np.pi / 5.0, rel=1e-15)
    assert polhode_period((0.5, 2.0, 2.0), (4.0, 0.1, 0.0)).item() == pytest.approx(2 * np.pi / 3.0, rel=1e-15)


@pytest.mark.parametrize(
    ("moments", "spin"),
    [
        ((1.0, 2.0, 3.0), (0.0, 1.0, 0.0)),  # a principal axis
        ((2.0, 2.0, 2.0), (1.0, 1.0, 0.0)),
        ((2.0, 2.0, 1.0), (1.0, 1.0, 0.0)),  # across the symmetry axis
        ((4.0, 5.0, 9.0), (3.0, 2.0, 1.0)),  # on the separatrix
        ((1.0, 2.0, 3.0), (0.0, 0.0, 0.0)),
    ],
)
def test_what_does_not_recur_has_no_period(moments: tuple[float, ...], spin: tuple[float, ...]) -> None:
    assert polhode_period(moments, spin).item() == np.inf


def test_period_passes_continuously_from_a_nearly_symmetric_top_to_a_symmetric_one() -> None:
    moments, spin = np.array([[1.0, 1.0, 2.0], [1.0, 1.0 + 1e-13, 2.0]]), (0.3, 0.4, 1.0)
    one, other = polhode_period(moments, spin)
    assert other == pytest.approx(one, rel=1e-12)


def test_map_of_periods_is_that_of_its_points() -> None:
    spins = np.random.default_rng(4).normal(size=(130, 140, 3))
    periods = flip_period((1.0, 2.0, 2.5), spins)
    assert periods.shape == (130, 140)
    for place in ((0, 0), (64, 7), (129, 139)):
        assert periods[place] == pytest.approx(flip_period((1.0, 2.0, 2.5), spins[place]), rel=1e-15)


@pytest.mark.parametrize("spin", [(1e-3, 10.0, 0.0), (0.0, 10.0, -1e-3), (-1e-9, -5.0, 2e-9), (1.0, 0.0, 0.5)])
def test_spin_about_the_intermediate_axis_vanishes_at_every_flip_and_nowhere_else(spin: tuple[float, ...]) -> None:
    moments = (3.0, 2.0, 1.5)
    flips = flip_times(moments, spin, 40.0)
    for (_, omega), t in zip(free_top(moments, spin, flips.tolist()), flips, strict=True):
        assert abs(float(omega[1])) < 1e-14 * max(map(abs, spin)) * (1 + t)
    _, omega = free_motion(moments, spin, np.linspace(1e-6, 40.0, 20_001))
    assert np.count_nonzero(np.diff(np.sign(omega[:, 1]))) == len(flips) > 0


def test_no_flips_where_there_is_no_intermediate_axis_or_no_time() -> None:
    assert flip_times((1.0, 1.0, 2.0), (0.1, 0.2, 1.0), 100.0).size == 0
    assert flip_times((1.0, 2.0, 3.0), (0.0, 1.0, 0.0), 100.0).size == 0
    assert flip_times((4.0, 5.0, 9.0), (3.0, 2.0, 1.0), 1e6).size == 0  # the separatrix leads to steady rotation
    assert flip_times((1.0, 2.0, 3.0), (0.1, 1.0, 0.0), 0.0).size == 0


def test_flips_keep_their_digits_after_a_million_turns() -> None:
    moments, spin = (1.0, 1.7, 2.2), (0.1, 1.0, 0.2)
    flips = flip_times(moments, spin, 1e6)
    ((_, omega),) = free_top(moments, spin, flips[-1:].tolist())
    assert abs(float(omega[1])) < 3e-10  # the spacing of float64 at 1e6 s
    assert len(flips) == pytest.approx(2e6 / true_period(moments, spin), abs=1)


def test_too_many_flips_and_more_than_one_body_are_refused() -> None:
    with pytest.raises(UsageError, match=r"flips .* times in 1e\+09 s"):
        flip_times((1.0, 2.0, 3.0), (0.1, 1.0, 0.0), 1e9)
    with pytest.raises(UsageError, match="one body, not"):
        flip_times((1.0, 2.0, 3.0), [(0.1, 1.0, 0.0)] * 2, 1.0)
    with pytest.raises(GeometryError, match="sum of the other two"):
        flip_period((1.0, 2.0, 4.0), (0.1, 1.0, 0.0))


def test_bodies_that_pass_near_both_ends_of_the_intermediate_axis_tumble() -> None:
    spins = [(1e-3, 1.0, 0.0), (1.0, 1e-3, 1e-3), (0.1, 0.1, 1.0), (0.0, 1.0, 0.0), (0.5, 1.0, 0.4)]
    _, omega = free_motion((1.0, 2.0, 3.0), spins, np.linspace(0, 60, 6001))
    momentum = omega * (1.0, 2.0, 3.0)
    cosine = momentum[..., 1] / np.linalg.norm(momentum, axis=-1)
    both = (cosine.max(axis=-1) > np.sqrt(0.5)) & (cosine.min(axis=-1) < -np.sqrt(0.5))
    assert tumbles((1.0, 2.0, 3.0), spins).tolist() == both.tolist()
    assert not tumbles((4.0, 5.0, 9.0), (3.0, 2.0, 1.0))
