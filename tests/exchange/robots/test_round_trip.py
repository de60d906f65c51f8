"""What is written for a program is read again as it was, with our own readers too."""

from pathlib import Path

import numpy as np
import pytest
from tests.exchange import solid

import inertia
from inertia.exchange.robots.read import read_robot

EXACT = {"urdf": "arm.urdf", "sdf": "arm.sdf", "csv": "arm.csv"}  # the others have principal moments and a quaternion


@pytest.mark.parametrize(("target", "name"), [*EXACT.items(), ("mjcf", "arm.xml")])
def test_bodies_come_back(tmp_path: Path, target: str, name: str) -> None:
    body = solid.properties(tmp_path)
    bodies = {"upper arm": body, 'a "b" & <c>': body.with_mass(0.3), "=1+1": body, "world": body.with_mass(7.0)}
    file = tmp_path / name
    file.write_text(inertia.export(bodies, target))
    links = [link for link in read_robot(file).links if link.inertial is not None]
    assert [link.name.removesuffix("_") for link in links] == list(bodies)
    for link, right in zip(links, bodies.values(), strict=True):
        assert link.inertial is not None
        where = link.inertial.placement
        there = where.rotation @ link.inertial.inertia @ where.rotation.T
        assert link.inertial.mass == right.mass
        assert where.origin.tolist() == right.center_of_mass.tolist()
        assert np.allclose(there, right.inertia, rtol=0, atol=4e-16 * np.linalg.norm(right.inertia))
        assert target not in EXACT or np.array_equal(there, right.inertia)
