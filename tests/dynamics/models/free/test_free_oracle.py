"""The closed form that the free top is held against agrees with a Taylor integrator that knows no closed form."""

import mpmath as mp
import pytest
from tests.dynamics.models.free.free_oracle import angle, free_top, matrix
from tests.dynamics.oracle import rotate


@pytest.mark.parametrize(
    ("moments", "angular_velocity", "times"),
    [
        ((1.0, 2.0, 2.5), (0.3, 1.0, -0.7), [0.0, 9.0]),
        ((2.5, 1.0, 2.0), (-1.0, -0.4, 0.1), [1.0, 9.0]),
        ((4.0, 5.0, 9.0), (3.0, -2.0, -1.0), [1.0, 5.0]),  # on the separatrix
        ((1.0, 2.0, 3.0), (1e-8, 1.0, 1e-9), [10.0, 50.0]),  # turns over on the way
    ],
)
def test_closed_form_and_taylor_series_agree(
    moments: tuple[float, ...], angular_velocity: tuple[float, ...], times: list[float]
) -> None:
    taylor = rotate(moments, angular_velocity, times)
    for (rotation, omega), attitude, expected in zip(
        free_top(moments, angular_velocity, times), taylor.attitude, taylor.angular_velocity, strict=True
    ):
        with mp.workdps(60):
            assert angle(rotation, matrix(attitude)) < 1e-28
            assert max(abs(x - y) for x, y in zip(omega, expected, strict=True)) < 1e-28
