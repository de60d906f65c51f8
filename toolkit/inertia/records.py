"""The `dataclass` of the standard library, but that the methods of a class are not compiled where it is defined.

The standard library writes up to five methods of each class as text and compiles them, a millisecond a class: a fifth
of the time that a small part takes, as dozens of classes are imported of which few are made. Here `__init__` is
compiled for the first instance, and the other methods are functions that serve all classes. The fields are those of the
standard library, which knows the classes as its own; those derived from others it makes whole.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

__all__ = ["dataclass"]

if TYPE_CHECKING:
    from dataclasses import dataclass
else:
    import dataclasses
    from collections.abc import Callable
    from operator import attrgetter
    from reprlib import recursive_repr

    def dataclass(cls: type | None = None, /, *, eq: bool = True, frozen: bool = False, kw_only: bool = False) -> Any:
        """Return the class as a data class, as `dataclasses.dataclass` does."""

        def made(cls: type) -> type:
            derived = any(map(dataclasses.is_dataclass, cls.__mro__[1:]))
            if derived or any("InitVar" in str(kind) for kind in getattr(cls, "__annotations__", {}).values()):
                return dataclasses.dataclass(eq=eq, frozen=frozen, kw_only=kw_only)(cls)
            dataclasses.dataclass(init=False, repr=False, eq=False, kw_only=kw_only)(cls)
            methods = {"__init__": _FirstInit(cls), "__repr__": _repr}
            if frozen:
                cls.__dataclass_params__.frozen = True
                methods |= _frozen(cls, frozenset(each.name for each in dataclasses.fields(cls)))
            if eq:
                methods |= _compared(tuple(each.name for each in dataclasses.fields(cls) if each.compare), frozen)
            for name, method in methods.items():
                if name not in vars(cls) or (name == "__hash__" and vars(cls)[name] is None):
                    setattr(cls, name, method)
            return cls

        return made if cls is None else made(cls)

    class _FirstInit:
        """Stands for the `__init__` of a class until it is asked for."""

        def __init__(self, cls: type) -> None:
            self._class = cls

        def __get__(self, instance: object | None, owner: type | None = None) -> Callable[..., None]:
            init = self._class.__init__ = _init_of(self._class)
            return init.__get__(instance, owner)

    class _MadeAnew:
        """Stands in a signature for what a default factory makes."""

        def __repr__(self) -> str:
            return "<factory>"

    _MADE_ANEW = _MadeAnew()

    def _init_of(cls: type) -> Callable[..., None]:
        """Compile the `__init__` of a class."""
        scope: dict[str, Any] = {"_put": object.__setattr__, "_anew": _MADE_ANEW}
        positional, named, body, types = ["self"], [], [], {"return": None}
        for each in dataclasses.fields(cls):
            parameter = value = name = each.name
            if each.default is not dataclasses.MISSING:
                scope[f"_default_{name}"], parameter = each.default, f"{name}=_default_{name}"
            elif each.default_factory is not dataclasses.MISSING:
                scope[f"_make_{name}"], parameter = each.default_factory, f"{name}=_anew"
                value = f"_make_{name}() if {name} is _anew else {name}" if each.init else f"_make_{name}()"
            if each.init:
                (named if each.kw_only else positional).append(parameter)
                types[name] = each.type
            if each.init or value != name:
                body.append(f"_put(self, {name!r}, {value})")
        if hasattr(cls, "__post_init__"):
            body.append("self.__post_init__()")
        parameters = ", ".join([*positional, *(["*", *named] if named else [])])
        exec(f"def __init__({parameters}):\n " + "\n ".join(body or ["pass"]), scope)
        init: Callable[..., None] = scope["__init__"]
        init.__qualname__, init.__module__ = f"{cls.__qualname__}.__init__", cls.__module__
        init.__annotations__ = types
        return init

    @recursive_repr()
    def _repr(self: Any) -> str:
        shown = (each.name for each in dataclasses.fields(self) if each.repr)
        return f"{type(self).__qualname__}({', '.join(f'{name}={getattr(self, name)!r}' for name in shown)})"

    def _frozen(cls: type, names: frozenset[str]) -> dict[str, Callable[..., None]]:
        def refuse(self: object, name: str, what: str) -> None:
            if type(self) is cls or name in names:
                raise dataclasses.FrozenInstanceError(f"cannot {what} field {name!r}")

        def __setattr__(self: object, name: str, value: object) -> None:
            refuse(self, name, "assign to")
            super(cls, self).__setattr__(name, value)

        def __delattr__(self: object, name: str) -> None:
            refuse(self, name, "delete")
            super(cls, self).__delattr__(name)

        return {"__setattr__": __setattr__, "__delattr__": __delattr__}

    def _compared(names: tuple[str, ...], frozen: bool) -> dict[str, Callable[..., Any] | None]:
        values = attrgetter(*names) if len(names) > 1 else lambda self: tuple(getattr(self, name) for name in names)

        def __eq__(self: object, other: object) -> bool:
            return values(self) == values(other) if other.__class__ is self.__class__ else NotImplemented

        def __hash__(self: object) -> int:
            return hash(values(self))

        return {"__eq__": __eq__, "__hash__": __hash__ if frozen else None}
