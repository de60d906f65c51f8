"""A cat, a diver and a skater of plain numbers: bodies whose shape is prescribed in time."""

from math import pi

import numpy as np

from inertia.dynamics.models.deforming.jointed_body import JointedBody
from inertia.dynamics.models.deforming.joints import Joint, JointedPart


def ellipsoid(mass: float, a: float, b: float, c: float) -> np.ndarray:
    """Return the tensor of a uniform ellipsoid of semi-axes a, b, c along x, y, z."""
    return mass / 5 * np.diag([b * b + c * c, c * c + a * a, a * a + b * b])


def cylinder(mass: float, radius: float, length: float) -> np.ndarray:
    """Return the tensor of a uniform cylinder along z."""
    across = mass * (3 * radius**2 + length**2) / 12
    return np.diag([across, across, mass * radius**2 / 2])


CAT_HALF, CAT_RADIUS, CAT_LENGTH = 1.6, 0.06, 0.22  # kg, m, m


def overturning_bend() -> float:
    """Return the bend, rad, at which one turn of both halves turns the cat over, by half a turn.

    With A and B the axial and transverse moments of a half and c, s the cosine and sine of half the bend, the plane of
    the bend turns by A c / (A c² + B s²) of a turn, which is one half for (A − B) c² − 2 A c + B = 0.
    """
    across, _, along = np.diag(cylinder(CAT_HALF, CAT_RADIUS, CAT_LENGTH))
    gap = along - across
    return 2 * float(np.arccos((along - np.sqrt(along**2 - gap * across)) / gap))


def cat(bend: float | None = None) -> JointedBody:
    """Return two equal halves along z that meet at the origin: bend, turn about their own axes, and straighten.

    The halves turn alike as seen from the plane of the bend, so that the spine is not twisted. Root: the rear.
    """
    bend = overturning_bend() if bend is None else bend
    times = [0.0, 0.1, 0.3, 0.4]
    back = Joint(axis=[0, 0, 1], times=times[1:3], angles=[0.0, -2 * pi])
    bent = Joint(axis=[0, 1, 0], times=times, angles=[0.0, bend, bend, 0.0])
    forth = Joint(axis=[0, 0, 1], times=times[1:3], angles=[0.0, 2 * pi])
    half = cylinder(CAT_HALF, CAT_RADIUS, CAT_LENGTH)
    return JointedBody(
        (
            JointedPart("rear", CAT_HALF, half, [0, 0, -CAT_LENGTH / 2]),
            JointedPart("front", CAT_HALF, half, [0, 0, CAT_LENGTH / 2], "rear", (back, bent, forth)),
        )
    )


def diver(start: float = 0.3, stop: float = 1.24162) -> JointedBody:
    """Return a diver along z, facing x, the arms overhead: one arm comes down the side at `start`, and up at `stop`.

    To be thrown with 6 rad/s about y, the axis of the somersault: the arm tilts the body, and the body twists. Going up
    when it does, after three twists, the arm takes the tilt out again.
    """
    times = [start, start + 0.25, stop, stop + 0.25]
    left = Joint(axis=[1, 0, 0], point=[0, 0.2, 0.45], times=times, angles=[0, -pi, -pi, 0])
    right = Joint(axis=[1, 0, 0], point=[0, -0.2, 0.45], times=[0.0], angles=[0.0])
    arm = ellipsoid(3.6, 0.04, 0.04, 0.36)
    return JointedBody(
        (
            JointedPart("trunk", 35.0, ellipsoid(35.0, 0.12, 0.17, 0.35), [0, 0, 0.2]),
            JointedPart("head", 5.0, ellipsoid(5.0, 0.1, 0.08, 0.13), [0, 0, 0.68], "trunk"),
            JointedPart("legs", 24.0, ellipsoid(24.0, 0.1, 0.14, 0.5), [0, 0, -0.6], "trunk"),
            JointedPart("left arm", 3.6, arm, [0, 0.2, 0.8], "trunk", (left,)),
            JointedPart("right arm", 3.6, arm, [0, -0.2, 0.8], "trunk", (right,)),
        )
    )


SKATER_TRUNK, SKATER_ARM = 52.0, 4.0  # kg
SKATER_OUT, SKATER_IN = 0.7, 0.2  # m, of the arms from the axis


def skater() -> JointedBody:
    """Return a skater along z with two point masses for arms, pulled in between 1 s and 2 s and let out from 3 s on."""
    times, pulled = [1.0, 2.0, 3.0, 5.0], SKATER_IN - SKATER_OUT
    arms = [
        JointedPart(
            name,
            SKATER_ARM,
            np.zeros((3, 3)),
            [side * SKATER_OUT, 0, 1.3],
            "trunk",
            (Joint(axis=[side, 0, 0], times=times, displacements=[0, pulled, pulled, 0]),),
        )
        for name, side in (("left arm", 1), ("right arm", -1))
    ]
    return JointedBody((JointedPart("trunk", SKATER_TRUNK, cylinder(SKATER_TRUNK, 0.15, 1.7), [0, 0, 0.85]), *arms))
