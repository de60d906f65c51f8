"""`Audit` → the document ``inertia/audit/1``."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from inertia.auditing.audit import Audit
from inertia.auditing.bodies import Body
from inertia.auditing.judge import Finding, LinkAudit
from inertia.mass.properties import MassProperties


def audit_document(audit: Audit) -> dict[str, Any]:
    """Return the audit as ``inertia/audit/1``: SI, link axes, tensors about the centre of mass with tensor signs."""
    robot = audit.robot
    return {
        "schema": "inertia/audit/1",
        "source": {"path": str(robot.path), "sha256": audit.sha256, "format": robot.format},
        "name": robot.name,
        "tolerance": audit.tolerance,
        "verdict": audit.verdict,
        "links": [_link(link) for link in audit.links],
        "notes": list(robot.notes),
    }


def _link(link: LinkAudit) -> dict[str, Any]:
    computed = None if link.computed is None else _computed(link.computed, link)
    return {
        "name": link.name,
        "state": link.state,
        "stated": None if link.stated is None else _stated(link.stated),
        "computed": computed,
        "difference": None if link.difference is None else asdict(link.difference),
        "triangle_margin": None if link.margin is None or not np.isfinite(link.margin) else link.margin,
        "findings": [_finding(finding) for finding in link.findings],
    }


def _finding(finding: Finding) -> dict[str, Any]:
    written = asdict(finding)
    del written["link"]  # among whose findings it stands
    return written


def _stated(body: Body) -> dict[str, Any]:
    return {"mass": body.mass, "center_of_mass": body.center.tolist(), "inertia": body.inertia.tolist()}


def _computed(properties: MassProperties, link: LinkAudit) -> dict[str, Any]:
    error = asdict(properties.error)
    if link.room:
        error["repair"] = link.room if np.isfinite(link.room) else None
    return {
        "mass": properties.mass,
        "center_of_mass": properties.center_of_mass.tolist(),
        "inertia": properties.inertia.tolist(),
        "densities": [float(density) for density in link.densities],
        "error": error,
    }
