"""The vector sum over facets against the true error of twenty families of turned and milled parts."""

import cmath

import numpy as np
import pytest
from tests.balancing.corrections.workpieces import round_part
from tests.balancing.rotors import STEEL, on_z
from tests.balancing.turned_and_milled import FAMILIES, MM, cylinder, mesh_moments, polar
from tests.mass.parts import surface

import inertia
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.balance import balance
from inertia.balancing.corrections.drilling import radial_unbalance
from inertia.balancing.corrections.milling import arc_unbalance, flat_unbalance
from inertia.balancing.facet_error import FacetLayers
from inertia.balancing.rotor import Rotor
from inertia.balancing.tessellation_bound import facet_uncertainty
from inertia.balancing.unbalance import plane_weights
from inertia.mesh.write import write_stl
from inertia_meshes import path
from inertia_meshes.shapes import box, sphere

PLANES = (-0.01, 0.13)
COUPLE_AT = 0.05


def errors(pieces, corners):
    """Return the true error in each plane, kg m."""
    static, lever = (STEEL * (sum(piece.moments[k] for piece in pieces) - mesh_moments(corners)[k]) for k in (1, 2))
    p, q = plane_weights(COUPLE_AT, PLANES)
    return np.abs(p * static + q * (lever - static * COUPLE_AT))


def bounds(corners):
    layers = FacetLayers(surface(corners))
    uncertainty = facet_uncertainty(layers, STEEL, on_z(*PLANES), COUPLE_AT)
    p, q = plane_weights(COUPLE_AT, PLANES)
    return np.array([uncertainty.bound(float(p[k]), float(q[k])) for k in (0, 1)])


@pytest.mark.parametrize("facets", [36, 100, 360])
@pytest.mark.parametrize("name", FAMILIES)
def test_the_bound_is_never_below_the_true_error_and_at_most_a_fifth_above(name, facets):
    if name in ("filleted_boss", "ring_groove", "ball_end"):  # a double curvature takes the square of triangles
        facets = {36: 36, 100: 60, 360: 100}[facets]
    pieces = FAMILIES[name](facets)
    corners = np.concatenate([piece.corners for piece in pieces])
    ratio = bounds(corners) / errors(pieces, corners)
    assert (ratio >= 1).all()
    assert (ratio <= 1.2).all()


@pytest.mark.parametrize("name", ["tool_holder", "crank", "pocket", "drilled_blind", "fan", "wedge", "swash"])
@pytest.mark.parametrize("facets", [36, 360])
def test_coordinates_rounded_to_single_precision_widen_it_by_little(name, facets):
    pieces = FAMILIES[name](facets)
    corners = np.concatenate([piece.corners for piece in pieces]).astype(np.float32).astype(float)
    ratio = bounds(corners) / errors(pieces, corners)
    assert (ratio >= 1).all()
    assert (ratio <= 4).all()


def test_the_rotor_of_case_14_is_known_to_a_fifth_of_a_gram_millimetre():
    """A layer of the chord tolerance everywhere would be 64 g·mm; the true error is 0.077."""
    answer = inertia.balance(Rotor.load(path("rotors/two_disc_rotor.toml")))
    (source,) = (k for k in answer.initial.uncertainties if k.source == "tessellation")
    assert 0.0765e-6 < source.bound(1.0, 0.0) < 0.15e-6


def test_a_tool_holder_is_decided_at_high_speed_without_a_typed_figure(tmp_path):
    """G2.5 at 15 000 r/min, its facets 0.01 mm off: a layer of that all over covers the limit many times."""
    corners = np.concatenate([piece.corners for piece in FAMILIES["tool_holder"](120)])
    write(tmp_path / "holder.obj", corners)
    fields = {
        "unit": "mm",
        "body": [{"file": "holder.obj", "material": "steel"}],
        "axis": {"bearing_a": [0, 0, 0], "bearing_b": [0, 0, 110], "radial_uncertainty": 0.0},
        "service": {"rpm": 15000},
        "tolerance": {"grade": 2.5},
    }
    answer = inertia.balance(Rotor.from_dict(fields, tmp_path))
    assert answer.verdict.outcome == "fail"
    for plane in answer.verdict.planes:
        assert plane.bounds["tessellation"] < 0.1 * plane.permissible
    assert any("all of its curved facets are known" in note for note in answer.notes)


@pytest.mark.parametrize(("typed", "says"), [(0.0, "mesh"), (0.001, "mesh"), (0.04, "given"), (0.2, "given")])
def test_a_typed_figure_takes_no_doubt_away(tmp_path, typed, says):
    """Two pins beside the axis on facets of 0.038 mm: what is typed below that counts for nothing."""
    pieces = [
        cylinder(10 * MM, low * MM, (low + 20) * MM, 36, at) for low, at in ((0, polar(3, 0)), (21, polar(3, 180)))
    ]
    write(tmp_path / "pins.obj", np.concatenate([piece.corners for piece in pieces]))
    fields = {
        "unit": "mm",
        "body": [{"file": "pins.obj", "material": "steel"}],
        "axis": {"bearing_a": [0, 0, 0], "bearing_b": [0, 0, 41]},
        "service": {"rpm": 3000},
        "tolerance": {"grade": 40},
    }
    plain = inertia.balance(Rotor.from_dict(fields, tmp_path))
    fields["body"][0]["chord_tolerance"] = typed
    answer = inertia.balance(Rotor.from_dict(fields, tmp_path))
    assert answer.bodies[0].chord_from == says
    for one, other in zip(answer.verdict.planes, plain.verdict.planes, strict=True):
        assert one.bounds["tessellation"] >= other.bounds["tessellation"] > 0
    note = {"mesh": "is less than the 0.0381 mm", "given": "is more than the 0.0381 mm"}[says]
    assert any(note in k for k in answer.notes) == (typed != 0.04)


def test_a_box_is_the_true_shape():
    layers = FacetLayers(surface(box(3, 4, 5)))
    assert (layers.sag, layers.cones, layers.recognised) == (0.0, (), 1.0)
    assert facet_uncertainty(layers, STEEL, on_z(*PLANES), COUPLE_AT).modes == ()


def test_a_facet_that_a_small_bore_pierces_lies_beside_itself():
    """A disc of 360 facets 1.9 mm wide with a radial bore of 0.8 mm: around the bore the way leads back to its own."""
    import manifold3d

    bore = manifold3d.Manifold.cylinder(300, 0.4, 0.4, 30).rotate([0, 90, 0]).rotate([0, 0, -29.82])
    disc = manifold3d.Manifold.cylinder(37.3, 110.008, 110.008, 360) - bore.translate([0, 0, 17.9])
    mesh = disc.to_mesh()
    corners = np.float64(np.float32(mesh.vert_properties[:, :3]))[mesh.tri_verts]
    layers = FacetLayers(surface(corners))
    assert layers.recognised > 0.99
    assert layers.sag == pytest.approx(110.008 * (1 - np.cos(np.pi / 360)), rel=1e-3)


def test_edges_that_turn_by_less_than_a_right_angle_may_be_true():
    """A block whose edges are chamfered at 45°, and two that meet at 8°, have no facets."""
    for name in ("chamfered_block", "wedge"):
        layers = FacetLayers(surface(*(piece.corners for piece in FAMILIES[name](36))))
        assert len(layers.cones) == 1  # the hole, or the pin
        assert not layers.unknown_sag.any()


def test_a_surface_that_is_no_cone_counts_by_the_size_of_its_layers():
    stretched = sphere(0.05, 24) * [1.0, 0.8, 0.6] + [0.02, 0, 0.05]
    layers = FacetLayers(surface(stretched))
    volume = 4 / 3 * np.pi * 0.05**3 * 0.8 * 0.6
    moments = mesh_moments(stretched)
    p, q = plane_weights(COUPLE_AT, PLANES)
    uncertainty = facet_uncertainty(layers, STEEL, on_z(*PLANES), COUPLE_AT)
    static, lever = STEEL * (0.02 * volume - moments[1]), STEEL * (0.02 * 0.05 * volume - moments[2])
    for k in (0, 1):
        error = abs(p[k] * static + q[k] * (lever - static * COUPLE_AT))
        assert error <= uncertainty.bound(float(p[k]), float(q[k]))


def test_the_answer_does_not_depend_on_the_frame():
    turn = np.array([[2, -2, 1], [1, 2, 2], [-2, -1, 2]]) / 3
    corners = np.concatenate([piece.corners for piece in FAMILIES["drilled_blind"](36)])
    shaft = Shaft([0, 0, PLANES[0]] @ turn.T, [0, 0, PLANES[1]] @ turn.T, turn @ [1, 0, 0])
    skew = facet_uncertainty(FacetLayers(surface(corners @ turn.T)), STEEL, shaft, COUPLE_AT)
    p, q = plane_weights(COUPLE_AT, PLANES)
    for k, expected in enumerate(bounds(corners)):
        assert skew.bound(float(p[k]), float(q[k])) == pytest.approx(expected, rel=1e-6)


def write(file, corners):
    """Write corners (n, 3, 3) m as OBJ in mm, to all digits."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in (1e3 * corners.reshape(-1, 3)).tolist()]
    lines += [f"f {3 * k + 1} {3 * k + 2} {3 * k + 3}" for k in range(len(corners))]
    file.write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize("work", ["drill_radial", "mill", "mill_arc"])
@pytest.mark.parametrize("sides", [36, 120])
def test_the_bound_covers_what_tools_take_of_the_layer_over_facets(tmp_path, work, sides):
    """A cylinder of true radius 100 mm, in facets, with a key to correct: the tools' closed forms are the oracle."""
    step = 2 * np.pi / sides
    rim = 100 / np.sqrt(step / np.sin(step))  # the corners lie on the true surface
    part = round_part((0, 0), (rim, 0), (rim, 40), (0, 40), sides=sides, unit="mm")
    write_stl([part], tmp_path / "plate.stl", part.unit)
    plane = {"id": "I", "z": 20, "method": work, "radius": 100, "max_depth": 20, "depth_step": 0.1}
    plane |= {"drill_radial": {"diameters": [10]}, "mill": {"width": 12}, "mill_arc": {"width": 12, "max_depth": 2}}[
        work
    ]
    fields = {
        "body": [{"file": "plate.stl", "material": "steel"}],
        "axis": {"bearing_a": [0, 0, 0], "bearing_b": [0, 0, 40]},
        "service": {"rpm": 3000},
        "tolerance": {"e_um": 5},
        "key": [{"convention": "F", "width": 12, "height": 12, "length": 10, "floor": 70, "z": 20, "angle": 33.3}],
        "plane": [plane],
        "plan": {"time": 3},
    }
    result = balance(Rotor.from_dict(fields, folder=tmp_path))
    (key,) = result.rotor.key_masses
    true = cmath.rect(key.mass * key.radius, key.angle)
    for k in result.correction.operations:
        deep = {"mill": (0.012, k.depth), "mill_arc": (0.012, k.depth, k.arc)}.get(work)
        size = (
            radial_unbalance(7850, 0.1, 0.01, k.depth, k.point_angle)
            if deep is None
            else (flat_unbalance if work == "mill" else arc_unbalance)(7850, 0.1, *deep)
        )
        true -= cmath.rect(size, k.angle)
    off = abs(true - result.residual.static)
    stated = result.residual.bounds_of(1.0, 0.0)["tessellation"]
    assert off <= stated
    assert off > 0.05 * stated
