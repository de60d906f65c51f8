"""The models of motion, the smallest first: where a new one is added."""

from __future__ import annotations

from inertia.dynamics.models.deforming.model import DeformingBody
from inertia.dynamics.models.free.model import AsymmetricTop, SphericalTop, SteadyAxis, SymmetricTop
from inertia.dynamics.models.free.scaled import ScaledFreeMotion
from inertia.dynamics.models.heavy.model import HeavySymmetricTop
from inertia.dynamics.models.hinged.model import HingedBody
from inertia.dynamics.models.model import Model
from inertia.dynamics.models.rolling.model import Rolling
from inertia.dynamics.models.sliding.model import Sliding
from inertia.dynamics.models.stepped.model import EulerEquations

MODELS: tuple[Model, ...] = (
    SphericalTop(),
    SteadyAxis(),
    SymmetricTop(),
    AsymmetricTop(),
    ScaledFreeMotion(),
    HeavySymmetricTop(),
    EulerEquations(),
    HingedBody(),
    Rolling(),
    Sliding(),
    DeformingBody(),
)
"""Of those that can follow a scene, the first that is accurate enough runs, and the last takes ``run.method``."""
