"""`Analysis` → the document ``inertia/analysis/1``."""

from __future__ import annotations

import math
from dataclasses import asdict
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.errors import Sentence, Wording
from inertia.mass.analysis import Analysis
from inertia.mass.integrand import matrix_of
from inertia.mass.integration import TrueShape
from inertia.mass.principal import Principal

if TYPE_CHECKING:
    from inertia.mass.repair import Repaired  # what it mends with is slow to import, and seldom needed
    from inertia.mass.uncertainty import StandardUncertainty


def analysis_document(
    analysis: Analysis, repaired: Repaired | None = None, *, wording: Wording = str
) -> dict[str, Any]:
    """Return the analysis as ``inertia/analysis/1``; numbers are SI but for the points given in the part's unit."""
    part, properties, principal = analysis.part, analysis.properties, analysis.principal
    mesh: dict[str, Any] = {"triangles": analysis.triangles, "closed": analysis.closed, "bodies": analysis.bodies}
    mesh["crossings_examined"] = analysis.crossings_examined
    if analysis.cells:
        mesh["cells"] = analysis.cells
    if analysis.allowed_faults is not None:
        mesh["allowed_faults"] = analysis.allowed_faults
    if (union := analysis.union) is not None:
        cubic = part.unit.metres**3
        mesh["union"] = {
            "crossings": union.crossings,
            "counted_more_than_once": float(Fraction(union.more_than_once) * cubic),
            "counted_negative": float(Fraction(union.negative) * cubic),
        }
    if analysis.shape is not None:
        mesh["shape"] = _shape(analysis.shape, part.unit.metres, "area" if analysis.model == "shell" else "volume")
    document: dict[str, Any] = {
        "schema": "inertia/analysis/1",
        "source": part.source.to_dict(),
        "unit": part.unit.name,
        "unit_from": part.unit_from,
        "density": analysis.density,
        "density_from": analysis.density_from,
        "model": analysis.model,
        "mesh": mesh,
        "extents": analysis.extents.tolist(),
        "volume": properties.volume,
        "area": analysis.area,
        "mass": properties.mass,
        "center_of_mass": properties.center_of_mass.tolist(),
        "inertia": properties.inertia.tolist(),
        "principal_moments": principal.moments.tolist(),
        "principal_axes": principal.axes.tolist(),
        "equal_moments": [list(group) for group in principal.equal],
        "class": principal.kind,
        "class_tolerance": principal.tolerance,
        "radii_of_gyration": properties.radii_of_gyration.tolist(),
        "equivalent_ellipsoid": properties.equivalent_ellipsoid.tolist(),
        "error": {
            "method": properties.error.method,
            "volume": properties.error.volume,
            "mass": properties.error.mass,
            "center_of_mass": properties.error.center_of_mass,
            "inertia": properties.error.inertia,
            "principal_moments": [k if math.isfinite(k) else None for k in relative_bounds(principal)],
            "principal_axes": principal.axis_bounds.tolist(),
        },
    }
    if analysis.accuracy is not None:
        pair, bound = properties.center_of_mass_pair()
        document["center_of_mass_low"] = pair[1].tolist()
        document["error"]["center_of_mass_pair"] = bound
    if analysis.tessellation is not None:
        document["error"]["tessellation"] = asdict(analysis.tessellation)
    if analysis.repair is not None:
        bounds = asdict(analysis.repair)
        document["error"]["repair"] = {k: None if v == math.inf else v for k, v in bounds.items()}
    if analysis.uncertainty is not None:
        document["uncertainty"] = _uncertainty(analysis.uncertainty)
    if analysis.about is not None:
        (point, tensor), relative = analysis.about, analysis.about_bound
        document["inertia_about"] = {
            "point": list(point),
            "inertia": tensor.tolist(),
            "error": None if relative is None or math.isinf(relative) else relative,
        }
        if (u := analysis.about_uncertainty) is not None:
            document["inertia_about"]["uncertainty"] = u.tolist()
    if analysis.shares:
        document["shares"] = [
            {
                "name": share.name,
                "density": share.density,
                "volume": share.volume,
                "mass": share.mass,
                "center_of_mass": list(share.center_of_mass),
            }
            for share in analysis.shares
        ]
    if repaired is not None:
        document["repair"] = {
            "changes": [
                {
                    "what": change.what,
                    "count": change.count,
                    "where": change.where,
                    "largest_move": float(Fraction(change.largest_move) * part.unit.metres),
                }
                for change in repaired.changes
            ],
            "volume_before": repaired.volume_before,
            "volume_after": repaired.volume_after,
            "center_of_mass_shift": repaired.center_of_mass_shift,
            "inertia_change": repaired.inertia_change,
            **({"volume_between": list(repaired.volume_between)} if repaired.volume_between else {}),
        }
    if analysis.doubts:
        document["doubts"] = [
            {
                "code": finding.code,
                "message": Sentence(finding.message).worded(wording),
                "count": finding.count,
                "volume": finding.doubt.volume * float(part.unit.metres) ** 3,
                "place": None if finding.place is None else list(finding.place),
            }
            for finding in analysis.doubts
            if finding.doubt is not None
        ]
    document["notes"] = list(analysis.notes)
    return document


def _uncertainty(uncertainty: StandardUncertainty) -> dict[str, Any]:
    """Return standard uncertainties, what each input contributes, the covariance, and expanded uncertainties."""

    def eleven(u: Float) -> dict[str, Any]:
        return {
            "volume": float(u[0]),
            "mass": float(u[1]),
            "center_of_mass": u[2:5].tolist(),
            "inertia": matrix_of(u[5:]).tolist(),
        }

    def all_of(k: float) -> dict[str, Any]:
        angles = (k * uncertainty.principal_axes).tolist()
        return {
            **eleven(k * uncertainty.of()),
            "principal_moments": (k * uncertainty.principal_moments).tolist(),
            "principal_axes": [angle if math.isfinite(angle) else None for angle in angles],
        }

    return {
        "inputs": dict(uncertainty.inputs),
        **all_of(1.0),
        "undetermined": [list(group) for group in uncertainty.principal.equal],
        "components": {name: eleven(uncertainty.of(name)) for name in uncertainty.components},
        "covariance": uncertainty.covariance.tolist(),
        **({} if uncertainty.bias is None else {"inertia_bias": uncertainty.bias.tolist()}),
        **({} if uncertainty.coverage is None else {"coverage": uncertainty.coverage}),
        **({} if uncertainty.coverage is None else {"expanded": all_of(uncertainty.coverage)}),
        "remarks": list(uncertainty.remarks),
    }


def _shape(shape: TrueShape, metres: Fraction, measure: str) -> dict[str, Any]:
    """Return the solids of a shape, where they are placed."""
    return {
        "faces": shape.faces,
        "gap": float(Fraction(shape.gap) * metres),
        "solids": [
            {
                "name": solid.name,
                "path": list(solid.path),
                "colour": None if solid.colour is None else list(solid.colour),
                "rotation": solid.placement[:, :3].tolist(),
                "translation": [float(Fraction(k) * metres) for k in solid.placement[:, 3].tolist()],
                measure: float(moments.zeroth * metres ** (3 if measure == "volume" else 2)),
                "centroid": [float(k * metres) for k in moments.centroid],
            }
            for solid, moments in shape.solids
        ],
    }


def relative_bounds(principal: Principal) -> list[float]:
    """Return the bounds on the moments relative to them; infinite for a moment of zero."""
    pairs = zip(principal.moment_bounds.tolist(), np.abs(principal.moments).tolist(), strict=True)
    return [bound / moment if moment else math.inf if bound else 0.0 for bound, moment in pairs]
