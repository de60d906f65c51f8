"""Densities: who said so, what is taken where nobody did, and what contradicts itself."""

import math

import numpy as np
import pytest

from inertia.errors import UsageError
from inertia.mass.density import ASSUMED, DENSITIES, Densities, densities, density_of


@pytest.mark.parametrize(
    ("arguments", "default", "named", "source"),
    [
        ({}, ASSUMED, {}, "assumed"),
        ({"density": {}}, ASSUMED, {}, "assumed"),
        ({"density": 2700}, 2700.0, {}, "option"),
        ({"density": {"": 5.0}}, 5.0, {}, "option"),
        ({"density": {"a": 5.0}}, None, {"a": 5.0}, "option"),
        ({"density": {"a": 5.0, "": 7}}, 7.0, {"a": 5.0}, "option"),
        ({"material": "steel"}, 7850.0, {}, "material"),
        ({"material": {"a": "steel", "": "gold"}}, 19300.0, {"a": 7850.0}, "material"),
        ({"density": 1.0, "material": {"a": "steel"}}, 1.0, {"a": 7850.0}, "option"),
        ({"mass": 3.0}, ASSUMED, {}, "mass"),
        ({"mass": 3.0, "density": {"a": 2.0, "b": 1.0}}, None, {"a": 2.0, "b": 1.0}, "mass"),
    ],
)
def test_what_was_said_is_what_is_taken(
    arguments: dict, default: float | None, named: dict[str, float], source: str
) -> None:
    table = densities(**arguments)
    assert (table.default, dict(table.named), table.source) == (default, named, source)
    assert table.mass == arguments.get("mass")


def test_nobody_said_means_water() -> None:
    assert densities().of("anything") == density_of("water") == 1000.0


@pytest.mark.parametrize(
    "bad",
    [0, -1.0, math.nan, math.inf, -math.inf, 10**400, -(10**400), "heavy", None, [1], 1j],
    ids=lambda bad: str(bad)[:9],
)
def test_a_density_or_mass_is_a_positive_finite_number(bad: object) -> None:
    for arguments in ({"density": {"a": bad}}, {"density": bad}, {"mass": bad}):
        if None in arguments.values():
            continue  # nothing said
        with pytest.raises(UsageError, match=r"^(density|density of 'a'|mass) is .*kg") as e:
            densities(**arguments)
        assert e.value.exit_code == 2


def test_bodies_go_by_their_numbers_or_by_these_as_text() -> None:
    by_number = densities({1: 5.0, np.int64(2): 7.0}, {3: "steel", "": "ice"})
    assert by_number == densities({"1": 5.0, "2": 7.0}, {"3": "steel", "": "ice"})
    with pytest.raises(UsageError, match="the density of body 1 is given twice, by its number and as text"):
        densities({1: 5.0, "1": 6.0})
    for key in (1.5, True, None, ("a",)):
        with pytest.raises(UsageError, match=r"the material of .* is given: name a region by its text, a body by its"):
            densities(material={key: "steel"})


def test_a_number_is_kept_as_a_number() -> None:
    assert densities(density="2.5").default == 2.5
    assert densities(mass="2.5").mass == 2.5


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ({"density": 1.0, "material": "steel"}, "both a density and a material are given: give one"),
        (
            {"density": {"a": 1.0}, "material": {"a": "steel"}},
            "both a density and a material are given for 'a': give one",
        ),
        ({"density": 1.0, "mass": 2.0}, "both a mass and a density are given"),
        ({"material": "steel", "mass": 2.0}, "both a mass and a density are given"),
        ({"density": {"": 2.0}, "mass": 2.0}, "both a mass and a density are given"),
        ({"material": {"a": "unobtainium"}}, "unknown material 'unobtainium'"),
    ],
)
def test_a_contradiction_is_refused(arguments: dict, match: str) -> None:
    with pytest.raises(UsageError, match=match):
        densities(**arguments)


@pytest.mark.parametrize("rest", [{"density": {"a": 5.0, "": 9.0}}, {"density": {"a": 5.0}, "material": {"": "ice"}}])
def test_densities_are_proportions_of_a_mass_where_one_is_for_the_rest(rest: dict) -> None:
    table = densities(**rest, mass=2.0)
    assert (table.source, table.mass, table.of("a"), table.of("b")) == ("mass", 2.0, 5.0, densities(**rest).of("b"))


def test_a_name_takes_its_own_density_or_the_rest() -> None:
    table = Densities(7.0, {"a": 5.0}, "option")
    assert (table.of("a"), table.of("b")) == (5.0, 7.0)


def test_a_name_without_density_is_refused() -> None:
    with pytest.raises(UsageError, match="no density is given for 'b': give it one, or one without a name") as e:
        densities({"a": 5.0}).of("b")
    assert e.value.exit_code == 2


# Materials, against handbook densities of pure substances and the ranges of the rest (kg/m³)

PURE = {
    "aluminium": 2700, "copper": 8960, "gold": 19300, "ice": 917, "lead": 11340, "magnesium": 1740, "nickel": 8900,
    "silicon": 2330, "silver": 10490, "tungsten": 19300, "water": 1000, "zinc": 7140,
}  # fmt: skip
RANGES = {
    "abs": (1030, 1070), "acetal": (1400, 1430), "alumina": (3700, 3990), "brass": (8400, 8750),
    "bronze": (7400, 8900), "carbon-fibre": (1500, 1700), "cast-iron": (6800, 7400), "concrete": (2200, 2500),
    "glass": (2400, 2800), "nylon": (1120, 1170), "oak": (600, 900), "peek": (1260, 1320), "petg": (1230, 1290),
    "pine": (350, 700), "pla": (1210, 1250), "polycarbonate": (1190, 1220), "polyethylene": (910, 970),
    "ptfe": (2100, 2300), "stainless": (7480, 8030), "steel": (7750, 8050), "titanium": (4400, 4540),
}  # fmt: skip


def test_every_density_is_that_of_the_handbooks() -> None:
    assert set(DENSITIES) == set(PURE) | set(RANGES)
    for name, value in PURE.items():
        assert density_of(name) == pytest.approx(value, rel=0.005)
    for name, (low, high) in RANGES.items():
        assert low <= density_of(name) <= high


@pytest.mark.parametrize(
    ("name", "material"),
    [
        ("Steel", "steel"),
        ("  STEEL ", "steel"),
        ("aluminum", "aluminium"),
        ("carbon fiber", "carbon-fibre"),
        ("Carbon_Fibre", "carbon-fibre"),
        ("stainless steel", "stainless"),
        ("iron", "cast-iron"),
        ("POM", "acetal"),
    ],
)
def test_a_material_goes_by_several_names(name: str, material: str) -> None:
    assert density_of(name) == DENSITIES[material]


def test_an_unknown_material_brings_the_nearest_names_and_the_whole_list() -> None:
    with pytest.raises(UsageError, match="unknown material 'steal' \\(did you mean steel") as e:
        density_of("steal")
    assert e.value.exit_code == 2
    assert all(name in str(e.value) for name in DENSITIES)
    with pytest.raises(UsageError, match="unknown material 'xyzzy': use one of abs, "):
        density_of("xyzzy")
    with pytest.raises(UsageError, match=r"unknown material 7850: .* or give a density"):
        density_of(7850)  # type: ignore[arg-type]
