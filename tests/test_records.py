"""Data classes behave as those of the standard library, whenever their methods are first asked for."""

import copy
import dataclasses
import inspect
import pickle
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import InitVar, field
from functools import cached_property
from threading import Barrier
from typing import Any, ClassVar

import pytest

from inertia import records

Made = Callable[..., Any]


def _frozen(dataclass: Made) -> type:
    @dataclass(frozen=True)
    class Frozen:
        """A class."""

        kind: ClassVar[str] = "kind"
        a: int
        b: list[int] = field(default_factory=list)
        c: float = field(default=0.5, repr=False, compare=False)
        d: str = field(default="d", kw_only=True)

        @cached_property
        def twice(self) -> int:
            return 2 * self.a

    return Frozen


def _derived(dataclass: Made) -> type:
    @dataclass(frozen=True, eq=False)
    class Base:
        """A class."""

        a: int
        b: int = 2

    @dataclass(frozen=True, eq=False)
    class Derived(Base):
        """A class."""

        b: int = 3
        c: int = 4

    return Derived


def _variable(dataclass: Made) -> type:
    @dataclass
    class Variable:
        """A class."""

        a: int
        given: InitVar[int] = field(default=7, kw_only=True)
        later: int = field(init=False)
        own: dict[str, int] = field(init=False, default_factory=dict)

        def __post_init__(self, given: int) -> None:
            self.later = self.a + given

    return Variable


def _by_name(dataclass: Made) -> type:
    @dataclass(frozen=True, kw_only=True)
    class ByName:
        """A class."""

        a: int = 1
        b: Any

    return ByName


def _with_own(dataclass: Made) -> type:
    @dataclass(frozen=True)
    class WithOwn:
        """A class."""

        a: int

        def __repr__(self) -> str:
            return "own"

        def __eq__(self, other: object) -> bool:
            return isinstance(other, type(self)) and self.a % 2 == other.a % 2

        def __hash__(self) -> int:
            return self.a % 2

    return WithOwn


def _mixed(dataclass: Made) -> type:
    @dataclass(frozen=True)
    class Base:
        """A class."""

        a: int

    @dataclasses.dataclass(frozen=True)
    class Mixed(Base):
        """One of the standard library, as users derive them."""

        b: int = 2

    return Mixed


CASES: list[tuple[Callable[[Made], type], tuple[Any, ...], dict[str, Any]]] = [
    (_frozen, (1,), {}),
    (_frozen, (1, [2], 3.0), {"d": "e"}),
    (_frozen, (), {"a": 5, "c": float("nan")}),
    (_frozen, (), {}),
    (_frozen, (1, [2], 3.0, "e"), {}),
    (_derived, (1,), {}),
    (_derived, (1, 2, 5), {}),
    (_derived, (1, 2, 3, 4), {}),
    (_variable, (1,), {}),
    (_variable, (1,), {"given": 2}),
    (_variable, (1,), {"later": 2}),
    (_by_name, (), {"b": None}),
    (_by_name, (), {}),
    (_by_name, (1,), {"b": None}),
    (_with_own, (3,), {}),
    (_mixed, (1,), {}),
    (_mixed, (1, 3), {}),
]


def _outcome(act: Callable[[], Any]) -> Any:
    """Return what comes out, or of which kind the error is and what it says."""
    try:
        return act()
    except Exception as error:
        return type(error), str(error)


@pytest.mark.parametrize(("cls", "arguments", "named"), CASES)
def test_they_do_what_those_of_the_standard_library_do(
    cls: Callable[[Made], type], arguments: tuple[Any, ...], named: dict[str, Any]
) -> None:
    def seen(dataclass: Made) -> list[Any]:
        kind = cls(dataclass)
        made = _outcome(lambda: kind(*arguments, **named))
        if not isinstance(made, kind):
            return [made]
        other = kind(*arguments, **named)
        return [
            repr(made),
            made == other,
            made == 1,
            _outcome(lambda: hash(made) == hash(other)),
            _outcome(lambda: {made, made, other} == {made}),
            dataclasses.asdict(made),
            repr(_outcome(lambda: dataclasses.replace(made, a=8))),
            _outcome(lambda: setattr(made, "a", 9)),
            _outcome(lambda: setattr(made, "new", 9)),
            _outcome(lambda: delattr(made, "a")),
            _outcome(lambda: delattr(made, "none")),
            repr(copy.copy(other)),
            kind.__match_args__,  # type: ignore[attr-defined]
            str(inspect.signature(kind)),
            getattr(made, "twice", None),
        ]

    assert repr(seen(records.dataclass)) == repr(seen(dataclasses.dataclass))


@records.dataclass(frozen=True)
class Sent:
    """A class that is sent."""

    a: int
    b: str = "b"


def test_one_that_is_read_before_any_is_made_has_its_methods() -> None:
    content = pickle.dumps(Sent(1))
    code = (
        "import pickle, sys\n"
        f"from {__name__} import Sent\n"
        f"one, other = pickle.loads({content!r}), pickle.loads({content!r})\n"
        "assert one == other and hash(one) == hash(other) and repr(one) == \"Sent(a=1, b='b')\"\n"
        "try:\n    one.a = 2\nexcept AttributeError:\n    sys.exit(7)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 7


def test_one_that_holds_itself_is_shown() -> None:
    made = _frozen(records.dataclass)(1)
    made.b.append(made)
    assert repr(made).endswith("Frozen(a=1, b=[...], d='d')")


def test_threads_may_make_the_first_ones_at_once() -> None:
    for _ in range(50):
        kind, start = _frozen(records.dataclass), Barrier(8)

        def make(number: int, kind: type = kind, start: Barrier = start) -> Any:
            start.wait()
            return kind(number).a

        with ThreadPoolExecutor(8) as threads:
            assert list(threads.map(make, range(8))) == list(range(8))
