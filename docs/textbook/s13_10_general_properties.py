r"""
13.10 Equivalent ellipsoids, classes and equal moments
======================================================

About a point three moments and three directions are all that the motion of a body knows of its shape. Bodies that share
them are *inertially equivalent*; their common picture is the uniform ellipsoid of that mass and those moments, with
semi-axes :math:`a^2 = 5 (I_2 + I_3 - I_1)/(2M)` and so on. By the number of equal moments a body is a spherical top, a
symmetric one, prolate or oblate, an asymmetric one, or a rotor, with :math:`I_1 = 0`.
"""

import matplotlib.pyplot as plt
import numpy as np

import inertia

# %%
# **Five bodies**, one of each class, of particles, wires and plates. Axes of different moments are at right angles (eq.
# 13.54); among equal ones any pair will do, and ``equal`` says which they are, numbered from 0.

square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * 1.5
tetrahedron = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
bodies = {
    "rotor": inertia.wire([[0, 0, -1.7], [0, 0, 1.7]], 0.3),
    "prolate": inertia.point_masses(np.multiply(tetrahedron, [0.45, 0.45, 1.0]), [0.25] * 4),
    "spherical": inertia.point_masses(np.multiply(tetrahedron, 0.7), [0.25] * 4),
    "oblate": inertia.lamina(square, 0.1),
    "asymmetric": inertia.lamina(square * [1.2, 0.6, 1.0], 0.2),
}
for kind, body in bodies.items():
    principal = body.principal
    assert principal.kind == kind
    np.testing.assert_allclose(principal.axes.T @ principal.axes, np.eye(3), atol=1e-14)
    print(f"{kind:10} {principal.moments.round(2)} kg m², {principal.equal}")

# %%
# **The ellipsoid** of a body is that of any other with its moments. A tetrahedron of four particles at
# :math:`(\pm p, \pm q, \pm r)` has :math:`\int x^2\,dm = M p^2`; the solid ellipsoid has :math:`M a^2/5`: its semi-axes
# are :math:`\sqrt 5` times as long, and a solid box of the sides :math:`\sqrt{12}\,(p, q, r)` has it as well.

p, q, r = 0.5, 0.8, 1.2
cluster = inertia.point_masses(np.multiply(tetrahedron, [p, q, r]), [0.25] * 4)
np.testing.assert_allclose(cluster.equivalent_ellipsoid, np.sqrt(5) * np.array([r, q, p]), rtol=1e-12)
sides = np.sqrt(12) * np.array([p, q, r])
box = inertia.MassProperties(1.0, sides.prod(), [0, 0, 0], np.diag(np.sum(sides**2) - sides**2) / 12)
np.testing.assert_allclose(box.equivalent_ellipsoid, cluster.equivalent_ellipsoid, rtol=1e-12)

# %%
# **Equal moments, equal motion**: thrown alike, the four particles and the box tumble alike.

start, run = inertia.Start(angular_velocity=[0.3, 2.0, 0.5]), inertia.Settings(duration=10.0, samples=101)
first, second = (inertia.simulate(inertia.Scene(inertia.SceneBody.of(body), start, run)) for body in (cluster, box))
apart = inertia.quaternion.angle_between(first.attitude, second.attitude).max()
assert apart < 2e-10  # each is claimed to 1e-10 rad
print(f"after 10 s the two are {apart:.0e} rad apart")

# %%
# Look at the shapes, drawn by ``plot``: a line, a cigar, a ball, a flat disc and a flat oval. The
# numbers are the principal axes, the longest first: the smallest moment belongs to the longest semi-axis.
#
# **To try**: the tetrahedron with one mass of 0.3. Which class is it, and which with ``principal_within(0.5)``?

fig, axes = plt.subplots(1, 5, figsize=(6.4, 1.9))
for ax, (kind, body) in zip(axes, bodies.items(), strict=True):
    body.plot(ax=ax)
    ax.set_title(kind, fontsize=10)
    ax.set(xlim=(-2.2, 2.2), ylim=(-2.6, 2.6))
plt.show()
