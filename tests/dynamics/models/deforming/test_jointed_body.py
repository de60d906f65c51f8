"""Tensor, internal angular momentum and energy of an assembly, against sums over particles."""

import mpmath
import numpy as np
import pytest
from mpmath import mpf
from tests.dynamics.models.deforming.assemblies import cat, diver, skater
from tests.dynamics.models.deforming.particles import DIGITS, Swarm

from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.deforming.jointed_body import JointedBody
from inertia.dynamics.models.deforming.joints import Joint, JointedPart
from inertia.errors import UsageError


def askew(seed: int) -> JointedBody:
    """Return four parts, one of them listed before its parent, on joints in any direction."""
    rng = np.random.default_rng(seed)

    def part(name: str, parent: str | None, joints: tuple[Joint, ...] = ()) -> JointedPart:
        points = rng.normal(size=(5, 3))
        spread = points.T @ points
        return JointedPart(
            name, rng.uniform(0.5, 3), np.trace(spread) * np.eye(3) - spread, rng.normal(size=3), parent, joints
        )

    def joint(kind: str) -> Joint:
        keyframes = {"times": [0.0, 0.7, 1.0], kind: rng.normal(size=3), "rates": rng.normal(size=3)}
        return Joint(axis=rng.normal(size=3), point=rng.normal(size=3), **keyframes)

    return JointedBody(
        (
            part("hand", "arm", (joint("angles"),)),
            part("trunk", None),
            part("arm", "trunk", (joint("angles"), joint("displacements"), joint("angles"))),
            part("hat", "trunk"),
        )
    )


@pytest.mark.parametrize("assembly", [askew(1), askew(2), cat(), diver(), skater()])
def test_the_shape_is_what_particles_sum_to(assembly: JointedBody) -> None:
    times = [-0.2, 0.15, 0.4, 0.7, 1.3]
    shape, swarm = assembly.shape(times), Swarm(assembly)
    with mpmath.workdps(DIGITS):
        for k, time in enumerate(times):
            tensor, momentum, energy = swarm.moments(mpf(time))
            true = np.array(tensor.tolist(), dtype=float)
            size = np.abs(true).max()
            pace = 1.0 + float(energy) / size
            np.testing.assert_allclose(shape.inertia[k], true, rtol=0, atol=1e-14 * size)
            np.testing.assert_allclose(
                shape.internal_angular_momentum[k], [float(h) for h in momentum], rtol=0, atol=3e-14 * size * pace
            )
            assert shape.internal_energy[k] == pytest.approx(float(energy), rel=3e-13, abs=1e-14 * size)


def test_poses_carry_the_particles_to_where_they_are() -> None:
    assembly = askew(3)
    swarm, shape = Swarm(assembly), assembly.shape([0.4])
    with mpmath.workdps(DIGITS):
        places = np.array([[float(x) for x in place] for place in swarm.places(mpf(0.4))])
    for (part, _, start), place in zip(swarm.particles, places, strict=True):
        k = assembly.parts.index(part)
        moved = quaternion.to_space(shape.part_attitude[0, k], [float(x) for x in start]) + shape.part_position[0, k]
        np.testing.assert_allclose(moved, place, atol=1e-14)


def test_a_part_without_joints_is_fixed_to_its_parent_and_the_root_stays() -> None:
    shape = askew(4).shape([0.3, 0.9])
    for k in (1, 3):
        assert shape.part_attitude[:, k].tolist() == [[0.0, 0.0, 0.0, 1.0]] * 2
        assert shape.part_position[:, k].tolist() == [[0.0, 0.0, 0.0]] * 2


def test_keyframes_are_those_of_the_joints_that_move() -> None:
    assert diver(0.3, 1.2).keyframes.tolist() == [0.3, 0.55, 1.2, 1.45]


BALL = {"mass": 1.0, "inertia": np.eye(3)}


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        ([], r"part is empty"),
        ([("trunk", None), ("arm", "trnk")], r'part\[1\]\.parent is "trnk", which is no part: did you mean "trunk"\?'),
        ([("trunk", None), ("trunk", "trunk")], r'part\[1\]\.name is "trunk" like part\[0\]'),
        ([("a", None), ("b", None)], r"part has 2 roots, a, b: give all but one a parent"),
        ([("a", "b"), ("b", "a")], r"part has no way from a root to a, b"),
        ([("root", None), ("a", "c"), ("b", "a"), ("c", "b")], r"part has no way from a root to a, b, c"),
    ],
)
def test_parts_that_make_no_tree_are_refused(parts: list[tuple[str, str | None]], says: str) -> None:
    with pytest.raises(UsageError, match=says):
        JointedBody([JointedPart(name=name, parent=parent, **BALL) for name, parent in parts])
