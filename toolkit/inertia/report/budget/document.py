"""`Assembly` → the document ``inertia/assembly/1``; `Budget` → ``inertia/budget/1``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from inertia.assembly.budget import Budget
from inertia.assembly.document import Assembly
from inertia.assembly.interference import Interference
from inertia.assembly.limits import COVERAGE, Limit
from inertia.assembly.lines import Line, Sigma

_SHOWN = 50  # contributors
COLUMNS = (
    "mass",
    *(f"center_of_mass.{k}" for k in "xyz"),
    *(f"inertia.{k}" for k in ("xx", "yy", "zz", "xy", "xz", "yz")),
    "predicted_mass",
)
"""The figures whose variances are shared out among the inputs."""


def assembly_document(assembly: Assembly, pairs: Sequence[Interference] | None = None) -> dict[str, Any]:
    """Return the assembly as ``inertia/assembly/1``; numbers are SI; with the interferences that were looked for."""
    properties, whole = assembly.mass_properties(), assembly.budget()
    error, principal = properties.error, properties.principal
    document: dict[str, Any] = {
        "schema": "inertia/assembly/1",
        "name": assembly.name,
        "mass": properties.mass,
        "volume": properties.volume,
        "center_of_mass": properties.center_of_mass.tolist(),
        "inertia": properties.inertia.tolist(),
        "principal_moments": principal.moments.tolist(),
        "principal_axes": principal.axes.tolist(),
        "error": {
            "method": error.method,
            "volume": error.volume,
            "mass": error.mass,
            "center_of_mass": error.center_of_mass,
            "inertia": _finite(error.inertia),
        },
        "parts": [_part(line) for line in whole.total.children],
        "notes": list(assembly.notes),
    }
    if pairs is not None:
        document["interferences"] = [
            {
                "parts": [each.first, each.second],
                "volume": each.volume,
                "mass": each.mass,
                "place": each.place.tolist(),
                "gap": each.gap if not each.volume else None,
            }
            for each in pairs
        ]
        document["unexamined"] = [{"part": name, "why": why} for name, why in assembly.unexamined().items()]
    return document


def budget_document(whole: Budget) -> dict[str, Any]:
    """Return the budget as ``inertia/budget/1``; numbers are SI, uncertainties standard ones."""
    total = whole.total
    return {
        "schema": "inertia/budget/1",
        "name": whole.assembly.name,
        "verdict": whole.verdict,
        "total": {
            "mass": whole.properties.mass,
            "basic_mass": whole.properties.mass,
            "allowance": total.allowance,
            "predicted_mass": total.predicted_mass,
            "center_of_mass": whole.properties.center_of_mass.tolist(),
            "inertia": whole.properties.inertia.tolist(),
            "principal_moments": whole.properties.principal_moments.tolist(),
            "bound": {
                "mass": whole.properties.error.mass,
                "center_of_mass": whole.properties.error.center_of_mass,
                "inertia": _finite(whole.properties.error.inertia),
            },
            "sigma": spread_document(total.sigma),
            "coverage_95": COVERAGE,
            "contributors": contributors(total.sigma),
        },
        "limits": [limit_document(limit) for limit in whole.limits],
        "parts": [_part(line) for line in total.children],
        "notes": list(whole.notes),
    }


def contributors(sigma: Sigma, most: int = _SHOWN) -> list[dict[str, Any]]:
    """Return the inputs by the largest part of any variance that is theirs, and those parts."""
    shares = sigma.shares()
    order = sorted(range(len(shares)), key=lambda k: (-shares[k].max(), sigma.labels[k]))[:most]
    return [
        {"input": sigma.labels[k], "share": dict(zip(COLUMNS, shares[k].tolist(), strict=True))}
        for k in order
        if shares[k].any()
    ]


def _part(line: Line) -> dict[str, Any]:
    part: dict[str, Any] = {
        "name": line.name,
        "quantity": line.quantity,
        "basic_mass": line.basic_mass,
        "allowance": line.allowance,
        "predicted_mass": line.predicted_mass,
        "center_of_mass": line.center_of_mass.tolist(),
        "inertia": line.inertia.tolist(),
        "sigma": spread_document(line.sigma),
    }
    if line.maturity is not None:
        part["maturity"] = line.maturity
    if line.category is not None:
        part["category"] = line.category
    if line.children:
        part["parts"] = [_part(child) for child in line.children]
    return part


def spread_document(sigma: Sigma) -> dict[str, Any]:
    """Return standard uncertainties."""
    return {
        "mass": sigma.mass,
        "predicted_mass": sigma.predicted_mass,
        "center_of_mass": sigma.center_of_mass.tolist(),
        "inertia": sigma.inertia.tolist(),
    }


def _finite(value: float) -> float | None:
    """Return a number; None of an infinite one, as the relative bound of a tensor that is zero."""
    return value if math.isfinite(value) else None


def limit_document(limit: Limit) -> dict[str, Any]:
    """Return a limit with what became of it."""
    return {
        "what": limit.what,
        "value": limit.value,
        "sigma": limit.uncertainty,
        "limit": [limit.low, limit.high],
        "margin": _finite(limit.margin),
        "verdict": limit.verdict,
    }
