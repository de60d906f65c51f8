"""Order of the triangles, and which corner comes first: the same verdict, bodies and bits whatever it is."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.mesh import solids
from tests.mesh.solids import beside_itself, blocks, box, cells, cube, cylinder, inside_out, joined, ring, sphere

import inertia
from inertia.mesh.geometry.closure import closure
from inertia.mesh.part import Part
from inertia.mesh.surface import Surface
from inertia_meshes import catalogue, path

TWO = cells((0, 2), (0, 2), (0, 2)), cells((1, 3), (1, 3), (1, 3))
FRAME = cells((0, 3), (0, 3), (0, 1)) - {(1, 1, 0)}

SOUND = {
    "cube": (joined(cube()), 1),
    "hollow": (joined(cube(size=4), inside_out(cube())), 63),
    "insert that fills its cavity": (joined(cube(size=4), inside_out(cube()), cube()), 64),
    "cubes that share an edge": (joined(box((0, 0, 0), (1, 1, 1)), box((1, 1, 0), (2, 2, 1))), 2),
    "cubes that share a face": (joined(box((0, 0, 0), (1, 1, 1)), box((1, 0, 0), (2, 1, 1))), 2),
    "cubes that share an edge and a face": (beside_itself(90), 2000),
    "a cavity that touches the wall along edges": (blocks(cells((0, 3), (0, 3), (0, 3)) - {(0, 0, 1), (1, 1, 1)}), 25),
    "a solid that touches itself along an edge": (blocks({(0, 0, 0), (0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 0, 1)}), 5),
    "a frame": (blocks(FRAME), 8),
    "a frame and what fills it": (blocks(FRAME, {(1, 1, 0)}), 9),
}
BAD = {
    "turned by 30° about a common edge": beside_itself(30),
    "turned by 0.1° about a common edge": beside_itself(0.1),
    "overlapping and cut at each other's faces": blocks(*TWO),
    "inside another, with faces in common": joined(box((0, 0, 0), (1, 1, 2)), box((0, 0, 0), (1, 1, 1))),
    "inside another, cut alike": blocks(cells((0, 2), (0, 2), (0, 2)), {(0, 0, 0)}),
    "coaxial cylinders with a common end": joined(cylinder(10, 7), cylinder(5, 7)),
    "coaxial cylinders, one inside the other": joined(cylinder(10, 7), cylinder(5, 3)),
    "plate with a rib in its corner": joined(box((0, 0, 0), (10, 10, 1)), box((0, 0, 0), (10, 1, 3))),
    "stored twice": joined(cube(), cube()),
    "twice, cut along other diagonals": joined(cube(), inside_out((cube()[0][:, [1, 0, 2]], cube()[1]))),
    "a cutter that sticks out": joined(cube(size=2), inside_out(cube((1, 0, 0)))),
    "inside out beside a sound one": joined(cube(), inside_out(cube((3, 0, 0)))),
    "inside out at an edge of a sound one": joined(box((0, 0, 0), (1, 1, 1)), inside_out(box((1, 1, 0), (2, 2, 1)))),
    "inside out": joined(inside_out(ring(12, 6))),
    "too large for its cavity": joined(cube(size=6), inside_out(cube(size=4)), cube(size=5)),
    "open": Surface(cube()[0], cube()[1][1:]),
    "with an inner wall": Surface(cube()[0], np.vstack([cube()[1], [[2, 3, 5], [2, 5, 4]]])),
    "one triangle twice": Surface(cube()[0], np.vstack([cube()[1], cube()[1][4:5]])),
}
SAMPLES = [name for name, about in catalogue().items() if about["triangles"] and name != "broken/truncated.stl"]


def outcome(part: Part, orientation: str = "stored") -> tuple:
    """Return all that must not depend on the order."""
    report = inertia.check(part)
    findings = tuple((finding.code, finding.severity, finding.count, finding.turnable) for finding in report.findings)
    shells = tuple(sorted((shell.kind, shell.triangles, shell.winding_outside, shell.depth) for shell in report.shells))
    verdict = report.fit, report.closed, report.consistent, report.outward, report.bodies, findings, shells
    try:
        result = inertia.mass_properties(part, accuracy="exact", orientation=orientation)
    except inertia.GeometryError as fault:
        return *verdict, type(fault), tuple(remedy.verb for remedy in fault.remedies)
    return *verdict, result.volume, result.center_of_mass.tobytes(), result.inertia.tobytes(), result.error.volume


def shuffled(surface: Surface, seed: int) -> Part:
    """Return the surface with its triangles and their first corners in random order; seed 0 is by height."""
    random = np.random.default_rng(seed)
    order = random.permutation(surface.count) if seed else np.argsort(surface.corners().min(axis=1)[:, 2])
    first = random.integers(3, size=(surface.count, 1))
    return solids.part(Surface(surface.vertices, np.take_along_axis(surface.faces[order], (first + range(3)) % 3, 1)))


@pytest.mark.parametrize("name", SOUND)
def test_bodies_that_share_edges_add_up_in_any_order(name: str) -> None:
    surface, volume = SOUND[name]
    original = outcome(solids.part(surface))
    assert original[0]
    assert inertia.mass_properties(solids.part(surface)).volume == pytest.approx(volume * 1e-9, rel=1e-14)
    assert {outcome(shuffled(surface, seed)) for seed in range(8)} == {original}


@pytest.mark.parametrize("orientation", ["stored", "absolute"])
@pytest.mark.parametrize("name", BAD)
def test_what_is_wrong_is_wrong_in_any_order(name: str, orientation: str) -> None:
    original = outcome(solids.part(BAD[name]), orientation)
    assert not original[0]
    assert {outcome(shuffled(BAD[name], seed), orientation) for seed in range(8)} == {original}


@pytest.mark.parametrize("name", SAMPLES)
def test_every_sample_is_the_same_in_any_order(name: str) -> None:
    corners = inertia.read(path(name)).triangles.corners()
    surface = Surface(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    assert len({outcome(shuffled(surface, seed)) for seed in range(3)}) == 1


CELL = st.tuples(*[st.integers(0, 2)] * 3)


@settings(deadline=None, max_examples=30)
@given(several=st.lists(st.sets(CELL, min_size=1, max_size=9), min_size=1, max_size=3), seed=st.integers(1, 1000))
def test_solids_of_cells_are_fit_exactly_where_none_has_a_cell_of_another(several: list, seed: int) -> None:
    count = sum(map(len, several))
    fit = len(set.union(*several)) == count
    surface = blocks(*several)
    original = outcome(solids.part(surface))
    assert outcome(shuffled(surface, seed)) == original
    assert original[0] == fit
    if fit:
        assert original[7] == float(Fraction(count, 10**9))


@pytest.mark.parametrize("splits", [2, 5])
def test_a_thousand_spheres_that_touch_are_as_many_bodies(splits: int) -> None:
    count = 1000 if splits == 2 else 4
    places = np.array(np.unravel_index(np.arange(count), (10, 10, 10))).T * 2.0
    surface = joined(*(sphere(tuple(place), splits=splits) for place in places))
    assert closure(surface).components == count
    assert closure(surface.select(np.random.default_rng(0).permutation(surface.count))).components == count
