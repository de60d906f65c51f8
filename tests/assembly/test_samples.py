"""The sample assemblies, against their parts added up by hand."""

import json
import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.balancing.test_rotor import valid

from inertia.assembly.document import Assembly, json_schema
from inertia.balancing.rotor import json_schema as rotor_schema
from inertia_meshes import assemblies, path

DOCS = Path(__file__).resolve().parents[2] / "docs"

Body = tuple[float, np.ndarray, np.ndarray]


def body(mass: float, squares: tuple[float, float, float], at: tuple[float, ...] = (0, 0, 0)) -> Body:
    """Return mass, centre (m) and tensor of a body whose ∫x² dm / m along its axes are these, mm²."""
    x, y, z = (1e-6 * mass * k for k in squares)
    return mass, 1e-3 * np.array(at, dtype=float), np.diag([y + z, z + x, x + y])


def box(x: float, y: float, z: float) -> tuple[float, float, float]:
    return x * x / 12, y * y / 12, z * z / 12


def tube(outer: float, inner: float, z: float) -> tuple[float, float, float]:
    across = (outer**2 + inner**2) / 4
    return across, across, z * z / 12


def moved(bodies: list[Body], rotation: Rotation, at: tuple[float, ...] = (0, 0, 0)) -> list[Body]:
    r, t = rotation.as_matrix(), 1e-3 * np.array(at, dtype=float)
    return [(m, r @ c + t, r @ i @ r.T) for m, c, i in bodies]


def together(bodies: list[Body]) -> Body:
    mass = math.fsum(m for m, _, _ in bodies)
    center = np.array([math.fsum(m * c[k] for m, c, _ in bodies) / mass for k in range(3)])
    tensor = np.zeros((3, 3))
    for m, c, i in bodies:
        d = c - center
        tensor += i + m * (d @ d * np.eye(3) - np.outer(d, d))
    return mass, center, tensor


def tube_mass(outer: float, inner: float, z: float, density: float) -> float:
    return density * math.pi * (outer**2 - inner**2) * z * 1e-9


def fan() -> list[Body]:
    blade = moved([body(1150 * 70 * 24 * 2e-9, box(70, 24, 2))], Rotation.from_euler("x", 35, degrees=True), (65, 0, 0))
    screw = [body(tube_mass(1.5, 0, 10, 7850), tube(1.5, 0, 10), (18, 0, -55))]
    turns = [Rotation.from_euler("z", 40 * k, degrees=True) for k in range(9)]
    quarters = [Rotation.from_euler("z", 90 * k, degrees=True) for k in range(4)]
    motor = (0.42, np.array([0, 0, -0.08]), np.diag([2.1e-4, 2.1e-4, 1.3e-4]))
    return [
        body(tube_mass(30, 6, 24, 1150), tube(30, 6, 24)),
        *(one for turn in turns for one in moved(blade, turn)),
        body(tube_mass(6, 0, 90, 7800), tube(6, 0, 90), (0, 0, -20)),
        motor,
        *(one for turn in quarters for one in moved(screw, turn)),
    ]


def gripper() -> list[Body]:
    finger = 7850 * 40 * 20 * 10e-9
    return [
        body(0.24, box(70, 40, 30), (0, 0, 15)),
        body(finger, box(40, 20, 10), (12 + 20, -10 + 10, 30 + 5)),
        body(finger, box(40, 20, 10), (-12 - 20, -10 + 10, 30 + 5)),
    ]


def arm() -> list[Body]:
    across = Rotation.from_euler("x", 90, degrees=True)
    about_y = [Rotation.from_euler("y", angle, degrees=True) for angle in (55, -80)]
    elbow = [
        *moved([body(0.92, tube(28, 0, 70))], across),
        body(tube_mass(24, 21, 220, 2700), tube(24, 21, 220), (0, 0, 140)),
        body(0.31, (26**2 / 5,) * 3, (0, 0, 280)),
        *moved(gripper(), Rotation.from_euler("z", 15, degrees=True), (0, 0, 306)),
    ]
    shoulder = [
        *moved([body(1.85, tube(35, 0, 90))], across),
        body(tube_mass(32, 28, 260, 2700), tube(32, 28, 260), (0, 0, 170)),
        *moved(elbow, about_y[1], (0, 0, 340)),
    ]
    turret = [
        body(tube_mass(50, 42, 140, 2700), tube(50, 42, 140), (0, 0, 70)),
        *moved(shoulder, about_y[0], (0, 0, 180)),
    ]
    base = body(tube_mass(80, 0, 60, 7850), tube(80, 0, 60), (0, 0, 30))
    return [base, *moved(turret, Rotation.from_euler("z", 30, degrees=True), (0, 0, 60))]


def cubesat() -> list[Body]:
    quarters = [Rotation.from_euler("z", 90 * k, degrees=True) for k in range(4)]
    along_x = Rotation.from_euler("y", 90, degrees=True)
    rail = body(2700 * 8.5 * 8.5 * 113.5e-9, box(8.5, 8.5, 113.5), (45.75, 45.75, 0))
    side = body(2700 * 1.2 * 83 * 98e-9, box(1.2, 83, 98), (48.9, 0, 0))
    sun = body(0.038, box(0.4, 82, 98), (50, 0, 0))
    rod = body(tube_mass(1.5, 0, 92, 7900), tube(1.5, 0, 92), (36, 36, 0))
    end, screw = 2700 * 83 * 83 * 1.5e-9, tube_mass(1.5, 0, 4, 7900)
    spacer, antenna = tube_mass(3, 1.5, 12, 2700), tube_mass(0.5, 0, 170, 8500)
    signs = [(i, j, k) for i in (1, -1) for j in (1, -1) for k in (1, -1)]
    turn = Rotation.from_euler("xz", [180, 5], degrees=True)
    camera = 0.11, np.array([0, 0, 0.006]), np.array([[2.6e-5, 0, 1e-6], [0, 2.6e-5, 0], [1e-6, 0, 1.9e-5]])
    return [
        *(one for q in quarters for one in moved([rail, side, sun, rod], q)),
        *(body(end, box(83, 83, 1.5), (0, 0, z)) for z in (50, -50)),
        *(body(screw, tube(1.5, 0, 4), (38 * i, 38 * j, 52.75 * k)) for i, j, k in signs),
        *(body(spacer, tube(3, 1.5, 12), (36 * i, 36 * j, 16 * k)) for i, j, k in signs),
        body(0.062, box(68, 68, 1.6), (0, 0, 30)),
        body(0.085, box(68, 68, 1.6), (0, 0, 8)),
        body(0.075, box(68, 68, 12), (4, -2, -7)),
        body(0.256, box(64, 60, 18), (0, 2, -32)),
        body(0.03, (0, 0, 0), (-38, 0, 0)),
        *moved([camera], turn, (10, -12, 40)),
        *(m for y in (40, -40) for m in moved([body(antenna, tube(0.5, 0, 170))], along_x, (0, y, 56))),
    ]


def weighed_fan() -> list[Body]:
    grams = (31.42, 31.87, 30.96, 31.55, 32.08, 31.13, 31.70, 30.88, 31.61)
    lean = Rotation.from_euler("x", 35, degrees=True)
    blades = [moved([body(m / 1000, box(70, 24, 2))], lean, (65, 0, 0)) for m in grams]
    return [
        body(tube_mass(6, 0, 120, 7850), tube(6, 0, 120)),
        body(tube_mass(30, 6, 24, 2700), tube(30, 6, 24)),
        *(
            one
            for k, blade in enumerate(blades)
            for one in moved(blade, Rotation.from_euler("z", 40 * k, degrees=True))
        ),
    ]


KNOWN = {"arm": arm, "cubesat": cubesat, "fan": fan, "gripper": gripper, "weighed_fan": weighed_fan}
MEASURED = "assemblies/pump_rotor.toml"  # two of its parts are meshes


def test_the_parts_of_the_pump_rotor_were_weighed_and_their_centres_measured() -> None:
    parts = [(0.209, (0.008, -0.006, 60)), (0.147, (0.021, 0.028, 76)), (0.083, (-0.016, 0.012, 115))]
    properties = Assembly.load(path(MEASURED)).mass_properties()
    mass = sum(Fraction(repr(m)) for m, _ in parts)
    assert properties.mass == float(mass)
    center = [sum(Fraction(repr(m)) * Fraction(repr(c[k])) for m, c in parts) / mass / 1000 for k in range(3)]
    assert properties.center_of_mass == pytest.approx([float(k) for k in center], rel=1e-14)


@pytest.mark.parametrize("name", sorted(set(assemblies()) - {MEASURED}))
def test_the_whole_is_the_sum_of_the_parts(name: str) -> None:
    bodies = KNOWN[path(name).stem]()
    mass, center, tensor = together(bodies)
    assembly = Assembly.load(path(name))
    properties = assembly.mass_properties()
    assert len(assembly.placed.moments) == len(bodies)
    assert properties.mass == pytest.approx(mass, rel=1e-14)
    assert properties.center_of_mass == pytest.approx(center, abs=1e-14)
    assert np.abs(properties.inertia - tensor).max() <= 1e-14 * np.abs(tensor).max()
    assert properties.error.inertia < 1e-14


@pytest.mark.parametrize("name", assemblies())
def test_no_sample_has_parts_in_one_another(name: str) -> None:
    assert Assembly.load(path(name)).interferences() == ()


@pytest.mark.parametrize("name", assemblies())
def test_a_sample_obeys_the_schema_and_reads_back_as_itself(name: str) -> None:
    assembly = Assembly.load(path(name))
    table = assembly.to_dict()
    if (rotor := table.pop("rotor", None)) is not None:
        valid({**rotor, "assembly": name}, rotor_schema(), "rotor")
    valid(table, json_schema(), "assembly")
    again = Assembly.loads(assembly.to_toml(), path(name).parent)
    assert again.mass_properties().inertia.tolist() == assembly.mass_properties().inertia.tolist()


def test_what_is_written_keeps_fractions_and_uncertainties() -> None:
    table = {"name": "x", "mass": "1±0.1", "at": ["-1/3", 0.5, "0.1"], "mirror": "y"}
    again = Assembly.loads(Assembly.from_dict({"part": [table]}).to_toml()).fields.part[0]
    assert again.at == (Fraction(-1, 3), Fraction(1, 2), Fraction(1, 10))
    assert repr(again.mass) == "Estimate(1.0, 0.1)"


def test_the_schema_in_the_documents_is_the_one_that_is_printed() -> None:
    assert json.loads((DOCS / "assembly.schema.json").read_text(encoding="utf-8")) == json_schema()
