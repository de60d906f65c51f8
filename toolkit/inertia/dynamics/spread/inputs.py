"""Numbers of a scene that are drawn or swept: by which law, and their values for every draw."""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float
from inertia.documents import FieldError
from inertia.dynamics.scene.document import Scene
from inertia.dynamics.spread.fields import value_at
from inertia.errors import UsageError
from inertia.estimate import Estimate
from inertia.records import dataclass

MOST = 100_000_000
"""Runs of an ensemble, at most."""

Law = str | float | Sequence[float] | Float
"""How a number varies: ``1±0.01``, ``±1%``, ``0.9..1.1``, ``0:1:11``, ``1,2,5``; an `Estimate`; numbers to sweep."""


@dataclass(frozen=True, eq=False)
class Input:
    """A number of a scene that varies.

    Attributes
    ----------
    path : of its field, as errors name it: ``load[0].acceleration[2]``
    law : "normal" (mean and standard deviation), "uniform" (from, to) or "sweep" (every value)
    figures : the two numbers of the law, or the values (k,) of a sweep
    """

    path: str
    law: str
    figures: Float

    @property
    def swept(self) -> bool:
        """Whether every one of its values is run."""
        return self.law == "sweep"

    @property
    def described(self) -> str:
        """The law in words."""
        a, b = self.figures[[0, -1]].tolist()
        if self.law == "normal":
            return f"{a:.9g} ± {b:.6g}, normal with this standard deviation"
        if self.law == "uniform":
            return f"{a:.9g} … {b:.9g}, uniform"
        return f"{len(self.figures)} values, {a:.9g} … {b:.9g}"

    def middle(self, stated: float) -> float:
        """Return the value that stands for no deviation: of a sweep, what the scene states."""
        if self.swept:
            return stated
        a, b = map(float, self.figures)
        return a if self.law == "normal" else 0.5 * (a + b)

    def drawn(self, count: int, seed: int) -> Float:
        """Return draws (count,), the first of which are those of any larger count.

        Each input has its own stream of random numbers, by the seed and its path, so that neither the order of the
        inputs, nor another one, nor the number of processes changes a draw.
        """
        random = np.random.default_rng([seed, zlib.crc32(self.path.encode())])
        a, b = map(float, self.figures)
        return a + b * random.standard_normal(count) if self.law == "normal" else a + (b - a) * random.random(count)


def inputs_of(scene: Scene, vary: Mapping[str, Law]) -> tuple[Input, ...]:
    """Read how the numbers of a scene vary; raise `FieldError` where there is no such number, or no such law.

    ``±`` without a number before it is about what the scene states, and of a vector about each component; a share of a
    component that is zero is none.
    """
    if not vary:
        raise UsageError("nothing varies: name a number of the scene, as body.mass, and how it varies, as 1±0.01")
    inputs: list[Input] = []
    for path, law in vary.items():
        stated = value_at(scene, path)
        text = law.strip() if isinstance(law, str) else law
        if np.ndim(stated) and not (isinstance(text, str) and text.startswith("±")):
            first = "[0]" * np.ndim(stated)
            raise FieldError(path, f"has {np.size(stated)} numbers: name one of them, as {path}{first}")
        each = {f"{path}{''.join(f'[{k}]' for k in at)}": float(x) for at, x in np.ndenumerate(stated)}
        if isinstance(text, str) and text.startswith("±") and text.endswith("%"):
            if not any(each.values()):
                raise FieldError(path, "is 0 in the scene, of which a share is 0 too: give ± in its own unit")
            each = {name: value for name, value in each.items() if value}
        inputs += [_input(name, text, value) for name, value in each.items()]
    twice = [each.path for k, each in enumerate(inputs) if each.path in {other.path for other in inputs[:k]}]
    if twice:
        raise FieldError(twice[0], "varies twice: say it once")
    return tuple(inputs)


def _input(path: str, law: Law, stated: float) -> Input:
    if isinstance(law, str):
        return _parsed(path, law, stated)
    if isinstance(law, Estimate):
        return _checked(path, "normal", [float(law), law.uncertainty])
    return _checked(path, "sweep", np.atleast_1d(law))


def _parsed(path: str, text: str, stated: float) -> Input:
    try:
        if ".." in text:
            return _checked(path, "uniform", [float(end) for end in text.split("..")])
        if text.count(":") == 2:
            first, last, count = text.split(":")
            return _checked(path, "sweep", _evenly(path, float(first), float(last), int(count)))
        if "±" in text or "+-" in text or "+/-" in text:
            estimate = Estimate.parse(f"{stated!r}{text}" if text.startswith("±") else text)
            return _checked(path, "normal", [float(estimate), estimate.uncertainty])
        return _checked(path, "sweep", [float(one) for one in text.split(",")])
    except FieldError:
        raise
    except ValueError:
        raise FieldError(
            path,
            f"varies by {text!r}, which is no law: write 1±0.01 or ±1% (normal, standard deviation), 0.9..1.1 "
            "(uniform), 0:1:11 or 1,2,5 (a sweep)",
        ) from None


def _evenly(path: str, first: float, last: float, count: int) -> Float:
    if not 1 <= count <= MOST:
        raise FieldError(path, f"is swept in {count} values: give 1 or more, as 0:1:11")
    return np.linspace(first, last, count)


def _checked(path: str, law: str, figures: ArrayLike) -> Input:
    values = np.asarray(figures, dtype=np.float64)
    if values.ndim != 1 or not values.size or not np.isfinite(values).all():
        raise FieldError(path, "varies by what is not a row of finite numbers: correct it")
    if law != "sweep" and values.size != 2:
        raise FieldError(path, f"varies between {values.size} numbers: give two, as 0.9..1.1")
    if law == "uniform" and not values[0] < values[1]:
        raise FieldError(path, f"varies from {values[0]:g} to {values[1]:g}: give the smaller one first")
    if law == "normal" and not values[1] > 0:
        raise FieldError(path, "varies by ±0, which is not at all: give a standard deviation above zero")
    return Input(path, law, values)


def values_of(inputs: Sequence[Input], draws: int | None, seed: int) -> Float:
    """Return the values (N, k) of all inputs: every point of the grid of sweeps, with all draws at each of them.

    The draws are the same at every point, so that points can be compared.

    >>> inputs_grid = [Input("a", "sweep", np.array([1.0, 2.0])), Input("b", "sweep", np.array([5.0, 6.0]))]
    >>> values_of(inputs_grid, None, 0).tolist()
    [[1.0, 5.0], [1.0, 6.0], [2.0, 5.0], [2.0, 6.0]]
    """
    swept = [k for k, each in enumerate(inputs) if each.swept]
    if len(swept) == len(inputs):
        if draws is not None:
            raise UsageError("every input is swept, and nothing is left to draw: leave out the number of draws")
        count = 1
    else:
        count = 1000 if draws is None else draws
        if not 1 <= count <= MOST:
            raise UsageError(f"the number of draws is {count}: give 1 … {MOST}")
    points = math.prod(len(inputs[k].figures) for k in swept)
    if points * count > MOST:
        raise UsageError(
            f"{points} points of the sweeps with {count} draws each make more than {MOST} runs: ask for fewer"
        )
    grid = np.array(list(product(*(inputs[k].figures.tolist() for k in swept)))).reshape(points, len(swept))
    values = np.empty((points, count, len(inputs)))
    values[:, :, swept] = grid[:, None]
    for k, each in enumerate(inputs):
        if not each.swept:
            values[:, :, k] = each.drawn(count, seed)
    return values.reshape(-1, len(inputs))
