"""Depths are counted from the metal that a tool meets: the printed work, done from there, leaves what was claimed."""

import cmath
import math
from pathlib import Path

import numpy as np
import pytest
from tests.balancing.corrections.workpieces import STEEL
from tests.balancing.test_possible_holes import axis_points

from inertia.balancing.balance import Balance, balance
from inertia.balancing.rotor import Rotor
from inertia.errors import GeometryError
from inertia.mesh.part import Part
from inertia.mesh.write import write_stl
from inertia_meshes.shapes import revolved

MM = 1e-3
DISC, LOW, HIGH = 50.0, 80.0, 110.0  # mm: radius and faces
OFF = 0.35  # mm: how far the disc runs out, towards 0 degrees
BEARINGS = (0.02, 0.16)
PROFILE = [(0, 0), (10, 0), (10, 80), (50, 80), (50, 110), (10, 110), (10, 180), (0, 180)]
DRILL = {"id": "I", "z": 95, "method": "drill_radial", "diameters": [12]}
AXIAL = {"id": "I", "z": 110, "method": "drill_axial", "face": "b", "radius": 38, "diameters": [8, 12]}
MILL = {"id": "I", "z": 95, "method": "mill", "width": 20}
ARC = {"id": "I", "z": 95, "method": "mill_arc", "width": 12, "max_depth": 3, "max_arc": 90}
# A key that is not in the mesh, on the side where the disc is low.
KEY = {"convention": "F", "width": 8, "height": 8, "length": 10, "floor": 30, "angle": 180, "z": 95, "density": 5e4}


def eccentric(folder: Path, off: float, *planes: dict, sides: int = 720, **changes: object) -> Balance:
    """Balance a disc that runs out by `off`, mm."""
    corners = revolved(PROFILE, sides)
    corners[..., 0] += np.where(np.hypot(corners[..., 0], corners[..., 1]) > 20, off, 0.0)
    part = Part.from_arrays(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), "mm")
    write_stl([part], folder / "r.stl", part.unit, force=True)
    fields = {
        "body": [{"file": "r.stl", "density": STEEL}],
        "axis": {"bearing_a": [0, 0, 20], "bearing_b": [0, 0, 160]},
        "service": {"rpm": 3000},
        "tolerance": {"grade": 6.3},
        "plan": {"time": 3},
        "plane": list(planes),
    }
    return balance(Rotor.from_dict(fields | changes, folder))


def rim(along: np.ndarray, angle: float, off: float) -> np.ndarray:
    """Return how far from the shaft, mm, a disc that is `off` begins in a direction, beside its middle by `along`."""
    return off * math.cos(angle) + np.sqrt(DISC**2 - (along + off * math.sin(angle)) ** 2)


def taken(work, off: float) -> tuple[float, complex]:
    """Return g and g mm that the printed work takes of a round disc, its depth counted from the metal."""
    turn, h = cmath.rect(1.0, work.angle), work.depth / MM
    touched = float(rim(np.zeros(1), work.angle, off)[0])
    if work.kind == "drill_radial":
        half = 0.5 * work.tool_diameter / MM
        r, t = np.meshgrid((np.arange(600) + 0.5) / 600 * half, (np.arange(360) + 0.5) / 180 * np.pi, indexing="ij")
        y, area = r * np.cos(t), r * (half / 600) * (np.pi / 180)
        top, bottom = rim(y, work.angle, off), touched - h - (half - r) / math.tan(0.5 * work.point_angle)
        weight = STEEL * 1e-6 * area
    elif work.kind == "mill_flat":
        y = (np.arange(200_000) + 0.5) / 1e5 * DISC - DISC
        top, bottom = rim(np.clip(y, -0.99 * DISC, 0.99 * DISC), work.angle, off), touched - h
        weight = STEEL * 1e-6 * work.width / MM * 1e-5 * DISC * (top > bottom)
    elif work.kind == "mill_arc":
        theta = work.arc * ((np.arange(20_000) + 0.5) / 20_000 - 0.5)
        top = off * np.cos(work.angle + theta) + np.sqrt(DISC**2 - (off * np.sin(work.angle + theta)) ** 2)
        bottom, wide = touched - h, STEEL * 1e-6 * work.width / MM * work.arc / 20_000
        mass = wide * (top**2 - bottom**2) / 2
        return float(mass.sum()), complex((wide * (top**3 - bottom**3) / 3 * np.exp(1j * theta)).sum() * turn)
    else:
        half = 0.5 * work.tool_diameter / MM
        mass = STEEL * 1e-6 * math.pi * half**2 * (h + half / math.tan(0.5 * work.point_angle) / 3)
        return mass, mass * work.radius / MM * turn
    moment = complex((weight * ((top**2 - bottom**2) / 2 + 1j * y * (top - bottom))).sum())
    return float((weight * (top - bottom)).sum()), moment * turn


@pytest.mark.parametrize(
    ("off", "plane", "changes"),
    [
        (OFF, DRILL, {"key": [KEY]}),
        (OFF, DRILL | {"max_depth": 5}, {"key": [KEY]}),
        (OFF, MILL, {"key": [KEY]}),
        (OFF, ARC, {"key": [KEY]}),
        (OFF, DRILL | {"radius": 50}, {}),
        (0.0, DRILL | {"radius": 49.6}, {"key": [KEY]}),
        (0.0, MILL | {"radius": 50.4}, {"key": [KEY]}),
        (OFF, AXIAL | {"z": 109.65, "max_depth": 12}, {}),
    ],
    ids=["runout", "max_depth", "flat", "arc", "high side", "radius too small", "radius too large", "face"],
)
def test_the_printed_work_done_from_the_metal_leaves_what_is_claimed(tmp_path, off, plane, changes):
    result = eccentric(tmp_path, off, plane, **changes)
    assert result.correction.operations
    vectors = np.array(result.initial.in_planes(*BEARINGS)) / 1e-6
    for work in result.correction.operations:
        mass, moment = taken(work, off)
        assert work.mass == pytest.approx(1e-3 * mass, rel=2e-3)
        assert work.depth / 1e-4 == pytest.approx(round(work.depth / 1e-4), abs=1e-6)  # what the shop can set
        assert work.depth <= MM * plane.get("max_depth", math.inf) + 1e-12
        b = (work.unbalance_z - BEARINGS[0]) / (BEARINGS[1] - BEARINGS[0])
        vectors -= moment * np.array([1 - b, b])
        if plane["method"] == "drill_axial":
            assert work.z == pytest.approx(MM * HIGH, abs=1e-8)
        else:
            assert work.radius == pytest.approx(MM * rim(np.zeros(1), work.angle, off)[0], abs=1e-6)
    left = np.array(result.residual.in_planes(*BEARINGS)) / 1e-6
    assert np.abs(left - vectors).max() < 0.02 * np.min(result.tolerance.permissible) / 1e-6


def test_a_radius_that_is_not_the_metals_is_said_once(tmp_path):
    result = eccentric(tmp_path, 0.0, DRILL | {"radius": 49.6}, key=[KEY])
    said = "plane I: depths are counted from the metal, whose radius is at 50 mm, not at 49.6 as the file has it"
    assert result.notes.count(said) == 1
    assert not any("counted from the metal" in k for k in eccentric(tmp_path, 0.0, DRILL, key=[KEY]).notes)


def test_facets_of_a_round_rim_stand_for_its_radius(tmp_path):
    (work,) = eccentric(tmp_path, 0.0, DRILL | {"angles": [0.25]}, key=[KEY | {"angle": 0.25}]).correction.operations
    assert work.radius == pytest.approx(50 * MM, abs=1e-7)  # half a facet lies 0.5 µm lower


def test_holes_keep_their_web_below_a_surface_that_is_not_where_the_file_says(tmp_path):
    planes = [
        DRILL | {"id": str(z), "z": z, "radius": 50.2, "diameters": [8], "max_depth": 12, "web": 2} for z in (89, 98)
    ]
    works = eccentric(tmp_path, OFF, *planes, sides=180, key=[KEY]).correction.operations
    assert len(works) > 1
    for k, work in enumerate(works):
        for other in works[:k]:
            away = np.linalg.norm(axis_points(work)[:, None] - axis_points(other)[None], axis=2).min()
            assert away >= 10e-3 - 1e-8


def test_a_hole_through_is_as_deep_as_the_part_is_thick(tmp_path):
    for given in ({}, {"max_depth": 40}):
        works = eccentric(tmp_path, OFF, AXIAL | {"through": True} | given, sides=180).correction.operations
        assert [k.depth for k in works] == pytest.approx([30 * MM] * len(works), abs=1e-8)
        assert all(k.mass == pytest.approx(STEEL * math.pi / 4 * k.tool_diameter**2 * 0.03, rel=5e-3) for k in works)
    with pytest.raises(GeometryError, match=r"goes 30 mm deep, as thick as .*, past the max_depth of 25 mm: correct"):
        eccentric(tmp_path, OFF, AXIAL | {"through": True, "max_depth": 25}, sides=180)
