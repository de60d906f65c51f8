"""The verb: which kind of thing it is asked about, and its arguments."""

from typing import Any

import pytest
from tests.mesh.solids import cube, part

import inertia
from inertia.errors import UsageError
from inertia.work_precision.trade import Trade, trade
from inertia_meshes import path

SCENE = {
    "body": {"principal_moments": (1.0, 2.0, 3.0)},
    "start": {"angular_velocity": (1.0, 2.0, 3.0)},
    "run": {"duration": 0.1, "samples": 2},
}


def test_one_verb_for_parts_and_scenes() -> None:
    scene = inertia.Scene.from_dict(SCENE)
    for subject in (part(cube()), scene):
        cost = inertia.trade(subject, 1e-6, repeats=1, budget=30.0)
        assert isinstance(cost, Trade)
        assert (cost.accuracy, cost.repeats, cost.budget) == (1e-6, 1, 30.0)


@pytest.mark.parametrize("weight", [{"density": 5.0}, {"material": "steel"}])
def test_a_scene_takes_no_density(weight: dict[str, Any]) -> None:
    with pytest.raises(UsageError, match="a scene says itself what its body is"):
        trade(inertia.Scene.from_dict(SCENE), **weight)


def test_a_path_is_told_how_to_read_it() -> None:
    with pytest.raises(UsageError, match=r"give what inertia\.read\(path\) returns"):
        trade(str(path("cube.stl")))  # type: ignore[call-overload]


def test_the_verb_keeps_its_name_beside_the_folder_of_the_same_name() -> None:
    import inertia.work_precision.render

    assert inertia.trade is trade
