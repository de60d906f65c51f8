"""Scenes at the edge of sense: one clear sentence, with its field, and advice that helps when it is followed."""

import re
from pathlib import Path
from typing import Any

import pytest

from inertia.dynamics.scene.document import Scene
from inertia.dynamics.simulate import simulate
from inertia.errors import GeometryError, InertiaError, ReadError, UsageError

BODY = {"principal_moments": [1.0, 2.0, 3.0], "mass": 1.0}
GRAVITY = {"kind": "gravity", "acceleration": [0.0, -9.8, 0.0]}
DAMPING = {"kind": "damping", "coefficient": 0.1}
HINGE = {"kind": "hinge", "axis": [0, 0, 1]}
ROLLING = {"kind": "rolling", "radius": 0.5}


def scene(*loads: object, spin: object = (0.0, 0.1, 1.0), duration: float = 10.0, **more: Any) -> Scene:
    table: dict[str, Any] = {
        "body": BODY,
        "start": {"angular_velocity": list(spin)},  # type: ignore[call-overload]
        "load": list(loads),
        "run": {"duration": duration, "samples": 11, "accuracy": more.pop("accuracy", 1e-9)},
    }
    return Scene.from_dict({**table, **more})


@pytest.mark.parametrize(
    ("made", "says"),
    [
        (scene(DAMPING, duration=1e12), "rad are too many to step through: ask for a shorter run"),
        (scene(DAMPING, spin=[0, 1e58, 1e59]), "rad are too many to step through: ask for a shorter run"),
        (scene(spin=[0, 0, 1], duration=1e30, constraint={**HINGE, "stiffness": 2.0}), "the attitude is lost over"),
        (scene(DAMPING, spin=[0, 0, 1e59], constraint=HINGE), r"the attitude is lost over 10 s \(closed form"),
        (
            scene(DAMPING, GRAVITY, spin=[0, 0, 1e30], constraint={**HINGE, "point": [0.1, 0, 0]}),
            "the scene: the run would take some",
        ),
    ],
)
def test_attitudes_that_are_lost_are_said_to_be(made: Scene, says: str) -> None:
    with pytest.raises(GeometryError, match=says) as caught:
        simulate(made)
    assert str(caught.value).startswith("the scene: ")
    assert "ask for that" not in str(caught.value)


def test_spins_far_below_what_the_loads_do_are_followed() -> None:
    slow = scene(DAMPING, spin=[1e-60, 2e-60, 1e-59])
    assert simulate(slow).error.reached < 1e-12


@pytest.mark.parametrize("constraint", [ROLLING, {**ROLLING, "axis": [0, 0, 1]}])
def test_asymmetric_body_that_rolls_is_refused_in_one_sentence(constraint: dict[str, Any]) -> None:
    says = "takes a body of revolution about .* off by 0.71 of its smallest moment, .*: give it two equal moments$"
    gravity = {"kind": "gravity"}
    with pytest.raises(UsageError, match=says):
        simulate(scene(gravity, constraint=constraint))


def test_advice_on_nearly_symmetric_bodies_that_roll_helps() -> None:
    table: dict[str, Any] = {
        "body": {"principal_moments": [1.0, 1.00001, 1.5], "mass": 1.0},
        "start": {"angular_velocity": [0.0, 0.5, 3.0], "attitude": [0.6, 0, 0, 0.8]},
        "constraint": ROLLING,
        "load": [{"kind": "gravity"}],
        "run": {"duration": 1.0, "samples": 11, "accuracy": 1e-7},
    }
    with pytest.raises(UsageError, match=r"ask for .* rad or more") as caught:
        simulate(Scene.from_dict(table))
    advice = re.search(r"ask for (\S+) rad or more", str(caught.value))
    assert advice
    table["run"]["accuracy"] = float(advice[1])
    assert simulate(Scene.from_dict(table)).error.reached < float(advice[1])


@pytest.mark.parametrize(
    ("load", "says"),
    [
        ({"kind": "gravity_gradient", "mu": 1.0, "position": [0, 0, 0]}, r"load\[1\].position is zero"),
        ({"kind": "torque", "torque": lambda *_: [1.0, 2.0]}, r"load\[1\].torque: the function returned \[1.0, 2.0\]"),
        ({"kind": "torque", "torque": lambda *_: "none"}, r"load\[1\].torque: the function returned 'none'"),
        ({"kind": "torque", "table": [[0, 1, 2, 3], [1, 1, 2, 3]]}, r"load\[1\].table covers 0 … 1 s"),
        ({"kind": "torque", "table": "absent.csv"}, r"load\[1\].table: absent.csv: the torque table cannot be read"),
    ],
)
def test_errors_of_a_load_name_the_scene_and_the_field(load: dict[str, Any], says: str) -> None:
    with pytest.raises(InertiaError, match=f"^the scene: {says}"):
        simulate(scene(DAMPING, load))


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        ("0,1,2,3\n1,2,x,3\n", "table.csv, line 2: 'x' is not a finite number"),
        ("1,1,2,3\n1,2,3,3\n", "table.csv: the torque table holds one instant"),
        ("", "table.csv: the torque table has 0 rows"),
    ],
)
def test_errors_in_a_table_name_the_scene_the_field_and_the_file(rows: str, says: str, tmp_path: Path) -> None:
    (tmp_path / "table.csv").write_text(rows)
    text = "[body]\nprincipal_moments = [1, 2, 3]\n[start]\nangular_velocity = [0, 0, 1]\n[run]\nduration = 1\n"
    (tmp_path / "scene.toml").write_text(f'{text}[[load]]\nkind = "torque"\ntable = "table.csv"\n')
    with pytest.raises(ReadError, match=rf"scene\.toml: load\[0\]\.table: .*{says}"):
        Scene.load(tmp_path / "scene.toml")
