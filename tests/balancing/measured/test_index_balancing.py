"""Rotor and tooling told apart by turning one on the other."""

import numpy as np
import pytest
from tests.balancing.rotors import at

from inertia import UsageError
from inertia.balancing.measured.index_balancing import index_balancing


def test_case_13_index_balancing_at_a_half_turn():
    split = index_balancing([at(32.460, 90.73), at(50.954, 236.97)], [0.0, np.pi])
    assert abs(split.rotor) == pytest.approx(40, abs=2e-3)
    assert np.degrees(np.angle(split.rotor)) == pytest.approx(70, abs=5e-3)
    assert abs(split.tooling) == pytest.approx(15, abs=5e-3)
    assert np.degrees(np.angle(split.tooling)) % 360 == pytest.approx(200, abs=0.02)
    assert split.scatter is None


@pytest.mark.parametrize("degrees", [[0, 90], [0, 120, 240], [0, 45, 200, 300, 310]])
def test_any_positions_in_any_number_of_planes(degrees):
    rotor, tooling = np.array([at(40, 70), at(3, 250)]), np.array([at(15, 200), at(1, 10)])
    turned = np.radians(degrees)
    split = index_balancing([tooling + rotor * np.exp(1j * k) for k in turned], turned)
    assert split.rotor == pytest.approx(rotor)
    assert split.tooling == pytest.approx(tooling)
    if len(degrees) > 2:
        assert split.scatter == pytest.approx(np.zeros(2), abs=1e-12)


def test_scatter_is_that_of_the_readings():
    random = np.random.default_rng(5)
    turned = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
    noise = random.normal(0, 0.3, (2, 2000))
    split = index_balancing(5 + 40 * np.exp(1j * turned) + noise[0] + 1j * noise[1], turned)
    assert split.scatter == pytest.approx(0.3 * np.sqrt(2), rel=0.05)


@pytest.mark.parametrize(
    ("measured", "positions", "text"),
    [
        ([1.0], [0.0], "one position"),
        ([1.0, 2.0], [0.0, 2 * np.pi], "too close"),
        ([1.0, 2.0], [0.0, 0.05], "too close"),
        ([1.0, 2.0], [0.0], "shape"),
    ],
)
def test_positions_that_tell_nothing_are_refused(measured, positions, text):
    with pytest.raises(UsageError, match=text):
        index_balancing(measured, positions)
