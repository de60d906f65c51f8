"""The angle of an axle whose damping is stiff, by Radau collocation: on each step θ̇ is a polynomial.

    W_i = ω + h Σ_j a_ij θ̈(Θ_j, W_j),    Θ_i = θ + h Σ_j a_ij W_j

at the Radau nodes, of order 2s − 1, and stiffly accurate: once what damping kills has died away, steps are as long as
what is left allows, whatever c/I is. Hairer & Wanner, *Solving Ordinary Differential Equations II* (1996), § IV.5.
"""

from __future__ import annotations

import functools

import numpy as np
from numpy.polynomial.legendre import legder, legint, legroots, legval, legvander

from inertia.arrays import Float
from inertia.dynamics.computing_time import Watch
from inertia.dynamics.models.hinged.axle import Axle

NODES = 24
_MIDDLE = 1e-9  # of θ̇, that the middle coefficients of its polynomial may be: the last ones are as its square then
_ITERATIONS = 12
_SETTLED = 1e-11  # of θ̇, that a correction may amount to: Newton's next one is as its square
_LONGER, _SHORTER = 5.0, 0.1  # times a step, that the next one is at most, and at least
_SAFETY = 0.9


@functools.cache
def _rule() -> tuple[Float, Float]:
    """Return the weights a (s, s), and what takes values at the nodes to coefficients (s, s) of Legendre's polynomials
    on −1 … 1."""
    series = np.zeros(NODES + 1)
    series[-2:] = 1.0, -1.0  # which vanishes at Radau's nodes, the last of them 1
    x = legroots(series).real
    x = np.append((x - legval(x, series) / legval(x, legder(series)))[:-1], 1.0)
    coefficients = np.linalg.inv(legvander(x, NODES - 1))
    weights = legvander(x, NODES) @ legint(0.5 * coefficients, lbnd=-1)
    return np.asarray(weights, dtype=np.float64), np.asarray(coefficients, dtype=np.float64)


def collocated(axle: Axle, time: Float, level: float, noise: float = 0.0) -> tuple[Float, Float]:
    """Return θ and θ̇ at the instants (n,) s, ascending from 0 on; every step may be off by `noise`, relative.

    Steps are `level` times as long as the polynomial of θ̇ allows.
    """
    weights, coefficients = _rule()
    angle, rate = np.empty_like(time), np.empty_like(time)
    at, end, here, spin, largest = 0.0, float(time[-1]), 0.0, axle.spin, abs(axle.spin)
    step = min(end, axle.inertia / axle.damping)
    first, watch = int(np.searchsorted(time, 0.0, side="right")), Watch()
    angle[:first], rate[:first] = here, spin
    allowed = _MIDDLE * level ** (NODES // 2)
    while first < len(time):
        watch.require(at / end)
        step = min(step, end - at)
        rates = _settled(axle, here, spin, step, largest)
        if rates is None:
            step *= _SHORTER
            continue
        series = coefficients @ rates
        size = max(largest, float(np.abs(rates).max()))
        middle = float(np.abs(series[NODES // 2 : NODES // 2 + 2]).max())
        share = max(middle / size, step * middle / max(1.0, abs(here))) if size else 0.0
        longer = _SAFETY * (allowed / share) ** (2.0 / NODES) if share else _LONGER
        if share > allowed:
            step *= min(max(longer, _SHORTER), _SAFETY)
            continue
        following = end if step == end - at else at + step
        last = int(np.searchsorted(time, following, side="right"))
        x = 2.0 * (time[first:last] - at) / step - 1.0
        angle[first:last], rate[first:last] = here + step * legval(x, legint(0.5 * series, lbnd=-1)), legval(x, series)
        here, spin = here + step * float(weights[-1] @ rates), float(rates[-1])
        here, spin = here + noise * abs(here), spin + noise * abs(spin)
        at, first, largest = following, last, size
        step *= min(longer, _LONGER)
    return angle, rate


def _settled(axle: Axle, angle: float, spin: float, step: float, largest: float) -> Float | None:
    """Return θ̇ (s,) at the nodes of a step, by Newton's method; None where it does not settle.

    `largest` is the largest θ̇ so far, which corrections are measured by.
    """
    weights, _ = _rule()
    rates, eye = np.full(NODES, spin), np.eye(NODES)
    for _ in range(_ITERATIONS):
        angles = angle + step * (weights @ rates)
        slope = axle.stiffness + axle.cosine * np.sin(angles) - axle.sine * np.cos(angles)
        inner = (axle.damping * eye + slope[:, None] * step * weights) / axle.inertia
        lacking = spin + step * (weights @ axle.acceleration(angles, rates)) - rates
        correction = np.linalg.solve(eye + step * (weights @ inner), lacking)
        rates = rates + correction
        size = max(largest, float(np.abs(rates).max()))
        moved = float(np.abs(correction).max())
        if not np.isfinite(moved):
            return None
        if moved <= _SETTLED * size and step * moved <= _SETTLED * max(1.0, abs(angle)):
            return rates
    return None
