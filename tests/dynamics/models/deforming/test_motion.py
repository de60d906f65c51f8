"""Bodies that change shape, against closed forms, an integration in mpmath, and momentum summed over particles."""

import tracemalloc
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from tests.dynamics.models.deforming import assemblies
from tests.dynamics.models.deforming.assemblies import cat, diver, overturning_bend, skater
from tests.dynamics.models.deforming.particles import Swarm, apart, value

from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.deforming.collocation import collocate
from inertia.dynamics.models.deforming.jointed_body import JointedBody
from inertia.dynamics.models.deforming.joints import Joint, JointedPart
from inertia.dynamics.models.deforming.motion import solve_deforming
from inertia.dynamics.motion import Motion
from inertia.errors import GeometryError, UsageError

Y, Z = np.eye(3)[1:]


def turned(axis: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Return quaternions (n, 4) of turns by `angle` (n,) about an axis."""
    return quaternion.from_rotation_vector(np.multiply.outer(angle, axis))


def worst(attitude: np.ndarray, true: np.ndarray) -> float:
    return float(quaternion.angle_between(attitude, true).max())


def two_hinged() -> JointedBody:
    """Return two asymmetric parts joined askew, by a hinge that never rests and a slide."""
    hinge = Joint([1, 2, 3], [0.0, 0.4, 1.0], angles=[0.1, 1.2, -0.5], point=[0.5, 0.1, 0.2], rates=[1, 0.5, -1])
    slide = Joint([0, 1, 1], [0.2, 0.6], displacements=[0.0, 0.3])
    tensor = [[1, 0.1, -0.2], [0.1, 1.5, 0.05], [-0.2, 0.05, 2]]
    return JointedBody(
        (
            JointedPart("a", 2.0, tensor, [0.1, 0.2, 0.3]),
            JointedPart("b", 1.0, np.diag([0.3, 0.4, 0.5]), [0.9, 0.1, 0], "a", (hinge, slide)),
        )
    )


def wheel_in(moments: list[float], spin: float) -> JointedBody:
    """Return a gyrostat: a body with a wheel on axis 3 that turns steadily against it."""
    wheel = Joint(axis=Z, times=[0.0], angles=[0.3], rates=[spin])
    return JointedBody(
        (
            JointedPart("carrier", 1.0, np.diag(moments)),
            JointedPart("wheel", 1.0, np.diag([0.1, 0.1, 0.2]), parent="carrier", joints=(wheel,)),
        )
    )


def test_two_coaxial_bodies_share_the_turn_as_their_moments() -> None:
    spun = Joint(axis=Z, times=[0.5, 1.0, 2.0], angles=[0.0, 4.0, 1.0], rates=[0.0, 3.0, 0.0])
    parts = (
        JointedPart("stool", 1.0, np.diag([2, 2, 3])),
        JointedPart("wheel", 2.0, np.diag([1, 1, 0.5]), [0, 0, 1], "stool", (spun,)),
    )
    time = np.linspace(0, 3, 40)
    motion = solve_deforming(JointedBody(parts), time, 1e-12, angular_velocity=[0, 0, 2.0])
    angle = np.array([(3.5 * 2.0 * t - 0.5 * float(value(spun, mpmath.mpf(t)))) / 3.5 for t in time])
    assert worst(motion.attitude, turned(Z, angle)) < 1e-14


def test_a_skater_spins_faster_as_the_arms_come_in() -> None:
    time = np.linspace(0, 6, 25)
    motion = solve_deforming(skater(), time, 1e-12, angular_velocity=[0, 0, 8.0])
    trunk, arm = assemblies.SKATER_TRUNK * 0.15**2 / 2, assemblies.SKATER_ARM
    joint = skater().parts[1].joints[0]

    def moment(t: mpmath.mpf) -> mpmath.mpf:
        return trunk + 2 * arm * (mpmath.mpf(assemblies.SKATER_OUT) + value(joint, t)) ** 2

    momentum = moment(mpmath.mpf(0)) * 8
    spin = np.array([float(momentum / moment(mpmath.mpf(t))) for t in time])
    np.testing.assert_allclose(motion.angular_velocity[:, 2], spin, rtol=1e-14)
    assert motion.angular_velocity[10, 2] > 30  # 8 rad/s with the arms out
    with mpmath.workdps(25):
        pieces = [
            mpmath.quad(lambda t: momentum / moment(t), [a, (a + b) / 2, b]) for a, b in pairwise(map(float, time))
        ]
        turn = np.concatenate([[0.0], np.cumsum(np.array([float(p) for p in pieces]))])
    assert worst(motion.attitude, turned(Z, turn)) < 2e-13  # which the sum of the pieces is good for
    energy = 0.5 * float(momentum) * spin
    rates = np.array([float(mpmath.diff(lambda s: value(joint, s), mpmath.mpf(t))) for t in time])
    np.testing.assert_allclose(motion.quantities["kinetic energy"], energy + arm * rates**2, rtol=1e-9)
    np.testing.assert_allclose(motion.quantities["work of the joints"][8:12], energy[8:12] - energy[0], rtol=1e-12)


def cat_attitude(bend: float, time: np.ndarray) -> np.ndarray:
    """Return the attitude of the rear half of a cat without angular momentum, in closed form.

    The rear half is off the mean direction of the spine by −β/2. While both halves turn by σ about their own axes,
    the plane of the bend β turns about the mean direction, which passes through all centres of mass, by
    −σ A c / (A c² + B s²), c and s the cosine and sine of β/2: Kane and Scher, Int. J. Solids Struct. 5 (1969) 663,
    for two cylinders whose bend stays the same.
    """
    _, bent, forth = cat(bend).parts[1].joints
    beta, sigma = (np.array([float(value(j, mpmath.mpf(t))) for t in time]) for j in (bent, forth))
    across, _, along = np.diag(assemblies.cylinder(assemblies.CAT_HALF, assemblies.CAT_RADIUS, assemblies.CAT_LENGTH))
    c, s = np.cos(bend / 2), np.sin(bend / 2)
    plane = turned(Z, -sigma * along * c / (along * c**2 + across * s**2))
    return quaternion.multiply(plane, quaternion.multiply(turned(Y, -beta / 2), turned(Z, sigma)))


@pytest.mark.parametrize("bend", [0.1, 1.0, overturning_bend(), 2.5])
def test_a_cat_turns_without_angular_momentum_as_in_closed_form(bend: float) -> None:
    time = np.linspace(0, 0.5, 101)
    motion = solve_deforming(cat(bend), time, 1e-12, angular_velocity=[0, 0, 0])
    assert motion.reached < 1e-12
    assert worst(motion.attitude, cat_attitude(bend, time)) < 2e-14
    assert np.abs(motion.invariants["angular momentum"]).max() < 1e-14 * motion.scales["angular momentum"]


def test_a_cat_lands_on_its_feet_falling() -> None:
    motion = solve_deforming(cat(), [0.0, 0.4], 1e-12, angular_velocity=[0, 0, 0], gravity=[-9.81, 0, 0])
    assert motion.scales["angular momentum"] > 1  # though h vanishes at both samples
    feet = quaternion.to_space(motion.attitude, [1.0, 0.0, 0.0])
    np.testing.assert_allclose(feet, [[1, 0, 0], [-1, 0, 0]], atol=1e-13)
    assert motion.position is not None
    np.testing.assert_allclose(motion.position, [[0, 0, 0], [-0.5 * 9.81 * 0.16, 0, 0]], atol=1e-15)
    np.testing.assert_allclose(motion.angular_velocity[-1], 0, atol=1e-12)


@pytest.mark.parametrize("spin", [0.0, 40.0, -7.0])
def test_an_axisymmetric_gyrostat_precesses_as_in_closed_form(spin: float) -> None:
    assembly, omega, time = wheel_in([1.9, 1.9, 0.8], spin), np.array([0.3, -0.4, 2.0]), np.linspace(0, 20, 57)
    motion = solve_deforming(assembly, time, 1e-11, angular_velocity=omega)
    momentum = np.array([2.0, 2.0, 1.0]) * omega + [0, 0, 0.2 * spin]
    size = np.linalg.norm(momentum)
    precession, proper = turned(momentum / size, size / 2.0 * time), turned(Z, (omega[2] - momentum[2] / 2.0) * time)
    assert worst(motion.attitude, quaternion.multiply(precession, proper)) < 4e-13
    assert motion.reached < 1e-11
    assert ("energy" in motion.invariants) == (spin == 0)
    np.testing.assert_allclose(motion.quantities["work of the joints"], 0, atol=1e-11)


def test_a_wheel_turns_a_body_at_rest_the_other_way() -> None:
    motion = solve_deforming(wheel_in([1.9, 1.9, 0.8], 5.0), [0.0, 1.0], 1e-12, angular_momentum=[0, 0, 0])
    np.testing.assert_allclose(motion.angular_velocity, [[0, 0, -1.0]] * 2, atol=1e-15)


def test_an_askew_assembly_follows_its_particles_integrated_in_mpmath() -> None:
    assembly, time = two_hinged(), [0.0, 0.2, 0.4]
    start = quaternion.normalise([1.0, -2.0, 0.5, 3.0])
    motion = solve_deforming(assembly, time, 1e-13, angular_velocity=[1.0, 2.0, -3.0], attitude=start)
    true = Swarm(assembly).follow(motion.invariants["angular momentum"][0], time, 0.1, start)  # good to 1e-21
    assert apart(motion.attitude, true) < 2e-15
    assert motion.reached < 1e-13


def particle_motion(assembly: JointedBody, motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Return masses (p,) and places (n, p, 3) in space, from positions, attitudes and poses alone."""
    swarm = Swarm(assembly)
    poses, places = motion.quantities["part poses"], []
    for part, _, start in swarm.particles:
        pose = poses[:, assembly.parts.index(part)]
        in_root = quaternion.to_space(pose[:, 3:], [float(x) for x in start]) + pose[:, :3]
        places.append(quaternion.to_space(motion.attitude, in_root) + motion.position)
    return np.array([float(m) for m in swarm.masses]), np.stack(places, axis=1)


@pytest.mark.parametrize(
    ("assembly", "omega"), [(two_hinged(), [1.0, 2.0, -3.0]), (diver(), [0.0, 6.0, 0.0]), (cat(), [0.0, 0.0, 0.0])]
)
def test_particles_keep_their_angular_momentum_and_fall_freely(assembly: JointedBody, omega: list[float]) -> None:
    tick, velocity, gravity = 1e-4, np.array([1.0, 0, 4.0]), np.array([0, 0, -9.81])
    middle = np.array([0.05, 0.21, 0.35, 0.47, 0.8, 1.3])
    time = (middle[:, None] + tick * np.array([-2, -1, 0, 1, 2])).ravel()
    motion = solve_deforming(assembly, time, 1e-12, angular_velocity=omega, velocity=velocity, gravity=gravity)
    masses, places = particle_motion(assembly, motion)
    places = places.reshape(len(middle), 5, -1, 3)
    speeds = (8 * (places[:, 3] - places[:, 1]) - (places[:, 4] - places[:, 0])) / (12 * tick)
    center, drift = (masses @ x / masses.sum() for x in (places[:, 2], speeds))
    np.testing.assert_allclose(drift, velocity + np.outer(middle, gravity), atol=1e-10)
    first = center - np.outer(middle, velocity) - np.outer(0.5 * middle**2, gravity)
    np.testing.assert_allclose(first, first[:1].repeat(len(middle), axis=0), atol=1e-13)
    relative = speeds - drift[:, None]
    momentum = masses @ np.cross(places[:, 2] - center[:, None], relative)
    scale = motion.scales["angular momentum"]
    np.testing.assert_allclose(momentum, motion.invariants["angular momentum"][2::5], atol=3e-9 * scale)
    np.testing.assert_allclose(momentum, momentum[:1].repeat(len(middle), axis=0), atol=3e-9 * scale)
    energy = 0.5 * np.sum(relative**2, axis=-1) @ masses
    np.testing.assert_allclose(motion.quantities["kinetic energy"][2::5], energy, rtol=1e-8, atol=1e-9)


def test_a_diver_twists_because_one_arm_came_down() -> None:
    time = np.linspace(0, 1.2, 121)
    still = solve_deforming(diver(5.0, 6.0), time, 1e-11, angular_velocity=[0, 6.0, 0])
    np.testing.assert_allclose(still.angular_velocity, [[0, 6.0, 0]] * len(time), atol=1e-11)
    motion = solve_deforming(diver(), time, 1e-11, angular_velocity=[0, 6.0, 0])
    np.testing.assert_allclose(motion.angular_velocity[:30], still.angular_velocity[:30], atol=1e-11)
    assert np.abs(motion.angular_velocity[56:, 2]).min() > 20
    momentum = motion.invariants["angular momentum"]
    assert np.abs(momentum - momentum[0]).max() < 1e-14 * motion.scales["angular momentum"]
    energy = motion.quantities["kinetic energy"][56:]  # the arm rests from 0.55 s on, and the joints do no work
    assert np.ptp(energy) < 1e-12 * energy[0]
    assert motion.quantities["work of the joints"][60] == pytest.approx(
        energy[4] - motion.quantities["kinetic energy"][0]
    )


def test_raising_the_arm_at_the_right_instant_ends_the_twist() -> None:
    motion = solve_deforming(diver(), [0.0, 1.5, 2.0], 1e-11, angular_velocity=[0, 6.0, 0])
    np.testing.assert_allclose(motion.angular_velocity, [[0, 6, 0]] * 3, atol=1e-4)
    np.testing.assert_allclose(quaternion.to_space(motion.attitude, Y), [Y] * 3, atol=1e-4)
    early = solve_deforming(diver(stop=1.15), [0.0, 1.5], 1e-11, angular_velocity=[0, 6.0, 0])
    assert abs(early.angular_velocity[1, 2]) > 3


@pytest.mark.parametrize("accuracy", [1e-2, 1e-5, 1e-8, 1e-11, 2e-13])
def test_what_is_reached_is_what_was_asked_and_bounds_the_error(accuracy: float) -> None:
    time, bend = np.linspace(0, 0.45, 91), 1.9
    motion = solve_deforming(cat(bend), time, accuracy, angular_velocity=[0, 0, 0])
    assert worst(motion.attitude, cat_attitude(bend, time)) < motion.reached < accuracy


def test_an_accuracy_beyond_float64_is_not_claimed() -> None:
    motion = solve_deforming(diver(), [0.0, 1.5], 1e-17, angular_velocity=[0, 6.0, 0])
    assert motion.reached > 1e-15


@pytest.mark.parametrize("begin", [0.5, 20.3])
@pytest.mark.parametrize("gap", [1e-1, 1e-3, 1e-6, 1e-9])
def test_keyframes_that_are_close_keep_the_claim_true(begin: float, gap: float) -> None:
    """The wheel turns by 4 rad within the gap; the stool takes back its share, and 2 rad/s go on."""
    spun = Joint(Z, [begin, begin + gap, begin + 2.5 * gap], angles=[0.0, 4.0, 1.0], rates=[0.0, 3.0 / gap, 0.0])
    parts = (
        JointedPart("stool", 1.0, np.diag([2, 2, 3])),
        JointedPart("wheel", 2.0, np.diag([1, 1, 0.5]), [0, 0, 1], "stool", (spun,)),
    )
    time = np.concatenate([[0.0], np.linspace(begin - gap, begin + 4 * gap, 40), [begin + 1.0]])
    motion = solve_deforming(JointedBody(parts), time, 1e-12, angular_velocity=[0, 0, 2.0])
    with mpmath.workdps(30):
        half = [mpmath.mpf(t) - value(spun, mpmath.mpf(t)) / 14 for t in time]
        true = np.array([[0, 0, mpmath.sin(a), mpmath.cos(a)] for a in half], dtype=object)
    assert apart(motion.attitude, true) < motion.reached < 1e-12


def test_joints_that_overlap_within_a_short_gap_keep_the_claim_true() -> None:
    """The oracle takes two steps from each keyframe to the next, with differences over far less than the gap."""
    gap = 1e-8
    hinge = Joint([1, 2, 3], [0.1, 0.1 + gap, 0.2], angles=[0.1, 1.2, -0.5], point=[0.5, 0.1, 0.2], rates=[1, 0.5, -1])
    slide = Joint([0, 1, 1], [0.0, 0.1 + gap / 2], displacements=[0.0, 0.3], rates=[0.2, -0.4])
    tensor = [[1, 0.1, -0.2], [0.1, 1.5, 0.05], [-0.2, 0.05, 2]]
    assembly = JointedBody(
        (
            JointedPart("a", 2.0, tensor, [0.1, 0.2, 0.3]),
            JointedPart("b", 1.0, np.diag([0.3, 0.4, 0.5]), [0.9, 0.1, 0], "a", (hinge, slide)),
        )
    )
    momentum, ends = [1.0, -2.0, 3.0], [0.0, 0.1, 0.1 + gap / 2, 0.1 + gap, 0.2]
    motion = solve_deforming(assembly, ends, 1e-13, angular_momentum=momentum)
    steps = [0.0, *(float(x) for a, b in pairwise(ends) for x in np.linspace(a, b, 3)[1:])]
    true = Swarm(assembly, tick=mpmath.mpf(10) ** -20).follow(momentum, steps, 1.0)[::2]
    assert apart(motion.attitude, true) < motion.reached < 1e-13


def test_the_order_is_13_within_steps_and_24_at_their_ends() -> None:
    inverse, spin, end = np.diag([0.5, 0.5, 1.0]), np.array([1.0, 0.5, 3.0]), 16.0
    momentum, time = spin / np.diag(inverse), np.linspace(0, end, 1001)
    size = np.linalg.norm(momentum)
    precession = turned(momentum / size, size * 0.5 * time)
    true = quaternion.multiply(precession, turned(Z, (spin[2] - momentum[2] * 0.5) * time))

    def rigid(t: np.ndarray, _: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.tile(inverse, (len(t), 1, 1)), np.zeros((len(t), 3))

    def errors(steps: int) -> np.ndarray:
        edges = np.linspace(0, end, steps + 1)
        attitude = collocate(momentum, rigid, np.array(quaternion.IDENTITY), edges).at(time)
        return np.log([worst(attitude, true), worst(attitude[-1:], true[-1:])])

    assert (errors(5) - errors(10))[0] / np.log(2) == pytest.approx(13, abs=0.5)
    assert (errors(4) - errors(5))[1] / np.log(5 / 4) == pytest.approx(24, abs=1.5)


def test_the_motion_runs_back_when_the_joints_do() -> None:
    def played(sign: int) -> JointedBody:
        a, b = two_hinged().parts
        joints = []
        for joint in b.joints:
            times = joint.times if sign > 0 else 1.0 - joint.times[::-1]
            columns = {"rates": sign * joint.rates[::sign]}
            columns["angles" if joint.revolute else "displacements"] = (
                joint.angles if joint.revolute else joint.displacements
            )[::sign]
            joints.append(Joint(joint.axis, times, point=joint.point, **columns))
        return JointedBody((a, JointedPart(b.name, b.mass, b.inertia, b.center_of_mass, b.parent, tuple(joints))))

    there = solve_deforming(played(1), [0.0, 1.0], 1e-12, angular_velocity=[1.0, 2.0, -3.0])
    back = solve_deforming(
        played(-1), [0.0, 1.0], 1e-12, angular_velocity=-there.angular_velocity[1], attitude=there.attitude[1]
    )
    assert worst(back.attitude[::-1], there.attitude) < 2e-14
    np.testing.assert_allclose(back.angular_velocity[::-1], -there.angular_velocity, rtol=1e-13)


def test_the_axes_that_an_assembly_is_drawn_in_do_not_matter() -> None:
    turn = quaternion.normalise([0.3, -0.5, 0.7, 0.2])
    matrix = quaternion.matrix(turn)

    def redrawn(part: JointedPart) -> JointedPart:
        joints = [
            Joint(matrix @ j.axis, j.times, j.angles, j.displacements, matrix @ j.point, j.rates) for j in part.joints
        ]
        tensor = matrix @ part.inertia @ matrix.T
        com = matrix @ part.center_of_mass
        return JointedPart(part.name, part.mass, 0.5 * (tensor + tensor.T), com, part.parent, tuple(joints))

    time, omega = np.linspace(0, 1.2, 13), np.array([1.0, 2.0, -3.0])
    plain = solve_deforming(two_hinged(), time, 1e-12, angular_velocity=omega)
    assembly = JointedBody([redrawn(part) for part in two_hinged().parts])
    other = solve_deforming(assembly, time, 1e-12, angular_velocity=matrix @ omega, attitude=quaternion.conjugate(turn))
    assert worst(quaternion.multiply(other.attitude, turn), plain.attitude) < 2e-14
    np.testing.assert_allclose(other.angular_velocity, plain.angular_velocity @ matrix.T, atol=1e-13)
    np.testing.assert_allclose(other.position, plain.position, atol=1e-13)


@pytest.mark.parametrize(("mass", "length", "pace"), [(1e-20, 1e-9, 1e6), (1e25, 1e7, 1e-5)])
def test_units_do_not_matter(mass: float, length: float, pace: float) -> None:
    def scaled(part: JointedPart) -> JointedPart:
        joints = [
            Joint(
                j.axis,
                j.times / pace,
                j.angles,
                None if j.displacements is None else j.displacements * length,
                j.point * length,
                j.rates * pace * (1.0 if j.revolute else length),
            )
            for j in part.joints
        ]
        tensor = part.inertia * mass * length**2
        return JointedPart(part.name, part.mass * mass, tensor, part.center_of_mass * length, part.parent, joints)

    time, omega = np.linspace(0, 1.2, 13), np.array([1.0, 2.0, -3.0])
    plain = solve_deforming(two_hinged(), time, 1e-12, angular_velocity=omega)
    other = solve_deforming(
        JointedBody([scaled(part) for part in two_hinged().parts]), time / pace, 1e-12, angular_velocity=omega * pace
    )
    assert worst(other.attitude, plain.attitude) < 2e-14
    assert other.reached < 1e-12


def test_a_run_of_many_samples_takes_little_more_memory_than_its_answer() -> None:
    # Blocks are no other arithmetic: the rows of a short run are those of a long one.
    time = np.linspace(0.0, 6.0, 40_001)
    solve_deforming(skater(), time[::1000], 1e-9, angular_velocity=[0.1, 0.0, 8.0])
    tracemalloc.start()
    motion = solve_deforming(skater(), time, 1e-9, angular_velocity=[0.1, 0.0, 8.0])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert motion.position is not None
    arrays = [motion.attitude, motion.angular_velocity, motion.position, *motion.quantities.values()]
    arrays += motion.invariants.values()
    assert peak < 2.0 * sum(each.nbytes for each in arrays)
    short = solve_deforming(skater(), time[::1000], 1e-9, angular_velocity=[0.1, 0.0, 8.0])
    np.testing.assert_array_equal(motion.attitude[::1000], short.attitude)
    for name, values in motion.quantities.items():
        np.testing.assert_array_equal(values[::1000], short.quantities[name])


def test_a_single_instant_is_the_start() -> None:
    start = quaternion.normalise([1.0, 2.0, 3.0, 4.0])
    motion = solve_deforming(two_hinged(), [0.0], 1e-12, angular_velocity=[1, 2, 3], attitude=start, position=[4, 5, 6])
    np.testing.assert_allclose(motion.attitude, [start], atol=1e-15)
    np.testing.assert_allclose(motion.angular_velocity, [[1, 2, 3]], atol=1e-14)
    assert motion.position is not None
    assert motion.position.tolist() == [[4, 5, 6]]


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"angular_velocity": None}, "angular_velocity or an angular_momentum: give one"),
        ({"angular_momentum": [0, 0, 1]}, "angular_velocity or an angular_momentum: give one"),
        ({"angular_velocity": [0, 0, float("nan")]}, "angular_velocity holds a value that is not finite"),
        ({"time": [0.0, 2.0, 1.0]}, "must ascend from 0"),
        ({"time": [-1.0, 2.0]}, "must ascend from 0"),
        ({"time": []}, "must ascend from 0"),
        ({"accuracy": 0.0}, "accuracy is 0.0 rad: it must be positive"),
        ({"attitude": [0, 0, 0, 0]}, "attitude is the zero quaternion"),
    ],
)
def test_an_argument_that_cannot_be_used_is_refused(change: dict[str, object], says: str) -> None:
    good = {"time": [0.0, 1.0], "accuracy": 1e-9, "angular_velocity": [0, 0, 1]}
    with pytest.raises(UsageError, match=says):
        solve_deforming(two_hinged(), **good | change)


def test_points_that_come_to_lie_on_a_line_are_refused_with_the_instant() -> None:
    knee = Joint(axis=Y, times=[0.0, 1.0], angles=[1.0, 0.0])
    points = [JointedPart("a", 1.0, np.zeros((3, 3)), [0, 0, k]) for k in (1,)]
    points.append(JointedPart("b", 1.0, np.zeros((3, 3)), [0, 0, 0], "a"))
    points.append(JointedPart("c", 1.0, np.zeros((3, 3)), [0, 0, -1], "a", (knee,)))
    with pytest.raises(GeometryError, match="at t = 1 s all parts lie on one line"):
        solve_deforming(JointedBody(points), [0.0, 1.0], 1e-9, angular_velocity=[0, 0, 1])


def test_a_run_of_too_many_turns_is_refused_before_it_starts() -> None:
    with pytest.raises(GeometryError, match=r"the parts turn through some .* rad, and the limit is 2e\+05 rad"):
        solve_deforming(two_hinged(), [0.0, 1e8], 1e-9, angular_velocity=[0, 0, 1])
