"""Mistakes are made on purpose, and named."""

import numpy as np
import pytest
from numpy.linalg import eigh, eigvalsh
from tests.auditing.shapes import STEEL, context, pair, skewed

from inertia.arrays import Float
from inertia.auditing.bodies import Body, together
from inertia.auditing.claim import Context, Statement
from inertia.auditing.search import explain
from inertia.exchange.robots.links import Figures
from inertia.mass.tensor import point_inertia

PRODUCTS = np.array([[1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])


def truth() -> Body:
    return context(pair()).truth.body


def with_tensor(inertia: Float) -> Body:
    return truth()._replace(inertia=inertia)


def inverted(inertia: Float) -> Float:
    moments, axes = eigh(inertia)
    axes = axes * [1, 1, np.linalg.det(axes)]
    return axes.T @ np.diag(moments) @ axes


def of_shell() -> Body:
    shell = together(shape.shell for shape in pair())
    return shell.weighed(truth().mass / shell.mass)


def of_hulls() -> Body:
    boxes = together(shape.box_solid for shape in pair())
    return boxes.weighed(truth().mass / boxes.mass)


def counted(*copies: int) -> Body:
    bodies = [shape.solid for shape, count in zip(pair(), copies, strict=True) for _ in range(count)]
    return together(bodies).weighed(truth().mass / sum(body.mass for body in bodies))


QUARTER = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # y up where z was


def turned(turn: Float) -> Body:
    bodies = []
    for shape in pair():
        way = shape.rotation @ turn @ shape.rotation.T
        center = shape.origin + way @ (shape.solid.center - shape.origin)
        bodies.append(Body(STEEL * shape.solid.mass, center, STEEL * way @ shape.solid.inertia @ way.T))
    return together(bodies)


SINGLE = {
    "product_signs": lambda: with_tensor(truth().inertia * PRODUCTS),
    "products_left_out": lambda: with_tensor(np.diag(np.diag(truth().inertia))),
    "principal_moments_as_diagonal": lambda: with_tensor(np.diag(eigvalsh(truth().inertia)[::-1])),
    "missing_steiner": lambda: with_tensor(sum(STEEL * shape.solid.inertia for shape in pair())),
    "about_origin": lambda: with_tensor(truth().inertia + point_inertia(truth().mass, truth().center)),
    "axes_permuted": lambda: with_tensor(truth().inertia[[1, 2, 0]][:, [1, 2, 0]]),
    "mesh_turned": lambda: turned(QUARTER),
    "unit_scale": lambda: with_tensor(1e6 * truth().inertia),
    "mass_scale": lambda: truth()._replace(mass=1e3 * truth().mass),
    "shell_for_solid": of_shell,
    "hull_for_mesh": of_hulls,
    "mesh_left_out": lambda: counted(1, 0),
    "mesh_counted_twice": lambda: counted(2, 1),
    "mirrored": lambda: truth().mirrored(1),
    "unphysical": lambda: with_tensor(np.eye(3) * np.trace(truth().inertia) / 3),
}


@pytest.mark.parametrize("code", SINGLE)
@pytest.mark.parametrize("noise", [0.0, 0.005])
def test_a_mistake_is_named(code: str, noise: float) -> None:
    stated = SINGLE[code]()
    wobble = np.random.default_rng(3).uniform(-1, 1, (3, 3))
    stated = stated._replace(inertia=stated.inertia * (1 + noise * (wobble + wobble.T) / 2))
    search = explain(context(pair(), stated))
    assert search.named is not None
    assert search.named.codes == {code}
    assert search.named.residual <= noise + 1e-9


def test_the_conjugated_rotation_is_named() -> None:
    stated = with_tensor(inverted(truth().inertia))
    named = explain(context(pair(), stated)).named
    assert named is not None
    assert "inverse (conjugated) rotation" in named.mistakes[0].words


def test_two_mistakes_are_named() -> None:
    tensor = sum(STEEL * shape.solid.inertia for shape in pair())
    stated = with_tensor(np.diag(eigvalsh(tensor)[::-1]))
    named = explain(context(pair(), stated)).named
    assert named is not None
    assert named.codes == {"missing_steiner", "principal_moments_as_diagonal"}
    assert named.residual < 1e-9


def test_a_rotation_stated_beside_a_tensor_along_the_link_s_axes_is_named() -> None:
    shape = skewed()
    body = context([shape]).truth.body
    stated = body._replace(inertia=shape.rotation @ body.inertia @ shape.rotation.T)
    named = explain(context([shape], stated, shape.rotation)).named
    assert named is not None
    assert named.codes == {"axes_permuted"}


def test_nothing_is_named_that_does_not_explain() -> None:
    stated = with_tensor(truth().inertia + np.diag([0.3, 0.1, 0.2]) * np.trace(truth().inertia))
    search = explain(context(pair(), stated))
    assert search.named is None


def test_what_is_sound_is_explained_by_nothing_alone() -> None:
    assert context(pair()).truth.residual < 1e-12


def test_rounding_to_few_decimals_is_named() -> None:
    shape = skewed()
    body = context([shape]).truth.body
    decimals = 1 - int(np.floor(np.log10(np.abs(body.inertia).max())))  # one digit of the largest, and no more
    rounded = body._replace(inertia=body.inertia.round(decimals - 1))
    stated = Statement(rounded, np.eye(3), (None, Figures(decimals - 1, 1)))
    named = explain(Context(stated, [shape])).named
    assert named is not None
    assert named.codes == {"rounded"}


def test_axes_that_are_turned_and_not_only_permuted_are_named_whatever_axes_the_tensor_is_written_along() -> None:
    axes = eigh(truth().inertia)[1]
    axes = axes * [1, 1, np.linalg.det(axes)]
    stated = with_tensor(QUARTER @ truth().inertia @ QUARTER.T)
    for rotation in (np.eye(3), QUARTER @ axes):
        named = explain(context(pair(), stated, rotation)).named
        assert named is not None
        kinds = [named, *named.alike]
        (words,) = {each.mistakes[0].words for each in kinds if each.codes == {"axes_permuted"}}
        assert "x -z y stand in the fields of x y z" in words


def test_a_centre_is_left_at_the_origin_only_if_it_is_there() -> None:
    named = explain(context(pair(), truth()._replace(center=np.zeros(3)))).named
    assert named is not None
    assert named.codes == {"center_at_origin"}
    near = explain(context(pair(), truth()._replace(center=np.array([0.0, 6e-4, 4e-4]))))
    assert all("center_at_origin" not in each.codes for each in near.candidates)


def test_a_mass_and_lengths_in_wrong_units_are_two_mistakes() -> None:
    body = truth()
    stated = Body(1e3 * body.mass, 1e3 * body.center, 1e6 * body.inertia)
    named = explain(context(pair(), stated)).named
    assert named is not None
    assert named.codes == {"mass_scale", "unit_scale"}
    assert named.residual < 1e-9


def test_the_order_of_mistakes_at_point_and_axes_does_not_matter() -> None:
    at_origin = point_inertia(truth().mass, truth().center)
    for tensor in (np.diag(eigvalsh(truth().inertia + at_origin)), np.diag(eigvalsh(truth().inertia)) + at_origin):
        named = explain(context(pair(), with_tensor(tensor))).named
        assert named is not None
        assert named.codes == {"about_origin", "principal_moments_as_diagonal"}
