"""The closed forms in the catalogue, against textbook formulas, refined meshes and published numbers."""

from fractions import Fraction
from math import pi

import numpy as np
import pytest

import inertia_meshes
from inertia_meshes import solids
from inertia_meshes.rational import Moments, moments

SAMPLES = inertia_meshes.catalogue()


def body_of_revolution(volume: float, polar: float, across: float) -> dict:
    return {"volume": volume, "inertia": np.diag([across, across, polar]) * volume}


TEXTBOOK = {  # millimetres, unit density
    "cube.stl": {"volume": 1000, "inertia": np.eye(3) * 1000 * 100 / 6},
    "box.stl": {"volume": 8000, "inertia": np.diag([400 + 100, 1600 + 100, 1600 + 400]) * 8000 / 12},
    "tetrahedron.stl": {
        "volume": 1000,
        "inertia": 1000 * 3 / 80 * np.array([(500, 200, 100), (200, 1000, 200 / 3), (100, 200 / 3, 1300)]),
    },
    "sphere.stl": body_of_revolution(4 / 3 * pi * 8000, 160, 160),
    "ellipsoid.stl": {"volume": 8000 * pi, "inertia": np.diag([500, 1000, 1300]) * 1600 * pi},
    "cone.stl": body_of_revolution(1000 * pi, 30, 3 / 20 * 100 + 3 / 80 * 900),
    "hollow_sphere.stl": body_of_revolution(
        4 / 3 * pi * (20**3 - 16**3), *[2 / 5 * (20**5 - 16**5) / (20**3 - 16**3)] * 2
    ),
    "torus.stl": body_of_revolution(2 * pi**2 * 500, 400 + 75 / 4, 200 + 125 / 8),
    "disc.stl": body_of_revolution(pi * 2048, 512, (3 * 1024 + 4) / 12),
    "thin_plate.stl": {
        "volume": 1536,
        "inertia": np.diag([96**2 + 2**-6, 128**2 + 2**-6, 128**2 + 96**2]) * 128,
    },
}


@pytest.mark.parametrize("name", TEXTBOOK)
def test_closed_forms_of_simple_solids_are_the_textbook_ones(name: str) -> None:
    true, expected = SAMPLES[name]["closed_form"], TEXTBOOK[name]
    assert true["volume"] == pytest.approx(expected["volume"] * 1e-9, rel=1e-14)
    assert np.array(true["inertia"]) == pytest.approx(expected["inertia"] * 1e-15, rel=1e-14, abs=0)


@pytest.mark.parametrize(
    "solid",
    [
        lambda n: solids.ellipsoid(30, 20, 10, n),
        lambda n: solids.hollow_ball(20, 8, (6, 4, 2), n),
        lambda n: solids.torus(20, 5, 2 * n),
        lambda n: solids.revolution([(0, 0), (4, 4), (24, 16), (24, 22), (4, 28), (3, 44), (0, 44)], n),
        solids.t_handle,
        solids.bent_wheel,
        solids.two_disc_rotor,
        solids.impeller_shaft,
        solids.impeller,
    ],
    ids=["ellipsoid", "cavity", "torus", "top", "t_handle", "bent_wheel", "rotor", "shaft", "impeller"],
)
def test_closed_forms_are_the_limit_of_the_refined_meshes(solid) -> None:
    """Two Richardson steps remove the errors of order 1/n² and 1/n⁴."""
    true = solid(32).true
    size = float(true.volume) ** (1 / 3)

    def scaled(integral: Moments) -> np.ndarray:
        first, second = np.array(integral.first, float), np.array(integral.second, float)
        return np.array([float(integral.volume) / size**3, *(first / size**4), *(second / size**5)])

    coarse, middle, fine = (scaled(moments(solid(n).corners)) for n in (48, 96, 192))
    assert (64 * fine - 20 * middle + coarse) / 45 == pytest.approx(scaled(true), rel=1e-7, abs=1e-7)


def unbalance(name: str, density: float) -> tuple[float, complex, complex, float]:
    """Mass (kg), static unbalance (g·mm), couple about the centre of mass (g·mm²) and the centre's z (mm)."""
    mesh = SAMPLES[name]["mesh"]
    mass = density * mesh["volume"] * 1e-9
    x, y, z = mesh["center_of_mass"]
    inertia = np.array(mesh["inertia"]) * density * 1e-6
    return mass, 1000 * mass * complex(x, y), -complex(inertia[0, 2], inertia[1, 2]), z


def polar(value: complex) -> tuple[float, float]:
    return abs(value), np.degrees(np.angle(value)) % 360


def test_the_two_disc_rotor_is_the_published_one() -> None:
    mass, static, couple, z = unbalance("two_disc_rotor.stl", 7850)
    assert mass == pytest.approx(11.014, abs=5e-4)
    assert polar(static) == pytest.approx((762.82, 8.67), abs=5e-3)

    def planes(first: float, second: float) -> tuple[complex, complex]:
        at_second = (static * (z - first) + couple) / (second - first)
        return static - at_second, at_second

    assert [abs(u) for u in planes(20, 280)] == pytest.approx([247.2, 970.4], abs=0.05)
    assert [polar(u) for u in planes(90, 215)] == [
        pytest.approx((863.07, 210), abs=6e-3),
        pytest.approx((1597.90, 20), abs=6e-3),
    ]
    axes = np.linalg.eigh(SAMPLES["two_disc_rotor.stl"]["mesh"]["inertia"])[1]
    assert np.degrees(np.arccos(np.abs(axes[2]).max())) == pytest.approx(0.299, abs=5e-4)


def test_the_heavy_axis_of_the_bent_wheel_is_tilted_from_the_axle_towards_x() -> None:
    """The wheel is tilted by asin(40/401); the straight axle moves the principal axis a little further."""
    inertia = np.array(SAMPLES["bent_wheel.stl"]["closed_form"]["inertia"])
    axis = np.linalg.eigh(inertia)[1][:, 2]
    assert axis[0] / axis[2] == pytest.approx(40 / 399, rel=0.03)
    assert inertia[0, 2] > 0  # tensor sign, as for a disc: (Ip − It) sin τ cos τ


def test_the_t_handle_flips_about_its_stem() -> None:
    ixx, iyy, izz = np.diag(SAMPLES["t_handle.stl"]["closed_form"]["inertia"])
    assert ixx < 0.9 * izz < 0.9 * 0.9 * iyy


def test_an_assembly_is_the_sum_of_its_parts() -> None:
    for name in ("shaft_impeller.obj", "two_region_bar.vtk"):
        parts, whole = SAMPLES[name]["parts"].values(), SAMPLES[name]["assembly"]
        masses = [part["density"] * part["closed_form"]["volume"] for part in parts]
        centers = [np.array(part["closed_form"]["center_of_mass"]) for part in parts]
        center = np.average(centers, axis=0, weights=masses)
        inertia = np.zeros((3, 3))
        for part, mass, own in zip(parts, masses, centers, strict=True):
            d = own - center
            inertia += part["density"] * np.array(part["closed_form"]["inertia"])
            inertia += mass * (d @ d * np.eye(3) - np.outer(d, d))
        assert whole["mass"] == pytest.approx(sum(masses), rel=1e-14)
        assert whole["center_of_mass"] == pytest.approx(center, rel=1e-14)
        assert np.array(whole["inertia"]) == pytest.approx(inertia, rel=1e-13, abs=1e-20)


def test_the_union_of_the_overlapping_cubes_is_fifteen_eighths() -> None:
    true = SAMPLES["broken/overlapping_cubes.stl"]["closed_form"]
    assert true["volume"] == float(Fraction(15, 8) / 10**9)
    assert true["center_of_mass"] == [0.00025] * 3
