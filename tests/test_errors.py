"""Errors as data: their places, words and remedies, and how these are worded."""

import copy
import pickle

import pytest

from inertia.documents import FieldError
from inertia.errors import FORCE, REPAIR, SHELL, FieldPath, GeometryError, InertiaError, Sentence, UsageError, placed

OPEN = GeometryError("open: use ", SHELL, " or ", REPAIR)
ERRORS = [
    OPEN,
    placed(OPEN, "rotor.toml", FieldPath("body[0]")),
    FieldError("run.accuracy", "is below that of ", FieldPath("run.method")),
    placed(FieldError("run.accuracy", "is 0"), "scene.toml"),
    UsageError("a.csv exists: ", FORCE),
]


@pytest.mark.parametrize("error", ERRORS, ids=str)
@pytest.mark.parametrize("again", [lambda error: pickle.loads(pickle.dumps(error)), copy.copy, copy.deepcopy])
def test_an_error_survives_the_way_to_another_process(error: InertiaError, again) -> None:
    other = again(error)
    assert type(other) is type(error)
    assert (str(other), other.places, other.remedies) == (str(error), error.places, error.remedies)
    assert other.sentence.words == error.sentence.words


def test_the_places_come_first_and_the_outermost_of_them() -> None:
    error = placed(placed(OPEN, FieldPath("body[0]")), "rotor.toml")
    assert str(error) == f"rotor.toml: body[0]: {OPEN}"
    assert error.remedies == (SHELL, REPAIR)
    assert isinstance(error, GeometryError)


def test_a_field_that_is_placed_stays_a_usage_error_of_its_path() -> None:
    error = placed(FieldError("start.position", "is 1"), "scene.toml")
    assert str(error) == "scene.toml: start.position is 1"
    assert isinstance(error, UsageError)
    assert FieldPath("start.position") in error.words


def test_a_sentence_within_a_sentence_keeps_its_remedies() -> None:
    inner = Sentence("use ", SHELL)
    outer = Sentence("open: ", inner, ".")
    assert outer == "open: use shell=THICKNESS."
    assert outer.worded(lambda remedy: "a shell") == "open: use a shell."
    assert copy.deepcopy(outer).remedies == (SHELL,)
