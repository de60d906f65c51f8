"""`Measurement` → the document ``inertia/measurement/1``, and the log of runs as CSV.

Angles and phases are counted as the job says, weights and heavy spots from the job's own mark; of the operations on the
rotor file's bodies, both angles are stated. A weight is {"g", "gmm", "deg"}: without a radius its g·mm are null.
"""

from __future__ import annotations

import math
from typing import Any

from inertia.balancing.bounds import COVERAGE
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.measured.measure import MeasuredPlane, MeasuredRun, Measurement
from inertia.balancing.shop_units import GRAM_MILLIMETRE, in_degrees
from inertia.documents import plain
from inertia.tables import csv_text

Document = dict[str, Any]

_GRAM, _MM = 1e-3, 1e-3
_LOG = ("run", "time", "mounted", "sensor", "rpm", "unit", "amplitude", "phase_deg", "predicted", "predicted_deg")


def measurement_document(result: Measurement) -> Document:
    """Return the measurement as ``inertia/measurement/1``; what has no value is null."""
    job, fields = result.job, result.job.fields
    estimate = result.estimate
    return {
        "schema": "inertia/measurement/1",
        "job": job.name,
        "report": plain(fields.report),
        "machine": plain(fields.machine),
        "method": fields.method,
        "criterion": fields.criterion,
        "conventions": {"angles": fields.conventions.angles, **plain(fields.conventions)},
        "channels": [
            {
                "sensor": channel.sensor,
                "rpm": channel.rpm,
                "unit": job.unit_of(channel),
                "amplitude_half_width": float(job.half_widths[0][k]),
                "phase_half_width_deg": math.degrees(float(job.half_widths[1][k])) if job.by_phase else None,
                "noise_half_width": job.shown(complex(job.noise[k]))[0],
            }
            for k, channel in enumerate(result.channels)
        ],
        "runs": [_run(result, k, run) for k, run in enumerate(result.runs)],
        "planes": [_plane(result, number, plane) for number, plane in enumerate(result.planes)],
        "coverage": COVERAGE,
        "coefficients": None if estimate.coefficients is None or job.by_machine else _coefficients(result),
        "condition": result.condition,
        "gap": result.gap,
        "present": _readings(result, result.present.tolist()),
        "predicted": _readings(result, result.predicted.tolist()),
        "tooling": None
        if estimate.tooling is None
        else [_weight(result, k, vector) for k, vector in enumerate(estimate.tooling.tolist())],
        "places": [_weight(result, 0, fit.unbalance) | {"misfit": fit.misfit} for fit in estimate.fits],
        "tolerance_planes": _tolerance_planes(result),
        "verdict": result.outcome,
        "why": list(result.why),
        "corrections": [_operation(result, work) for work in _operations(result)],
        "corrected": None
        if result.balance is None or result.balance.correction is None
        else {
            "verdict": result.balance.verdict.outcome,
            "why": [result.balance.correction.why, *result.balance.verdict.why],
        },
        "notes": [*result.notes, *(result.balance.notes if result.balance is not None else ())],
    }


def measurement_csv(result: Measurement) -> str:
    """Return the log: a line for each reading of each run."""
    rows: list[list[object]] = [[*_LOG]]
    for run in measurement_document(result)["runs"]:
        mounted = "; ".join(f"{k['plane']} {_size(k)} at {round(k['deg'], 6) % 360.0:.6g}" for k in run["mounted"])
        predicted = run["predicted"] or [{"amplitude": None, "phase_deg": None}] * len(run["readings"])
        for reading, expected in zip(run["readings"], predicted, strict=True):
            rows.append(
                [
                    *(run["id"], run["time"], mounted, reading["sensor"], reading["rpm"], reading["unit"]),
                    *(reading["amplitude"], reading["phase_deg"], expected["amplitude"], expected["phase_deg"]),
                ]
            )
    return csv_text(rows)


def _size(weight: Document) -> str:
    return f"{weight['gmm']:.6g} g·mm" if weight["g"] is None else f"{weight['g']:.6g} g"


def _run(result: Measurement, number: int, run: MeasuredRun) -> Document:
    # Masses that count at radii of their own make up no mass at that of the plane.
    elsewhere = {one.plane for each in result.job.runs for one in each.weights if one.radius is not None}
    return {
        "id": run.id,
        "time": run.time,
        "remark": run.remark,
        "mounted": [
            {"plane": plane.plane.id, **_weight(result, k, vector)}
            | ({"g": None} if plane.plane.id in elsewhere else {})
            for k, (plane, vector) in enumerate(zip(result.planes, run.mounted.tolist(), strict=True))
            if vector
        ],
        "readings": _entries(result, result.job.as_read(number)),
        "predicted": None if run.predicted is None else _readings(result, run.predicted.tolist()),
        "unbalance": None
        if run.unbalance is None
        else [_weight(result, k, vector) for k, vector in enumerate(run.unbalance.tolist())],
    }


def _readings(result: Measurement, values: list[complex]) -> list[Document]:
    """Return readings as the instruments will show them: with the runout."""
    runouts = result.job.runouts.tolist()
    return _entries(result, [result.job.shown(a + b) for a, b in zip(values, runouts, strict=True)])


def _entries(result: Measurement, shown: list[tuple[float, float | None]]) -> list[Document]:
    return [
        {
            "sensor": channel.sensor,
            "rpm": channel.rpm,
            "unit": result.job.unit_of(channel),
            "amplitude": amplitude,
            "phase_deg": phase,
        }
        for channel, (amplitude, phase) in zip(result.channels, shown, strict=True)
    ]


def _weight(result: Measurement, number: int, vector: complex) -> Document:
    job = result.job
    radius = result.planes[number].plane.radius
    size = abs(vector)
    mass = size if job.weighed_alone else None if radius is None else size / radius
    return {
        "g": None if mass is None else mass / _GRAM,
        "gmm": None if job.weighed_alone else size / GRAM_MILLIMETRE,
        "deg": in_degrees(vector),
    }


def _plane(result: Measurement, number: int, plane: MeasuredPlane) -> Document:
    per = _GRAM if result.job.weighed_alone else GRAM_MILLIMETRE
    unit = "g" if result.job.weighed_alone else "gmm"
    return {
        "id": plane.plane.id,
        "z_mm": None if plane.plane.z is None else plane.plane.z / _MM,
        "radius_mm": None if plane.plane.radius is None else plane.plane.radius / _MM,
        "initial": _initial(result, number),
        "unbalance": _weight(result, number, plane.unbalance),
        f"standard_uncertainty_{unit}": plane.uncertainty / per if math.isfinite(plane.uncertainty) else None,
        f"expanded_uncertainty_{unit}": plane.expanded / per if math.isfinite(plane.uncertainty) else None,
        "permissible_gmm": None if plane.permissible is None else plane.permissible / GRAM_MILLIMETRE,
        "verdict": plane.outcome,
        "correction": _weight(result, number, plane.correction),
        "pieces": [
            {"g": piece.mass / _GRAM, "deg": math.degrees(piece.angle), "item": piece.item, "pieces": piece.pieces}
            for piece in plane.pieces
        ],
        "left": _weight(result, number, plane.left),
    }


def _initial(result: Measurement, number: int) -> Document | None:
    """Return what the first of several runs showed in a plane."""
    first = result.runs[0].unbalance
    if first is None or len(result.runs) < 2 or result.estimate.tooling is not None:
        return None
    return _weight(result, number, complex(first[number]))


def _tolerance_planes(result: Measurement) -> list[Document]:
    """Return what the bearings of the rotor file see of it, in the angles of that file."""
    balance = result.balance
    if balance is None:
        return []
    return [
        {
            "id": plane.name,
            "z_mm": z / _MM,
            "unbalance": {"gmm": abs(plane.residual) / GRAM_MILLIMETRE, "deg": in_degrees(plane.residual)},
            "uncertainty_gmm": math.fsum(plane.bounds.values()) / GRAM_MILLIMETRE,
            "permissible_gmm": plane.permissible / GRAM_MILLIMETRE,
            "verdict": plane.outcome,
        }
        for plane, z in zip(balance.initial_verdict.planes, balance.tolerance_planes, strict=True)
    ]


def _coefficients(result: Measurement) -> list[Document]:
    values, errors = result.estimate.coefficients, result.estimate.coefficient_uncertainty
    assert values is not None
    per = _GRAM if result.job.weighed_alone else GRAM_MILLIMETRE
    return [
        {
            "sensor": channel.sensor,
            "rpm": channel.rpm,
            "plane": plane.plane.id,
            "unit": f"{result.job.unit_of(channel)} per {'g' if result.job.weighed_alone else 'g·mm'}",
            "amplitude": per * abs(complex(values[k, j])),
            "phase_deg": result.job.shown(complex(values[k, j]))[1],
            "standard_uncertainty": per * float(errors[k, j]),
        }
        for k, channel in enumerate(result.channels)
        for j, plane in enumerate(result.planes)
    ]


def _operations(result: Measurement) -> tuple[Operation, ...]:
    balance = result.balance
    return () if balance is None or balance.correction is None else balance.correction.operations


def _operation(result: Measurement, work: Operation) -> Document:
    """Return what the shop does to the rotor, at the angle of the rotor file and at that of the job."""
    angle = math.degrees(work.angle)
    return {
        "id": work.id,
        "plane": work.plane,
        "method": work.method,
        "kind": work.kind,
        "z_mm": work.z / _MM,
        "angle_deg": angle,
        "job_angle_deg": result.job.from_rotor(angle),
        "radius_mm": work.radius / _MM,
        "mass_g": work.mass / _GRAM,
        "unbalance_gmm": abs(work.unbalance) / GRAM_MILLIMETRE,
        "tool_diameter_mm": None if work.tool_diameter is None else work.tool_diameter / _MM,
        "depth_mm": None if work.depth is None else work.depth / _MM,
        "arc_deg": None if work.arc is None else math.degrees(work.arc),
        "item": work.item,
        "pieces": work.pieces,
    }
