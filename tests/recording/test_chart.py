"""Charts of what is no function of time."""

from inertia.recording.chart import Chart, ticks


def test_charts_put_their_corners_into_the_corners() -> None:
    chart = Chart("chart", 1.0, 3.0, -2.0, 2.0)
    assert chart.at([1.0, 3.0, 2.0], [-2.0, 2.0, 0.0]).tolist() == [[0.0, 100.0], [160.0, 0.0], [80.0, 50.0]]
    assert ticks(0.52, 0.57) == [0.52, 0.53, 0.54, 0.55, 0.56, 0.57]
    assert ticks(-3e-4, 2e-4) == [-3e-4, -2e-4, -1e-4, 0.0, 1e-4, 2e-4]
