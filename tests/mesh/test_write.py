"""STL files of parts: what rounding to float32 leaves nothing of is not written."""

import numpy as np

from inertia.mesh.cut import block
from inertia.mesh.part import Part
from inertia.mesh.write import write_stl


def written(tmp_path, *blocks):
    """Return how many triangles a file of blocks has."""
    corners = np.concatenate([each.corners() for each in blocks])
    part = Part.from_arrays(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), "mm")
    write_stl([part], tmp_path / "part.stl", part.unit)
    return (len((tmp_path / "part.stl").read_bytes()) - 84) // 50


def test_a_skin_thinner_than_float32_is_left_out(tmp_path):
    skin = block([90.0, 0.0, 0.0], np.diag([1e-9, 5.0, 7.0]))
    assert written(tmp_path, block([0, 0, 0], 100 * np.eye(3)), skin) == 12


def test_bodies_that_touch_keep_both_their_faces(tmp_path):
    assert written(tmp_path, block([0, 0, 0], np.eye(3)), block([1, 0, 0], np.eye(3))) == 24
