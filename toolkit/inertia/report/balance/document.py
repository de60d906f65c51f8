"""`ReportData` → the document ``inertia/balance/1``, and CSV for a spreadsheet.

Unbalances are {"gmm", "deg"}: g·mm, and degrees of the heavy spot as `inertia.balancing.unbalance` has them. Lengths
are in mm, forces in N, masses in kg, of operations in g.
"""

from __future__ import annotations

import math
from typing import Any

from inertia.balancing.axis.location import Candidate
from inertia.balancing.shop_units import GRAM_MILLIMETRE, GRAM_SQUARE_MILLIMETRE, in_degrees, in_gmm
from inertia.documents import plain
from inertia.report.balance.data import MM, BodyRow, OperationRow, ReportData, State
from inertia.report.numerals import converted
from inertia.tables import csv_text

Document = dict[str, Any]

_PLANES = ("state", "plane", "z_mm", "unbalance_gmm", "unbalance_deg", "permissible_gmm", "bearing_force_N")
_OPERATIONS = (
    "step", "id", "plane", "method", "kind", "z_mm", "angle_deg", "machine_angle_deg", "radius_mm", "tool_diameter_mm",
    "point_angle_deg", "depth_mm", "width_mm", "arc_deg", "from_deg", "to_deg", "machine_from_deg", "machine_to_deg",
    "arc_mm", "passes", "mass_g", "unbalance_gmm", "unbalance_deg", "remaining_wall_mm", "pieces", "item",
)  # fmt: skip


def balance_document(data: ReportData) -> Document:
    """Return the balance as ``inertia/balance/1``.

    What has no value is null: in a correction plane nothing is judged, and no bearing is there.
    """
    axis, shaft, service, tolerance = data.axis, data.axis.shaft, data.service, data.tolerance
    return {
        "schema": "inertia/balance/1",
        "rotor": data.rotor,
        "verdict": data.outcome,
        "scatter": _scatter(data),
        "why": list(data.verdict.why),
        "axis_taken_as_exact": _axis_taken_as_exact(data),
        "report": plain(data.head),
        "bodies": [_body(body) for body in data.bodies],
        "indexing": None
        if data.indexing is None
        else {
            "names": list(data.indexing.names),
            "turned_deg": [converted(math.degrees(turn)) for turn in data.indexing.turns],
            "moves": [{"part": part, "place_of": other} for part, other in data.indexing.moves],
            "tolerance_planes_as_filed": [_vector(value) for value in data.indexing.planes_as_filed],
            "tolerance_planes_left": [_vector(value) for value in data.indexing.planes_left],
            "left": data.indexing.left,
            "as_filed": data.indexing.as_filed,
            "left_at_least": data.indexing.bound,
            "ways": data.indexing.ways,
        },
        "axis": {
            "obtained": axis.obtained,
            "confirmed": axis.confirmed,
            "bearing_a_mm": _mm(shaft.bearing_a.tolist()),
            "bearing_b_mm": _mm(shaft.bearing_b.tolist()),
            "zero_mark": shaft.zero_mark.tolist(),
            "rotation": shaft.rotation,
            "radial_uncertainty_mm": data.radial_uncertainty,
            "candidates": [_candidate(candidate) for candidate in axis.candidates],
        },
        "angles": "counter-clockwise seen from bearing B looking toward A, 0 at the zero mark, of the heavy spot",
        "rpm": service.rpm,
        "critical_rpm": service.critical_rpm,
        "run_up_rpm_per_s": service.run_up,
        "rigid": None
        if data.rigid is None
        else {"ratio": data.rigid.ratio, "level": data.rigid.level, "text": data.rigid.text},
        "mass": data.initial.mass,
        "z_mm": data.initial.z,
        **_whole(data.initial),
        "class": data.initial.kind,
        "principal_axis": {
            "tilt_deg": math.degrees(data.tilt.angle),
            "direction_deg": math.degrees(data.tilt.direction) % 360.0,
            "bound_deg": math.degrees(data.tilt.bound),
        },
        "tolerance": {
            "standard": tolerance.standard,
            "rule": tolerance.rule,
            "meant_for": list(tolerance.meant_for),
            "total_gmm": None if tolerance.total is None else in_gmm(tolerance.total),
            "shares": None
            if tolerance.shares is None
            else [
                {"allocated": k.allocated, "used": k.used, "limits": list(k.limits), "clamped": k.clamped}
                for k in tolerance.shares
            ],
        },
        **_by_plane(data, data.initial),
        "initial_verdict": data.initial.outcome,
        "corrections": [_operation(*numbered) for numbered in enumerate(data.operations, 1)],
        "correction": {
            "why": data.ending,
            "within": data.within,
            "limits_hit": list(data.limits_hit),
            "cuts": data.cuts,
            "left": data.worst,
            "left_at_least": data.bound,
            "fewest": data.fewest,
            "cut_short": data.cut_short,
        }
        if data.corrected
        else None,
        "residual": {
            "mass": data.residual.mass,
            "z_mm": data.residual.z,
            **_whole(data.residual),
            **_by_plane(data, data.residual),
        },
        "notes": list(data.notes),
    }


def balance_csv(data: ReportData) -> str:
    """Return two tables with a line of names each, an empty line between them: planes before and after, operations."""
    rows: list[list[object]] = [[*_PLANES]]
    for state in (data.initial, data.residual):
        for plane in (entry for entries in _by_plane(data, state).values() for entry in entries):
            rows.append(_row(_PLANES, {"state": state.name, "plane": plane["id"]} | plane))
    rows += [
        [],
        [*_OPERATIONS],
        *(_row(_OPERATIONS, _operation(*numbered)) for numbered in enumerate(data.operations, 1)),
    ]
    return csv_text(rows)


def _row(names: tuple[str, ...], entry: Document) -> list[object]:
    flat = entry | {f"unbalance_{key}": value for key, value in entry["unbalance"].items()}
    return [flat[name] for name in names]


def _mm(values: list[float]) -> list[float]:
    return [converted(MM * value) for value in values]


def _vector(value: complex) -> Document:
    return {"gmm": in_gmm(value), "deg": in_degrees(value)}


def _body(body: BodyRow) -> Document:
    return {
        "name": body.name,
        "path": body.path,
        "sha256": body.sha256,
        "unit": body.unit,
        "density": body.density,
        "density_from": body.density_from,
        "mass": body.mass,
        "triangles": body.triangles,
        "chord_tolerance_mm": body.chord,
        "chord_from": body.chord_from,
    }


def _axis_taken_as_exact(data: ReportData) -> Document | None:
    if not data.verdict.axis_exact:
        return None
    radius = data.verdict.turned_over_by
    return {"turned_over_by_mm": None if radius is None else MM * radius}


def _candidate(candidate: Candidate) -> Document:
    return {
        "where": candidate.where,
        "bearing_a_mm": _mm(candidate.bearing_a.tolist()),
        "bearing_b_mm": _mm(candidate.bearing_b.tolist()),
        "radii_mm": _mm(list(candidate.radii)),
        "coverage": candidate.coverage,
        "rms_mm": MM * candidate.rms,
        "uncertainty_mm": MM * candidate.uncertainty,
    }


def _whole(state: State) -> Document:
    couple = state.couple_about_center
    return {
        "static_unbalance": _vector(state.static),
        "couple_unbalance": {"gmm2": abs(couple) / GRAM_SQUARE_MILLIMETRE, "deg": in_degrees(couple)},
        "static_bound_gmm": in_gmm(math.fsum(state.static_bounds.values())),
        "couple_bound_gmm2": math.fsum(state.couple_bounds.values()) / GRAM_SQUARE_MILLIMETRE,
        "specific_unbalance_um": state.eccentricity,
        "achieved_grade_mm_s": state.grade,
        "axle_torque_Nm": state.torque,
    }


def _by_plane(data: ReportData, state: State) -> dict[str, list[Document]]:
    return {
        "tolerance_planes": [
            _plane(bearing.name, bearing.z, state.bearings[k], in_gmm(bearing.permissible), state.forces[k])
            | {
                "running_up_force_N": state.forces_running_up[k],
                "uncertainty_gmm": {source: in_gmm(bound) for source, bound in state.bearing_bounds[k].items()},
            }
            for k, bearing in enumerate(data.bearings)
        ],
        "correction_planes": [
            _plane(plane.id, plane.z, vector, None, None)
            for plane, vector in zip(data.planes, state.planes, strict=True)
        ],
    }


def _plane(name: str, z: float, unbalance: complex, permissible: float | None, force: float | None) -> Document:
    return {
        "id": name,
        "z_mm": z,
        "unbalance": _vector(unbalance),
        "permissible_gmm": permissible,
        "bearing_force_N": force,
    }


def _operation(step: int, work: OperationRow) -> Document:
    return {
        "step": step,
        "id": work.id,
        "plane": work.plane,
        "method": work.method,
        "kind": work.kind,
        "z_mm": work.z,
        "angle_deg": work.angle,
        "machine_angle_deg": work.machine_angle,
        "radius_mm": work.radius,
        "mass_g": work.mass,
        "unbalance": _vector(work.unbalance),
        "tool_diameter_mm": work.diameter,
        "depth_mm": work.depth,
        "width_mm": work.width,
        **_arc(work),
        "remaining_wall_mm": work.wall,
        "point_angle_deg": work.point,
        "pieces": work.pieces,
        "item": work.item,
    }


def _arc(work: OperationRow) -> Document:
    """Return what is said of an arc; null for what is none."""
    (start, stop), (first, last) = work.ends or (None, None), work.machine_ends or (None, None)
    along = None if work.ends is None else work.along_rim
    return {
        "arc_deg": work.arc,
        "from_deg": start,
        "to_deg": stop,
        "machine_from_deg": first,
        "machine_to_deg": last,
        "arc_mm": along,
        "passes": None if work.arc is None else work.passes,
    }


def _scatter(data: ReportData) -> Document:
    within = data.scatter.within_range
    return {
        "within": data.scatter.within,
        "within_range": None if within is None else list(within),
        "confidence": data.scatter.confidence,
        "draws": data.scatter.draws,
        "residual_95_gmm": [in_gmm(bearing.residual_95) for bearing in data.bearings],
        "sensitivities": [
            {
                "name": line.name,
                "step": line.step_text,
                "per_step_gmm": (line.per_step / GRAM_MILLIMETRE).tolist(),
                "share": line.share.tolist(),
            }
            for line in data.scatter.sensitivities
        ],
    }
