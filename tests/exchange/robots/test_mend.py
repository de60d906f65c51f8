"""Mended links read back as they should be, and every other byte stays."""

import difflib
from pathlib import Path

import numpy as np
import pytest
from tests.exchange import solid
from tests.exchange.robots.test_mjcf import body
from tests.exchange.robots.test_sdf import MODEL
from tests.exchange.robots.test_urdf import ROBOT

import inertia
from inertia.exchange.robots.links import Inertial
from inertia.exchange.robots.mend import Mended, mend
from inertia.exchange.robots.read import read_robot

SHORT = (
    '<sdf version="1.9"><model name="m"><link name="a">{}</link></model><model name="n"><link name="a"/></model></sdf>'
)
FILES = {
    "arm.urdf": (ROBOT, "upper"),
    "arm.xml": (body('<inertial pos="0 0 0" mass="1" diaginertia="1 1 1" quat="1 1 0 0"></inertial>'), "a"),
    "arm.sdf": (MODEL, "base"),
    "upper.sdf": (MODEL, "upper"),
    "short.sdf": (SHORT.format("<inertial><pose/><mass>1</mass></inertial>"), "m::a"),
    "empty.sdf": (SHORT.format("<inertial><mass>1</mass><inertia/></inertial>"), "m::a"),
    "turned.sdf": (
        SHORT.format('<inertial><pose degrees="true">1 2 3 4 5 6</pose><mass>1<!-- kg --></mass></inertial>'),
        "m::a",
    ),
}


def stated(file: Path, link: str) -> Inertial:
    inertial = next(each for each in read_robot(file).links if each.name == link).inertial
    assert inertial is not None
    return inertial


@pytest.fixture
def right(tmp_path: Path) -> inertia.MassProperties:
    return solid.properties(tmp_path)


@pytest.mark.parametrize("name", FILES)
def test_what_is_mended_reads_back_to_the_bit(tmp_path: Path, right: inertia.MassProperties, name: str) -> None:
    text, link = FILES[name]
    file = tmp_path / name
    if name.endswith("urdf"):
        text = text.replace('filename="package://arm/meshes/upper.stl"', 'filename="upper.stl"')
    file.write_text(text)
    data, left = mend(read_robot(file), {link: Mended(right, "its mesh is link--1.stl -->")})
    assert left == {}
    file.write_bytes(data)
    there = stated(file, link)
    assert there.mass == right.mass
    assert there.placement.origin.tolist() == right.center_of_mass.tolist()
    assert np.array_equal(there.placement.rotation, np.eye(3))
    assert np.array_equal(there.inertia, right.inertia)
    assert b"<!-- mended: its mesh is link- -1.stl - -> -->" in data


def test_only_the_numbers_of_sdformat_change(tmp_path: Path, right: inertia.MassProperties) -> None:
    file = tmp_path / "arm.sdf"
    file.write_text(MODEL)
    mended = mend(read_robot(file), {"base": Mended(right, "because")})[0].decode()
    lines = list(difflib.ndiff(MODEL.splitlines(), mended.splitlines()))
    gone, new = ([line[2:].strip()[:6] for line in lines if line[:2] == mark] for mark in ("- ", "+ "))
    assert gone == ["<pose>", "<mass>", "<inert"]
    assert sorted(new) == sorted(["<!-- m", *gone])


def test_a_centre_that_agrees_stays_as_it_is_written(tmp_path: Path, right: inertia.MassProperties) -> None:
    file = tmp_path / "arm.sdf"
    file.write_text(SHORT.format("<inertial><pose>0.1  0.2 0.30 0 0 -0</pose><mass>1</mass></inertial>"))
    assert b"0.1  0.2 0.30 0 0 -0" in mend(read_robot(file), {"m::a": Mended(right, "x", center_agrees=True)})[0]
    assert b"0.1  0.2 0.30" not in mend(read_robot(file), {"m::a": Mended(right, "x")})[0]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('value="2.50"', 'value="2.50kg"'),
        ('rpy="0 0 1.5707963267948966"', 'rpy="0, 0, 0"'),
        ('ixx="0.010"', 'ixx="1f"'),
        ('rpy="0 0 1.5707963267948966"', 'quat_xyzw="0 0 1 1"'),
    ],
)
def test_slips_are_mended_too(tmp_path: Path, right: inertia.MassProperties, old: str, new: str) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(ROBOT.replace(old, new))
    fixed, _ = mend(read_robot(file), {"upper": Mended(right, "it slipped", center_agrees=True)})
    assert new.encode() not in fixed
    (tmp_path / "fixed.urdf").write_bytes(fixed)
    robot = read_robot(tmp_path / "fixed.urdf")
    assert robot.notes == ()
    stated = robot.links[1].inertial
    assert stated is not None
    assert stated.mass == right.mass
    assert np.array_equal(stated.inertia, right.inertia)


def test_what_cannot_be_written_into_is_refused(tmp_path: Path, right: inertia.MassProperties) -> None:
    file = tmp_path / "parts.csv"
    file.write_text(inertia.export(right, "csv", name="a"))
    with pytest.raises(inertia.UsageError, match="files of format csv are not written into"):
        mend(read_robot(file), {"a": Mended(right, "x")})


@pytest.mark.parametrize(
    ("head", "encoding", "line_end"),
    [
        ("", "utf-8", "\r\n"),
        ("\ufeff", "utf-8", "\n"),
        ('<?xml version="1.0" encoding="iso-8859-1"?>', "latin-1", "\n"),
    ],
)
def test_line_ends_marks_and_encodings_stay(
    tmp_path: Path, right: inertia.MassProperties, head: str, encoding: str, line_end: str
) -> None:
    file = tmp_path / "arm.urdf"
    text = head + (
        '<robot name="Füße">\n<link name="arm">\n  <inertial>\n    <mass value="1"/>\n  </inertial>\n</link>\n</robot>'
    )
    before = text.replace("\n", line_end).encode(encoding)
    file.write_bytes(before)
    after, _ = mend(read_robot(file), {"arm": Mended(right, "∫xy dm is −Ixy")})
    assert after.count(b"\r\n") == (after.count(b"\n") if line_end == "\r\n" else 0)
    opcodes = difflib.SequenceMatcher(None, before, after, autojunk=False).get_opcodes()
    assert all(kind in ("equal", "insert") or before[i:j] == b"1" for kind, i, j, _, _ in opcodes)
    file.write_bytes(after)
    assert stated(file, "arm").mass == right.mass


@pytest.mark.parametrize("encoding", ["gb2312", "shift_jis", "foo"])
def test_encodings_that_no_byte_can_be_found_in_are_refused(
    tmp_path: Path, right: inertia.MassProperties, encoding: str
) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(ROBOT.replace('version="1.0"', f'version="1.0" encoding="{encoding}"'))
    with pytest.raises(inertia.ReadError, match="encoding is not one of ASCII, UTF-8 and Latin-1: mend it by hand"):
        mend(read_robot(file), {"upper": Mended(right, "x")})
