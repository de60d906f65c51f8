"""Assemblies as rotors: against all ways in fractions, moved parts, and the same rotor without a tree."""

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest

from inertia.assembly.document import Assembly
from inertia.balancing import arrangement_program
from inertia.balancing.assembled import AssembledRotor
from inertia.balancing.balance import balance
from inertia.balancing.mounting import joint_terms
from inertia.balancing.rotor import Rotor
from inertia.balancing.unbalance import Unbalance
from inertia.errors import InertiaError
from inertia_meshes import path

SHAFT = {"name": "shaft", "shape": "cylinder", "size": [6, 120], "material": "steel"}
WHEEL = {"name": "wheel", "shape": "tube", "size": [40, 6, 12], "material": "aluminium", "at": [0, 0, 20]}
ROTOR = {
    "axis": {"bearing_a": [0, 0, -50], "bearing_b": [0, 0, 50]},
    "service": {"rpm": 3000},
    "tolerance": {"grade": 6.3},
}

COPIES = {"name": "lug", "parent": "wheel", "shape": "point", "mass": 0.1, "around": {"count": 2, "axis": "z"}}


def rotor(*parts, **sections):
    return Rotor.from_dict({"part": [SHAFT, *parts], "rotor": ROTOR | sections})


def mounted(*parts, **mount):
    return rotor(*parts, mount=[mount])


def lug(name, parent, mass=0.002, **fields):
    return {"name": name, "parent": parent, "shape": "point", "mass": mass, "at": [50, 0, 0]} | fields


def test_the_best_of_sixteen_positions_of_the_pump_rotor_in_fractions():
    result = balance(Rotor.load(path("rotors/pump_rotor.toml")))
    parts = [  # kg, centre of mass in mm
        (Fraction("0.2090"), (Fraction("0.008"), Fraction("-0.006"), 60)),
        (Fraction("0.1470"), (Fraction("0.021"), Fraction("0.028"), 76)),
        (Fraction("0.0830"), (Fraction("-0.016"), Fraction("0.012"), 115)),
    ]
    turns = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    limits = [Fraction(limit) for limit in result.tolerance.permissible]

    def squares(*positions):
        planes = [[Fraction(0)] * 2, [Fraction(0)] * 2]
        for (mass, (x, y, z)), (c, s) in zip(parts, positions, strict=True):
            share = Fraction(z - 10, 95)
            for plane, part in zip(planes, (1 - share, share), strict=True):
                plane[0] += mass * part * (c * x - s * y) / 1000
                plane[1] += mass * part * (s * x + c * y) / 1000
        return [sum(k * k for k in plane) / limit**2 for plane, limit in zip(planes, limits, strict=True)]

    ways = {(i, j): max(squares(turns[0], turns[i], turns[j])) for i in range(4) for j in range(4)}
    best = min(ways, key=ways.get)
    assert result.indexing.names == ("impeller", "coupling")
    assert result.indexing.turns == pytest.approx([math.radians(90 * k) for k in best])
    assert result.indexing.left == result.indexing.bound == pytest.approx(math.sqrt(ways[best]), rel=1e-9)
    assert result.indexing.as_filed == pytest.approx(math.sqrt(ways[0, 0]), rel=1e-9)
    assert result.indexing.ways == 16
    worst = [
        max(
            abs(k) / limit
            for k, limit in zip(each.in_planes(*result.tolerance_planes), result.tolerance.permissible, strict=True)
        )
        for each in (result.initial,)
    ]
    assert worst[0] == pytest.approx(result.indexing.left, rel=1e-9)
    assert result.verdict.outcome == "pass"
    assert result.correction.operations


def test_the_best_order_of_nine_blades_of_all():
    result = balance(Rotor.load(path("assemblies/weighed_fan.toml")))
    weights = 1e-5 * np.array([3142, 3187, 3096, 3155, 3208, 3113, 3170, 3088, 3161])
    lean = math.radians(35)
    static, couple = 65e-3, 1e-6j * (24**2 - 2**2) / 12 * math.sin(lean) * math.cos(lean)
    planes = np.array([static / 2 - couple / 0.1, static / 2 + couple / 0.1])
    places = np.exp(1j * np.radians(40 * np.arange(9)))
    # Turned by a slot, all blades leave as much: the first one stays.
    orders = np.array([(0, *order) for order in itertools.permutations(range(1, 9))], np.int8)
    sums = np.abs(weights[orders] @ places) * np.abs(planes).max() / result.tolerance.permissible[0]
    assert result.indexing.left == result.indexing.bound == pytest.approx(sums.min(), rel=1e-9)
    assert result.indexing.as_filed == pytest.approx(sums[0], rel=1e-9)
    assert result.indexing.ways == 362_880
    taken = [int(other.removeprefix("blade ")) - 1 for _, other in result.indexing.moves]
    assert sorted(taken) == list(range(9))
    assert taken[:2] == [0, 1]  # of orders that leave as much, the first
    placed = abs(weights @ places[taken]) * np.abs(planes).max() / result.tolerance.permissible[0]
    assert placed == pytest.approx(sums.min(), rel=1e-9)
    assert abs(result.initial.in_planes(-0.05, 0.05)[0]) == pytest.approx(
        result.indexing.left * result.tolerance.permissible[0], rel=1e-9
    )
    # 95 % of the inputs, k = 2: nine masses, each known to 0.01 g
    known = 2 * math.sqrt(9) * 1e-5 * abs(planes[0])
    assert result.verdict.planes[0].bounds["input"] == pytest.approx(known, rel=1e-6)


def test_blades_are_put_in_order_on_a_wheel_that_is_turned_as_well():
    slots = [{"name": f"slot {k}", "parent": "wheel", "euler": [120 * k], "sequence": "z"} for k in range(3)]
    weights = [0.0021, 0.0024, 0.0018]
    blades = [lug(f"blade {k}", f"slot {k}", weights[k]) for k in range(3)]
    off = {"name": "off", "shape": "point", "mass": 0.0004, "at": [30, 12, 20]}
    mounts = [{"part": "blade *", "interchangeable": True}, {"part": "wheel", "indexing": {"count": 5, "offset": 7}}]
    result = balance(rotor(WHEEL, off, *slots, *blades, mount=mounts))
    ways = [
        abs(
            0.0004 * complex(0.03, 0.012)
            + 0.05 * sum(weights[p] * np.exp(1j * math.radians(7 + 72 * k + 120 * s)) for s, p in enumerate(order))
        )
        for k in range(5)
        for order in itertools.permutations(range(3))
    ]
    assert abs(result.initial.static) == pytest.approx(min(ways), rel=1e-9)
    assert result.indexing.ways == len(ways)
    assert result.indexing.bound == result.indexing.left


@pytest.mark.parametrize("z", [None, 5.0])
def test_what_a_joint_does_is_what_a_moved_part_does(z):
    on = lug("lug", "wheel", 0.05, at=[0, 0, 8])
    mount = {"part": "wheel", "eccentricity": 0.01, "tilt": 0.1} | ({} if z is None else {"z": z})
    whole = mounted(WHEEL, on, **mount)
    at = (-0.05, 0.05)
    placed = AssembledRotor(whole, whole.assembly)
    terms = {term.name: term for term in joint_terms(placed.joints(), whole.shaft, at)}
    off, lean = terms["wheel: eccentricity"], terms["wheel: tilt"]
    assert (off.distribution, off.spread, lean.spread) == (
        "disc",
        pytest.approx(1e-5),
        pytest.approx(math.radians(0.1)),
    )
    carried = Assembly.from_dict({"part": [WHEEL, on]}).mass_properties()
    pivot = 1e3 * carried.center_of_mass[2] if z is None else z

    def vectors(**fields):
        tree = Assembly.from_dict({"part": [SHAFT, WHEEL | fields, on]})
        return Unbalance.of(tree.mass_properties(), whole.shaft).in_many_planes(at)

    start = vectors()
    assert vectors(at=[0.01, 0, 20]) - start == pytest.approx(off.sensitivities * 1e-5, rel=1e-6)
    angle = 1e-3  # degrees, about y: towards x
    arm = 20 - pivot
    turned = vectors(
        at=[arm * math.sin(math.radians(angle)), 0, pivot + arm * math.cos(math.radians(angle))],
        euler=[angle],
        sequence="y",
    )
    assert turned - start == pytest.approx(lean.sensitivities * math.radians(angle), rel=1e-4)


def test_a_rayleigh_radius_is_drawn_as_one():
    off = {"separate": 0.01, "distribution": "rayleigh"}
    result = balance(mounted(WHEEL, part="wheel", eccentricity=off))
    mass = Assembly.from_dict({"part": [WHEEL]}).mass_properties().mass
    in_planes = mass * np.array([0.3, 0.7]) * 1e-5 * math.sqrt(2 * math.log(20))
    assert result.scatter.residual_95 == pytest.approx(in_planes, rel=0.03)
    assert result.scatter.sensitivities[0].name == "wheel: eccentricity"


def test_copies_are_mounted_each_by_itself():
    whole = mounted(WHEEL, lug("screw", "wheel", around={"count": 4, "axis": "z"}), part="screw", eccentricity=0.1)
    joints = AssembledRotor(whole, whole.assembly).joints()
    assert [joint.name for joint in joints] == ["screw 1", "screw 2", "screw 3", "screw 4"]
    assert [joint.properties.mass for joint in joints] == pytest.approx([0.002] * 4)
    assert joints[1].properties.center_of_mass == pytest.approx([0, 0.05, 0.02], abs=1e-12)


def test_one_file_in_an_assembly_is_drilled_as_it_is_by_itself():
    fields = Rotor.load(path("rotors/two_disc_rotor.toml")).to_dict()
    del fields["body"][0]["chord_tolerance"]
    plain = balance(Rotor.from_dict(fields, path("rotors/two_disc_rotor.toml").parent))
    body = fields.pop("body")[0]
    part = {"name": "rotor", "file": body["file"], "material": body["material"]}
    table = {"part": [part], "rotor": fields}
    tree = balance(Rotor.from_dict(table, path("rotors/two_disc_rotor.toml").parent))
    assert tree.initial.in_planes(*tree.tolerance_planes) == pytest.approx(
        plain.initial.in_planes(*plain.tolerance_planes), rel=1e-9
    )
    works = [[(k.id, k.angle, k.depth) for k in each.correction.operations] for each in (tree, plain)]
    assert works[0] == [(name, pytest.approx(angle, abs=1e-9), pytest.approx(depth)) for name, angle, depth in works[1]]
    assert abs(tree.residual.static - plain.residual.static) < 1e-9 * abs(plain.initial.static)
    assert (tree.verdict.outcome, tree.properties.mass) == (plain.verdict.outcome, pytest.approx(plain.properties.mass))


@pytest.mark.parametrize(
    ("parts", "mount", "says"),
    [
        ([WHEEL], {"part": "whel", "tilt": 0.1}, "no part of the assembly has that name, of shaft, wheel"),
        ([WHEEL], {"part": "wheel"}, "mount[0] says nothing"),
        ([WHEEL], {"part": "wheel", "interchangeable": True}, "only wheel fits: nothing to exchange"),
        ([WHEEL], {"part": "wheel", "z": 3, "eccentricity": 0.1}, "mount[0].z is given without tilt"),
        ([WHEEL, lug("a", "wheel")], {"part": "*", "interchangeable": True}, "a group does not change places"),
        ([WHEEL, COPIES], {"part": "lug", "indexing": {"count": 3}}, "list what is turned part by part"),
        ([WHEEL], {"part": "wheel", "indexing": {"count": 3}, "interchangeable": True}, "turn what they are"),
        ([WHEEL | {"at": [4, 0, 20]}], {"part": "wheel", "tilt": 0.1}, "overlap at"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_said_in_one_sentence(parts, mount, says):
    with pytest.raises(InertiaError) as caught:
        balance(mounted(*parts, **mount))
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_parts_that_are_turned_otherwise_do_not_change_places():
    parts = [WHEEL, lug("lug 1", "wheel"), {**lug("lug 2", "shaft"), "at": [0, 0, 70]}]
    mounts = [{"part": "lug *", "interchangeable": True}, {"part": "wheel", "indexing": {"count": 2}}]
    with pytest.raises(InertiaError, match="has lug 2 change places with a part that is turned otherwise"):
        balance(rotor(*parts, mount=mounts))


def test_a_part_is_put_together_once():
    mounts = [{"part": "wheel", "indexing": {"count": 2}}, {"part": "wh*", "indexing": [0, 10]}]
    with pytest.raises(InertiaError, match="mount has wheel turned or exchanged twice: name it once"):
        balance(rotor(WHEEL, mount=mounts))


def test_fifteen_weighed_blades_have_a_bound(monkeypatch):
    monkeypatch.setattr(arrangement_program, "NODES", 20)
    slots = [{"name": f"slot {k}", "parent": "wheel", "euler": [24 * k], "sequence": "z"} for k in range(15)]
    weights = 0.002 * (1 + 0.03 * np.random.default_rng(2).normal(size=15))
    blades = [lug(f"blade {k}", f"slot {k}", float(weights[k])) for k in range(15)]
    indexing = balance(rotor(WHEEL, *slots, *blades, mount=[{"part": "blade *", "interchangeable": True}])).indexing
    assert indexing.ways == math.factorial(15)
    assert 0 <= indexing.bound <= indexing.left < 0.01 < indexing.as_filed
    assert indexing.proven or "a gap of" in indexing.sentence


@pytest.mark.parametrize(
    ("table", "says"),
    [
        (
            {"part": [WHEEL]},
            "rotor is missing: give its axis, service and tolerance there, or name this file as the assembly",
        ),
        ({"part": [WHEEL], "rotor": ROTOR | {"service": {"rpm": -1}}}, "rotor.service.rpm is -1"),
        (ROTOR | {"body": [{"file": "a.stl"}], "assembly": "a.toml"}, "assembly is given beside body"),
        (ROTOR | {"body": [{"file": "a.stl"}], "mount": [{"part": "a", "tilt": 1}]}, "mount[0] is that of an assembly"),
        (ROTOR, "body is missing"),
    ],
)
def test_a_file_is_of_bodies_or_of_an_assembly(table, says):
    with pytest.raises(InertiaError) as caught:
        Rotor.from_dict(table)
    assert says in str(caught.value)


def test_the_file_written_of_an_assembly_with_a_rotor_says_the_same():
    whole = Rotor.load(path("assemblies/weighed_fan.toml"))
    again = Rotor.loads(whole.to_toml(), whole.folder)
    assert again.fields.assembly == "weighed_fan.toml"
    assert again.to_dict() == whole.to_dict()
    assert whole.planned_in(3.0).assembly is whole.assembly
    assert again.assembly.mass_properties().mass == whole.assembly.mass_properties().mass
