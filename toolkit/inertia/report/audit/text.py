"""`Audit` → the text that the command prints: one row a link, then what was found."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from inertia.auditing.audit import Audit
from inertia.auditing.judge import Finding, LinkAudit
from inertia.report.numerals import table

_LEAST_SHARE, _LEAST_LENGTH = 1e-4, 1e-6  # what is less matters to nobody
_HEAD = ("link", "stated", "mass", "centre", "tensor", "")


def audit_text(audit: Audit) -> str:
    """Return the audit as text."""
    return "\n".join(_lines(audit)) + "\n"


def _lines(audit: Audit) -> Iterator[str]:
    counts = Counter(link.state for link in audit.links)
    states = ", ".join(f"{counts[state]} {state}" for state in sorted(counts))
    yield f"{audit.robot.path} ({audit.robot.format}): {audit.verdict}: {states}"
    yield f"Stated against computed, link by link; they agree within {100 * audit.tolerance:g} %."
    yield ""
    rows = [_HEAD, *(_row(link) for link in audit.links)]
    yield from table(rows, left=(0, 5))
    for link in audit.links:
        if link.findings and link.state != "consistent":
            yield ""
            yield f"{link.name}: {link.state}"
            yield from (f"  {sentence(finding)}" for finding in link.findings)
    named = [(link.name, finding) for link in audit.links if link.state == "consistent" for finding in link.findings]
    if named:
        yield ""
        yield from (f"{name}: {sentence(finding)}" for name, finding in named)
    yield from audit.robot.notes


def sentence(finding: Finding) -> str:
    """Return a finding as a line: what it is, what remains when it is undone, and what mends it."""
    remains = "" if finding.residual is None else f" ({percent(finding.residual)} remain)"
    remedy = f": {finding.remedy}" if finding.remedy else ""
    return f"{finding.sentence}{remains}{remedy} [{finding.code}]"


def percent(value: float) -> str:
    """Return a relative difference as a percentage of two digits.

    >>> percent(0.4312), percent(1e-9), percent(3.2e-4), percent(0.0)
    ('43 %', '< 0.01 %', '0.032 %', '0 %')
    """
    if 0 < value < _LEAST_SHARE:
        return f"< {100 * _LEAST_SHARE:g} %"
    return f"{100 * value:.2g} %" if value < 0.995 else f"{100 * value:.0f} %"


def millimetres(length: float) -> str:
    """Return a length in mm, of three digits.

    >>> millimetres(0.0123), millimetres(1e-12)
    ('12.3 mm', '< 0.001 mm')
    """
    return f"{1e3 * length:.3g} mm" if not 0 < length < _LEAST_LENGTH else f"< {1e3 * _LEAST_LENGTH:g} mm"


def _row(link: LinkAudit) -> tuple[str, ...]:
    mass = "-" if link.stated is None else f"{link.stated.mass:.6g} kg"
    if link.difference is None:
        return link.name, mass, "-", "-", "-", link.state
    difference = link.difference
    center = millimetres(difference.center_of_mass)
    return link.name, mass, percent(difference.mass), center, percent(difference.inertia), link.state
