"""What is wrong at edges is told by the triangles there alone, in the words of a check of the whole."""

import numpy as np
import pytest
from tests.mesh.solids import cube, joined, part, ring, sphere

import inertia
from inertia.mass.integration import surface_integrals
from inertia.mesh import check
from inertia.mesh.surface import Surface

SOUND = joined(ring(40, 30), cube((0, 0, 30)), sphere((0, 0, 60)))
FACES = SOUND.faces


def with_a_fin() -> Surface:
    """Return the surface with a triangle that stands on it."""
    vertices = np.vstack([SOUND.vertices, SOUND.vertices[FACES[50, 2]] + np.array([0, 0, 9])])
    return Surface(vertices, np.vstack([FACES, [*FACES[50, :2], len(SOUND.vertices)]]))


BROKEN = {
    "a hole": Surface(SOUND.vertices, np.delete(FACES, [70, 71, 90], axis=0)),
    "a hole and one turned": Surface(SOUND.vertices, np.vstack([FACES[:60], FACES[60:61, ::-1], FACES[64:]])),
    "a copy": Surface(SOUND.vertices, np.vstack([FACES, FACES[80]])),
    "a fin": with_a_fin(),
}


@pytest.mark.parametrize("name", BROKEN)
def test_an_open_surface_is_refused_in_the_words_of_its_check(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    broken = part(BROKEN[name])
    report = inertia.check(broken)
    with pytest.raises(inertia.GeometryError) as expected:
        report.require_fit()
    monkeypatch.setattr("inertia.native.SHIPPED_ABOVE", 0)
    monkeypatch.setattr(check, "check_surface", None)  # which would look at all triangles
    with pytest.raises(inertia.GeometryError) as found:
        next(surface_integrals(broken, ()))
    assert str(found.value) == str(expected.value)
    assert (found.value.code, found.value.exit_code) == (expected.value.code, 4)
