"""What looks alike is told apart, or said to be alike; what merely can be fitted is not called consistent."""

from dataclasses import replace

import numpy as np
import pytest
from tests.auditing.shapes import STEEL, context, pair, skewed, tetrahedron

from inertia.auditing.bodies import Body, Shape, solid_of, together
from inertia.auditing.claim import Context, Statement
from inertia.auditing.densities import invert
from inertia.auditing.judge import Subject, Weighed, judge
from inertia.auditing.physical import outside
from inertia.auditing.search import explain
from inertia.exchange.robots.links import Figures
from inertia.mass.properties import ErrorBound, MassProperties

TURNED = np.array([[1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])


def subject(shapes: list[Shape], body: Body) -> Subject:
    """Return shapes and what is stated of them as a link to be judged."""
    error = ErrorBound("exact", 0.0, 0.0, 0.0, 0.0)
    weighed = [
        Weighed(
            shape,
            MassProperties(shape.solid.mass, shape.solid.mass, shape.solid.center, shape.solid.inertia, error),
        )
        for shape in shapes
    ]
    return Subject("link", Statement(body, np.eye(3)), weighed)


def scaled(shape: Shape, factor: float, *, with_origin: bool = False) -> Shape:
    """Return a shape whose mesh is so many times as large where it is placed, or whose place is as far out too."""
    origin = shape.origin * factor if with_origin else shape.origin
    corners = origin + (shape.corners - shape.origin) * factor
    return replace(shape, corners=corners, solid=solid_of(corners), origin=origin)


FORGOTTEN = {"in millimetres": 1e3, "in centimetres": 1e2, "in inches": 1 / 0.0254, "once too often": 1e-3}


@pytest.mark.parametrize("words", FORGOTTEN)
@pytest.mark.parametrize("at", [(0.11, -0.07, 0.05), (3.0, 2.0, -1.0)])
def test_meshes_in_another_unit_are_scaled_where_they_are_placed(words: str, at: tuple[float, float, float]) -> None:
    shapes = [skewed(at=at), skewed("lower.stl", 8, (-0.06, 0.09, 0.13))]
    body, factor = context(shapes).truth.body, FORGOTTEN[words]
    stated = Statement(body, np.eye(3))
    both, one = [scaled(shape, factor) for shape in shapes], [scaled(shapes[0], factor), shapes[1]]
    out = [scaled(shape, factor, with_origin=True) for shape in shapes]
    for wrong, of in ((both, "the mesh is "), (one, "upper.stl is "), (out, "the mesh and its origin are ")):
        if wrong is one and factor < 1:  # so small a mesh asks for no density of its own
            continue
        named = explain(Context(stated, wrong)).named
        assert named is not None
        assert named.mistakes[0].words.startswith(of)
        assert words in named.mistakes[0].words
        assert named.residual < 1e-9


def test_what_remains_is_measured_by_the_mesh_as_it_is_once_scaled() -> None:
    """Half a metre of mesh in millimetres: a centre 3 m off is 0.6 % of the way across what stands in the file."""
    body, large = context([skewed()]).truth.body, scaled(skewed(), 1e3)
    for away in (np.array([3.0, 0.0, 0.0]), np.array([0.0, 0.2, 0.0])):
        result = judge(subject([large], body._replace(center=body.center + away)), [], 0.02)
        assert result.state == "inconsistent"
        assert [finding.code for finding in result.findings][-2:] == ["unexplained", "mass_scale"]
    near = judge(subject([large], body._replace(center=body.center + np.array([1e-3, 0.0, 0.0]))), [], 0.02)
    (finding,) = near.findings
    assert finding.code == "unit_scale"
    low, high = skewed().box
    assert finding.residual == pytest.approx(1e-3 / np.linalg.norm(high - low), rel=1e-9)


def test_another_mistake_beside_a_mesh_in_millimetres_is_made_of_the_mesh_once_scaled() -> None:
    body, large = context([skewed()]).truth.body, scaled(skewed(), 1e3)
    turned = body._replace(inertia=body.inertia * TURNED)
    place = body.center - skewed().origin  # of the tensor about the mesh's origin
    about = body._replace(inertia=body.inertia + body.mass * (place @ place * np.eye(3) - np.outer(place, place)))
    for stated, code in ((turned, "product_signs"), (about, "about_origin")):
        named = explain(Context(Statement(stated, np.eye(3)), [large])).named
        assert named is not None
        assert [mistake.code for mistake in named.mistakes] == ["unit_scale", code]
        assert named.residual < 1e-9
    known = replace(Context(Statement(body, np.eye(3)), [large]), densities=[STEEL])
    named = explain(known).named
    assert named is not None
    assert named.mistakes[0].words == "the mesh is in millimetres and its scale is not stated"


def test_a_primitive_beside_a_mesh_in_millimetres_is_as_large_as_it_is() -> None:
    mesh, primitive = pair()
    primitive = replace(primitive, surface=primitive.shell)
    body = context([mesh, primitive]).truth.body
    named = explain(Context(Statement(body, np.eye(3)), [scaled(mesh, 1e3), primitive])).named
    assert named is not None
    assert named.mistakes[0].words == "the mesh is in millimetres and its scale is not stated"


def test_a_mesh_in_millimetres_is_told_from_numbers_in_millimetres_by_its_density() -> None:
    body = context([skewed()]).truth.body
    large = scaled(skewed(), 1e3)
    named = explain(Context(Statement(body, np.eye(3)), [large])).named
    assert named is not None
    assert named.mistakes[0].of_mesh
    small = Body(body.mass, body.center * 1e3, body.inertia * 1e6)
    named = explain(Context(Statement(small, np.eye(3)), [skewed()])).named
    assert named is not None
    assert not named.mistakes[0].of_mesh


def test_grams_are_the_mass_s_or_the_tensor_s_by_the_density() -> None:
    body = context([skewed()]).truth.body
    named = explain(context([skewed()], body._replace(mass=1e3 * body.mass))).named
    assert named is not None
    assert "the mass is in grams" in named.mistakes[0].words
    named = explain(context([skewed()], body._replace(inertia=body.inertia / 1e3))).named
    assert named is not None
    assert "the tensor is divided" in named.mistakes[0].words


def test_mistakes_that_come_to_the_same_are_all_said() -> None:
    # A mirror image in x with its centre in the plane x = 0 has but two products of the other sign.
    shape = skewed()
    center = shape.solid.center
    shape = Shape(shape.name, shape.corners - [center[0], 0, 0], shape.solid, np.eye(3), np.zeros(3))
    shape = Shape(shape.name, shape.corners, solid_of(shape.corners), np.eye(3), np.zeros(3))
    body = context([shape]).truth.body.mirrored(0)
    result = judge(subject([shape], body), [], 0.02)
    assert [finding.code for finding in result.findings] == ["mirrored", "alike"]
    assert "ixy and ixz is turned" in result.findings[1].sentence


def test_a_far_link_is_measured_by_its_own_size() -> None:
    shape = skewed(at=(3.0, 0.0, 0.0))
    body = context([shape]).truth.body
    assert judge(subject([shape], body), [], 0.02).state == "consistent"
    astray = body._replace(
        center=body.center + np.array([0.02, 0, 0])
    )  # 0.7 % of the way from the origin, 6 % of the link
    assert judge(subject([shape], astray), [], 0.02).state == "inconsistent"


def test_two_mistakes_are_not_named_where_one_of_them_does_next_to_nothing() -> None:
    body = context(pair()).truth.body
    stated = body._replace(inertia=body.inertia * TURNED + 0.021 * np.trace(body.inertia) * np.eye(3) / 2)
    search = explain(context(pair(), stated))
    assert search.named is None or len(search.named.mistakes) == 1


def test_the_centre_left_at_the_origin_is_named() -> None:
    body = context(pair()).truth.body
    named = explain(context(pair(), body._replace(center=np.zeros(3)))).named
    assert named is not None
    assert named.codes == {"center_at_origin"}


def test_numbers_in_the_frame_of_the_mesh_are_named() -> None:
    shape = skewed()
    body = context([shape]).truth.body
    turn = shape.rotation.T
    own = Body(body.mass, turn @ (body.center - shape.origin), turn @ body.inertia @ turn.T)
    named = explain(context([shape], own)).named
    assert named is not None
    assert named.codes == {"mesh_frame"}


def test_one_box_around_all_meshes_is_named() -> None:
    low, high = (np.array(ends) for ends in zip(*(shape.box for shape in pair()), strict=True))
    sides = high.max(axis=0) - low.min(axis=0)
    mass = context(pair()).truth.body.mass
    inertia = mass / 12 * np.diag(np.sum(sides**2) - sides**2)
    stated = Body(mass, (high.max(axis=0) + low.min(axis=0)) / 2, inertia)
    named = explain(context(pair(), stated)).named
    assert named is not None
    assert named.codes == {"hull_for_mesh"}
    assert "one box" in named.mistakes[0].words


def test_densities_near_two_to_one_are_no_mesh_counted_twice() -> None:
    one, two = pair()
    near = together([one.solid.weighed(2160.0), two.solid.weighed(1000.0)])
    result = judge(subject(pair(), near), [], 0.02)
    assert (result.state, [finding.code for finding in result.findings]) == ("consistent", ["densities"])
    twice = together([one.solid.weighed(2000.0), two.solid.weighed(1000.0)])
    result = judge(subject(pair(), twice), [], 0.02)
    assert (result.state, [finding.code for finding in result.findings]) == ("inconsistent", ["mesh_counted_twice"])


def test_ten_densities_that_fit_ten_numbers_prove_nothing() -> None:
    rng = np.random.default_rng(1)
    shapes = []
    for k in range(10):
        corners = tetrahedron(rng.normal(size=(4, 3)) * 0.02 + rng.normal(size=3) * 0.1)
        shapes.append(Shape(f"{k}.stl", corners, solid_of(corners), np.eye(3), np.zeros(3)))
    body = together(
        [shape.solid.weighed(density) for shape, density in zip(shapes, rng.uniform(500, 8000, 10), strict=True)]
    )
    densities = invert(context(shapes, body))
    assert densities is not None
    assert densities.residual < 1e-6
    assert not densities.telling
    result = judge(subject(shapes, body), [], 0.02)
    assert (result.state, [finding.code for finding in result.findings]) == ("unjudged", ["undecided"])


def test_two_densities_leave_something_to_prove() -> None:
    densities = invert(context(pair(), context(pair()).truth.body))
    assert densities is not None
    assert densities.telling


def test_no_tensor_at_all_is_no_fault_of_the_arithmetic() -> None:
    body = context(pair()).truth.body._replace(inertia=np.zeros((3, 3)))
    result = judge(subject(pair(), body), [], 0.02)
    assert result.state == "unphysical"


def test_a_thin_plate_written_to_three_figures_may_have_its_mass_within_it() -> None:
    half = np.array([0.5, 0.5, 0.0005])
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    inertia = np.diag([0.0834, 0.0834, 0.167])  # 1 kg: second moments along z of −0.0001 m² to 0.0001 m²
    inertia[2, 2] = 0.1665
    stated = Statement(Body(1.0, np.zeros(3), inertia), np.eye(3), (Figures(1, 1), Figures(4, 4)))
    hull = np.concatenate([tetrahedron(corners[[0, 3, 5, 6]]), tetrahedron(corners[[1, 2, 4, 7]])])
    assert not list(outside(stated, hull))
    assert list(outside(Statement(stated.body, np.eye(3)), hull))


def test_steel_is_steel() -> None:
    assert judge(subject(pair(), context(pair()).truth.body), [], 0.02).densities == pytest.approx([STEEL] * 2)


def test_a_multiple_of_the_identity_is_one_along_turned_axes_too() -> None:
    turn = skewed().rotation
    body = Body(1.0, context(pair()).truth.body.center, turn @ (0.1 * np.eye(3)) @ turn.T)
    stated = Statement(body, turn)
    result = judge(replace(subject(pair(), body), stated=stated), [], 0.02)
    assert "placeholder" in [finding.code for finding in result.findings]


def test_facets_that_stand_for_a_ball_are_no_hull_of_it() -> None:
    """The corners of a ball lie on it, so that their hull holds less: what is stated of the ball is not of a hull."""
    rng = np.random.default_rng(2)
    points = rng.normal(size=(60, 3))
    corners = tetrahedron(points[:4]) * 0
    corners = np.concatenate([corners, (points / np.linalg.norm(points, axis=1)[:, None]).reshape(-1, 3, 3)])
    ball = Body(4 / 3 * np.pi, np.zeros(3), 8 / 15 * np.pi * np.eye(3))
    shape = Shape("ball", corners, ball, np.eye(3), np.zeros(3))
    assert shape.hull_solid is ball


def test_explanations_that_differ_by_less_than_what_is_left_are_alike() -> None:
    """Two moments that are nearly one: their order is no difference beside a centre that is 1 % off."""
    shape = skewed()
    body = Body(shape.solid.mass, shape.solid.center, np.trace(shape.solid.inertia) / 6 * np.diag([1.0, 2.5, 2.503]))
    shape = replace(shape, solid=body, rotation=np.eye(3), origin=np.zeros(3))
    truth = context([shape]).truth.body
    moved = truth.center + np.array([0.0, 0.0, 0.012 * context([shape]).size])
    named = explain(
        context([shape], truth._replace(center=moved, inertia=np.diag(np.diag(truth.inertia)[[1, 2, 0]])))
    ).named
    assert named is not None
    assert "axes_permuted" in set().union(named.codes, *(each.codes for each in named.alike))
