"""Cutting a part that has a true shape: its triangles are cut, and what they are off by is no change."""

from dataclasses import replace

import numpy as np
import pytest
from tests.balancing.corrections.workpieces import STEEL, on_z, round_part
from tests.mass.shapes.by_hand import frustum

from inertia.balancing.corrections.workpiece import Workpiece
from inertia.balancing.unbalance import Unbalance
from inertia.mass.analyse import mass_properties
from inertia.mesh.part import Part
from inertia.mesh.surface import Surface
from inertia_meshes.shapes import box


def test_only_what_is_cut_changes_the_unbalance() -> None:
    mesh = round_part((0, 0), (50, 0), (50, 100), (0, 100), sides=90)
    part = Part.from_arrays(mesh.triangles.corners().reshape(-1, 3) + np.array([0.3, 0, 0]), mesh.triangles.faces, "mm")
    true = replace(part, shape=frustum(50.02, 50.02, 100, at=(0.3, 0, 0)), chord=np.full(part.triangles.count, 0.1))
    corners, faces = np.unique(box(1, 1, 1).reshape(-1, 3), axis=0, return_inverse=True)
    solid = Surface(0.005 * corners + np.array([0.025, 0.0, 0.045]), faces.reshape(-1, 3))
    size = np.prod(np.ptp(solid.vertices, axis=0))
    before = Unbalance.of(mass_properties(true, STEEL), on_z())
    assert before.mass == pytest.approx(STEEL * np.pi * 0.05002**2 * 0.1, rel=1e-12)
    piece = Workpiece((true,), (STEEL,), on_z(), before, before)
    assert piece.taken(solid, [0.1, 0.2]).mass == pytest.approx(STEEL * size, rel=1e-9)
    parts, after = piece.cut([solid], ())
    assert parts[0].shape is None
    middle = solid.vertices.mean(axis=0)
    assert before.mass - after.mass == pytest.approx(STEEL * size, rel=1e-9)
    assert before.static - after.static == pytest.approx(STEEL * size * complex(middle[0], middle[1]), rel=1e-9)
