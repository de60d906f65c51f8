"""The integrators by name: to add one, write a module with its step, and a line here."""

from __future__ import annotations

from inertia.dynamics.integrators.heyoka_taylor import Heyoka
from inertia.dynamics.integrators.loop import Integrator
from inertia.dynamics.integrators.runge_kutta import RungeKutta4
from inertia.dynamics.integrators.scipy_methods import ORDERS, SciPy
from inertia.dynamics.integrators.splitting import COMPOSITIONS, Splitting
from inertia.dynamics.integrators.taylor import Taylor

METHODS: dict[str, Integrator] = {
    method.name: method
    for method in (
        Taylor(),
        *(Splitting(order) for order in COMPOSITIONS),
        RungeKutta4(),
        *(SciPy(name) for name in ORDERS),
        Heyoka(),
    )
}
