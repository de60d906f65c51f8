"""Mounting of bodies against meshes that are moved and turned, and their share of the scatter."""

import math

import numpy as np
import pytest
from tests.balancing.corrections.workpieces import round_part

from inertia.balancing.balance import balance
from inertia.balancing.mounting import mounting_terms
from inertia.balancing.rotor import Rotor
from inertia.mesh.part import Part
from inertia.mesh.write import write_stl

SHAFT = round_part((0, 0), (10, 0), (10, 200), (0, 200), sides=48)
WHEEL = round_part((16, 120), (60, 120), (60, 150), (16, 150), (16, 120), sides=48)


def rotor(folder, wheel=WHEEL, **mounting):
    for name, part in (("shaft", SHAFT), ("wheel", wheel)):
        write_stl([part], folder / f"{name}.stl", part.unit, force=True)
    fields = {
        "body": [
            {"file": "shaft.stl", "material": "steel"},
            {"file": "wheel.stl", "material": "steel"} | mounting,
        ],
        "axis": {"bearing_a": [0, 0, 10], "bearing_b": [0, 0, 190]},
        "service": {"rpm": 3000},
        "tolerance": {"grade": 6.3},
    }
    return Rotor.from_dict(fields, folder=folder)


def moved(part, offset=(0.0, 0.0, 0.0), turn=None, about=(0.0, 0.0, 135.0)):
    turn = np.eye(3) if turn is None else turn
    corners = (part.triangles.corners().reshape(-1, 3) - about) @ turn.T + about + np.array(offset)
    return Part.from_arrays(corners, np.arange(len(corners)).reshape(-1, 3), "mm")


def at_bearings(result):
    return result.initial.in_many_planes(result.tolerance_planes)


@pytest.mark.parametrize("direction", [0.0, 1.0, 4.0])
def test_what_mounting_does_is_what_a_moved_mesh_does(tmp_path, direction):
    before = balance(rotor(tmp_path, eccentricity=0.02, tilt=0.1))
    off, lean = mounting_terms(before.rotor, before.bodies, before.shaft, before.tolerance_planes)
    assert (off.name, lean.name) == ("wheel.stl: eccentricity", "wheel.stl: tilt")
    assert (off.spread, lean.spread) == pytest.approx((2e-5, math.radians(0.1)))
    way = complex(math.cos(direction), math.sin(direction))
    after = balance(rotor(tmp_path, moved(WHEEL, (0.1 * way.real, 0.1 * way.imag, 0.0))))
    assert at_bearings(after) - at_bearings(before) == pytest.approx(off.sensitivities * 1e-4 * way, rel=1e-3)
    small = 1e-3
    turn = np.eye(3) + small * np.array([[0, 0, way.real], [0, 0, way.imag], [-way.real, -way.imag, 0]])
    after = balance(rotor(tmp_path, moved(WHEEL, turn=turn)))
    assert at_bearings(after) - at_bearings(before) == pytest.approx(
        lean.sensitivities * small * way, rel=1e-2, abs=1e-9
    )


def test_mounting_counts_in_the_share_and_in_the_table(tmp_path):
    held = balance(rotor(tmp_path))
    loose = balance(rotor(tmp_path, eccentricity=0.05))
    assert held.scatter.within == 1.0
    assert loose.scatter.within < 0.9
    assert loose.verdict.outcome == "conditional"
    assert loose.scatter.sensitivities[0].name == "wheel.stl: eccentricity"


def test_uneven_transverse_moments_add_to_the_tilt(tmp_path):
    result = balance(rotor(tmp_path, moved(WHEEL, turn=np.diag([1.0, 0.7, 1.0])), tilt=0.1))
    lean, more = mounting_terms(result.rotor, result.bodies, result.shaft, result.tolerance_planes)
    assert more.name == "wheel.stl: tilt, uneven"
    assert 0.1 < abs(more.sensitivities[0] / lean.sensitivities[0]) < 0.5


def test_what_all_bodies_have_in_common_is_drawn_once(tmp_path):
    fields = rotor(tmp_path).to_dict()
    for body in fields["body"]:
        body["eccentricity"] = {"common": 0.02, "separate": 0.01}
    result = balance(Rotor.from_dict(fields, folder=tmp_path))
    terms = {k.name: k for k in mounting_terms(result.rotor, result.bodies, result.shaft, result.tolerance_planes)}
    assert set(terms) == {"shaft.stl: eccentricity", "wheel.stl: eccentricity", "mounting: eccentricity"}
    apart = terms["shaft.stl: eccentricity"].sensitivities + terms["wheel.stl: eccentricity"].sensitivities
    assert terms["mounting: eccentricity"].sensitivities == pytest.approx(apart)
