"""`Measurement` → lines of text."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from inertia.balancing.measured.measure import Measurement, work_digits
from inertia.balancing.shop_digits import ShopDigits
from inertia.report.measurement.document import Document, measurement_document
from inertia.report.numerals import direction, fixed, row, significant, wrapped

_NAMED = (("part", ""), ("serial", "serial "), ("revision", "revision "), ("customer", "for "))
_MACHINE = (
    ("name", ""), ("serial", "serial "), ("calibration", "calibrated "), ("operator", "operator "), ("place", "at "),
    ("date", "on "), ("remark", ""),
)  # fmt: skip


def measurement_text(result: Measurement) -> str:
    """Return the measurement as lines of text; angles are counted as the job says."""
    document = measurement_document(result)
    blocks = [
        _head(document),
        _log(document),
        _planes(document),
        _work(document, work_digits(result)),
        _closing(document),
    ]
    return "\n\n".join("\n".join(lines) for block in blocks if (lines := list(block)))


def _head(document: Document) -> Iterator[str]:
    yield from wrapped("Verdict", (document["verdict"] or "nothing says what is permissible").upper())
    yield ""
    named = ", ".join(f"{word}{document['report'][name]}" for name, word in _NAMED if name in document["report"])
    yield row("Job", document["job"] + (f" ({named})" if named else ""))
    machine = ", ".join(f"{word}{document['machine'][name]}" for name, word in _MACHINE if name in document["machine"])
    if machine:
        yield from wrapped("Machine", machine)
    yield from wrapped("Method", method_text(document))
    yield from wrapped("Angles", conventions_text(document))


def method_text(document: Document) -> str:
    """Return how the weights were found."""
    if document["method"] != "influence coefficients":
        return str(document["method"])
    how = f"influence coefficients, {document['criterion']}, condition {figure(document['condition'])}"
    if document["criterion"] == "min-max":
        how += f", the largest reading within {max(document['gap'], 1e-9):.0e} of the least possible"
    return how


def conventions_text(document: Document) -> str:
    """Return in which sense angles and phases are counted."""
    conventions = document["conventions"]
    text = f"counted {conventions['angles']}, from the job's own mark; of an unbalance that of the heavy spot"
    return text + (f"; phases {conventions['phase']}" if "phase" in conventions else "")


def figure(value: float, least: int = 0) -> str:
    """Return a value with four significant digits and three decimals at most, or below 0.01 with three digits.

    At least it has so many decimals.

    >>> figure(9.99999999), figure(0.06), figure(0.00042), figure(123.456, 2)
    ('10.00', '0.060', '0.000420', '123.46')
    """
    rounded = float(f"{value:.3e}")
    text = significant(float(f"{value:.2e}"), 3, 9) if 0 < abs(rounded) < 0.01 else significant(rounded)
    return text if len(text.partition(".")[2]) >= least else fixed(value, least)


def reading_text(reading: Document) -> str:
    """Return a reading as it is shown."""
    phase = reading["phase_deg"]
    return figure(reading["amplitude"]) + ("" if phase is None else f" ∠ {direction(phase)}°")


def weight_text(weight: Document) -> str:
    """Return a weight, or an unbalance, at its angle."""
    sizes = [
        f"{figure(weight[name])} {unit}" for name, unit in (("g", "g"), ("gmm", "g·mm")) if weight[name] is not None
    ]
    return f"{' = '.join(sizes)} at {direction(weight['deg'])}°"


def mounted_text(run: Document) -> str:
    """Return what was mounted in a run."""
    return ", ".join(f"{k['plane']}: {weight_text(k)}" for k in run["mounted"]) or "–"


def _log(document: Document) -> Iterator[str]:
    width = max(14, *(len(str(run["id"])) + 2 for run in document["runs"]))
    names = [_channel(reading) for reading in document["runs"][0]["readings"]]
    column = max(24, *(len(name) + 2 for name in names))
    yield f"{'Run':<{width}}{'':<{column}}{'as read':<22}predicted"
    for run in document["runs"]:
        predicted = run["predicted"] or [None] * len(names)
        for k, (name, reading) in enumerate(zip(names, run["readings"], strict=True)):
            expected = "" if predicted[k] is None else reading_text(predicted[k])
            yield f"{'' if k else run['id']:<{width}}{name:<{column}}{reading_text(reading):<22}{expected}".rstrip()
        if run["mounted"]:
            yield f"{'':<{width}}with {mounted_text(run)}"


def _channel(reading: Document) -> str:
    speed = "" if reading["rpm"] is None else f" {reading['rpm']:g} r/min"
    return f"{reading['sensor']}{speed}, {reading['unit']}"


def _planes(document: Document) -> Iterator[str]:
    unit = "gmm" if document["planes"][0]["unbalance"]["gmm"] is not None else "g"
    shown = "g·mm" if unit == "gmm" else "g"
    yield f"{'Plane':<14}{f'unbalance, {shown}':>18}{'at':>9}{'± (95 %)':>11}{'limit':>11}  to add"
    for plane in document["planes"]:
        found = plane["unbalance"]
        limit = "" if plane["permissible_gmm"] is None else figure(plane["permissible_gmm"])
        expanded = plane[f"expanded_uncertainty_{unit}"]
        known, to_add = uncertainty_text(expanded), "nothing" if expanded is None else weight_text(plane["correction"])
        yield (
            f"{plane['id']:<14}{figure(found[unit]):>18}{direction(found['deg']) + '°':>9}"
            f"{known:>11}{limit:>11}  {to_add}"
        )
    for k, tooling in enumerate(document["tooling"] or ()):
        yield row("Tooling" if not k else "", f"plane {document['planes'][k]['id']}: {weight_text(tooling)}")


def uncertainty_text(uncertainty: float | None) -> str:
    """Return an uncertainty, or that the readings set it no bound."""
    return "no bound" if uncertainty is None else figure(uncertainty)


def pieces_text(plane: Document, digits: ShopDigits) -> str:
    """Return what is to be mounted in a plane."""
    masses = []
    for piece in plane["pieces"]:
        what = f"{piece['pieces']} × {piece['item']}" if piece["item"] else f"{figure(piece['g'], digits.mass)} g"
        masses.append(f"{what} at {direction(piece['deg'], max(1, digits.angle))}°")
    return ", ".join(masses) or "nothing"


def work_text(work: Document, digits: ShopDigits) -> str:
    """Return an operation on the rotor."""
    mass, unbalance = figure(work["mass_g"], digits.mass), f"{figure(work['unbalance_gmm'])} g·mm"
    item = "" if work["item"] is None else f" ({work['pieces']} × {work['item']})"
    radius, center = (figure(k, digits.place) for k in (work["radius_mm"], work["unbalance_gmm"] / work["mass_g"]))
    # A hole goes in from its radius: what it takes has its centre farther in, and counts there.
    size = f"{mass} g" if center == radius else f"{mass} g whose centre is at radius {center} mm"
    begins = "radius" if center == radius else "from radius"
    angle, z = direction(work["job_angle_deg"], max(1, digits.angle)), fixed(work["z_mm"], max(2, digits.place))
    where = f"{angle}°, {begins} {radius} mm, z {z} mm"
    tool = "" if work["tool_diameter_mm"] is None else f", Ø{figure(work['tool_diameter_mm'], digits.tool)}"
    depth = "" if work["depth_mm"] is None else f", {fixed(work['depth_mm'], max(2, digits.depth))} mm deep"
    return f"{work['id']}: {work['method']} {size} = {unbalance}{item} at {where}{tool}{depth}"


def _work(document: Document, digits: ShopDigits) -> Iterator[str]:
    if document["corrected"] is not None:
        for k, work in enumerate(document["corrections"]):
            yield from wrapped("" if k else "To do", work_text(work, digits))
        if not document["corrections"]:
            yield row("To do", "nothing")
        for k, sentence in enumerate(document["corrected"]["why"]):
            yield from wrapped("" if k else "Then, predicted", sentence)
        return
    if not any(plane["pieces"] for plane in document["planes"]):
        return
    for k, plane in enumerate(document["planes"]):
        yield row("" if k else "To mount", f"plane {plane['id']}: {pieces_text(plane, digits)}")
    yield from wrapped("Then, predicted", ", ".join(_then(k) for k in document["predicted"]))


def _then(reading: Document) -> str:
    return f"{reading['sensor']} {figure(reading['amplitude'])} {reading['unit']}"


def _closing(document: dict[str, Any]) -> Iterator[str]:
    for k, sentence in enumerate(document["why"]):
        yield from wrapped("" if k else "Why", sentence)
    for k, note in enumerate(document["notes"]):
        yield from wrapped("" if k else "Notes", note)
