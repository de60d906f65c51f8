"""Colours that can be seen on both themes and told apart by everybody: WCAG contrast, simulated vision, CIEDE2000."""

from itertools import combinations

import numpy as np
import pytest
from numpy.typing import NDArray

from inertia.palette import BRIGHT, COLORS, DARK, WHITE, rgb

VISION = {  # G. M. Machado et al., IEEE Trans. Visualization Comput. Graph. 15 (2009) 1291, severity 1; linear RGB
    "normal": np.eye(3),
    "protanope": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranope": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritanope": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}
XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
D65 = np.array([0.95047, 1.0, 1.08883])
PLATE = "#767676"
"""Of a label on dark ground, where Rerun's theme is light."""


def linear(color: str) -> NDArray[np.float64]:
    share = np.array(rgb(color)) / 255.0
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def contrast(color: str, ground: str) -> float:
    """WCAG 2.1."""
    low, high = sorted(float(linear(each) @ [0.2126, 0.7152, 0.0722]) for each in (color, ground))
    return (high + 0.05) / (low + 0.05)


def lab(color: str, vision: str) -> NDArray[np.float64]:
    seen = XYZ @ np.clip(np.asarray(VISION[vision]) @ linear(color), 0.0, 1.0) / D65
    x, y, z = np.where(seen > 216 / 24389, np.cbrt(seen), (24389 / 27 * seen + 16) / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def difference(p: NDArray[np.float64], q: NDArray[np.float64]) -> float:
    """CIEDE2000: G. Sharma et al., Color Res. Appl. 30 (2005) 21."""
    mean = 0.5 * (np.hypot(*p[1:]) + np.hypot(*q[1:]))
    stretch = 1.5 - 0.5 * np.sqrt(mean**7 / (mean**7 + 25.0**7))
    first, second = (complex(stretch * each[1], each[2]) for each in (p, q))
    light, chroma = 0.5 * (p[0] + q[0]), 0.5 * (abs(first) + abs(second))
    turn = np.angle(second * first.conjugate())
    hue = np.angle(first) + 0.5 * turn
    weight = (
        1.0
        - 0.17 * np.cos(hue - np.radians(30))
        + 0.24 * np.cos(2 * hue)
        + 0.32 * np.cos(3 * hue + np.radians(6))
        - 0.20 * np.cos(4 * hue - np.radians(63))
    )
    in_light = (q[0] - p[0]) / (1 + 0.015 * (light - 50) ** 2 / np.sqrt(20 + (light - 50) ** 2))
    in_chroma = (abs(second) - abs(first)) / (1 + 0.045 * chroma)
    in_hue = 2 * np.sqrt(abs(first) * abs(second)) * np.sin(0.5 * turn) / (1 + 0.015 * chroma * weight)
    blue = np.radians(60) * np.exp(-(((np.degrees(hue) % 360 - 275) / 25) ** 2))
    rotation = -2 * np.sqrt(chroma**7 / (chroma**7 + 25.0**7)) * np.sin(blue)
    return float(np.sqrt(in_light**2 + in_chroma**2 + in_hue**2 + rotation * in_chroma * in_hue))


@pytest.mark.parametrize(
    ("p", "q", "expected"),
    [  # Sharma et al., table 1: pairs 1, 7, 17, 24
        ((50.0, 2.6772, -79.7751), (50.0, 0.0, -82.7485), 2.0425),
        ((50.0, 0.0, 0.0), (50.0, -1.0, 2.0), 2.3669),
        ((50.0, 2.5, 0.0), (73.0, 25.0, -18.0), 27.1492),
        ((50.0, 2.5, 0.0), (50.0, 3.2592, 0.3350), 1.0),
    ],
)
def test_the_difference_of_colours_is_that_of_the_paper(
    p: tuple[float, ...], q: tuple[float, ...], expected: float
) -> None:
    assert difference(np.array(p), np.array(q)) == pytest.approx(expected, abs=6e-5)


@pytest.mark.parametrize("ground", [WHITE, DARK])
@pytest.mark.parametrize("color", COLORS)
def test_every_colour_is_seen_on_both_themes(color: str, ground: str) -> None:
    assert contrast(color, ground) >= 3.0


@pytest.mark.parametrize("color", BRIGHT)
def test_bright_colours_are_seen_on_dark_ground(color: str) -> None:
    assert contrast(color, DARK) >= 5.0


def test_labels_are_read_on_their_plates() -> None:
    assert contrast(WHITE, PLATE) >= 4.5
    assert contrast(WHITE, DARK) >= 4.5


@pytest.mark.parametrize("vision", VISION)
@pytest.mark.parametrize(("colors", "least"), [(COLORS, 11.0), (BRIGHT, 10.5)], ids=["series", "bright"])
def test_any_two_colours_are_told_apart(vision: str, colors: tuple[str, ...], least: float) -> None:
    for one, other in combinations(colors, 2):
        assert difference(lab(one, vision), lab(other, vision)) >= least, (one, other)
