"""`Measurement` → the certificate: one HTML file that needs nothing else, for screen and A4."""

from __future__ import annotations

import math
from collections.abc import Iterator

from markupsafe import Markup

from inertia.balancing.measured.measure import Measurement, work_digits
from inertia.balancing.shop_units import GRAM_MILLIMETRE
from inertia.report.measurement.document import Document, measurement_document
from inertia.report.measurement.text import (
    conventions_text,
    figure,
    method_text,
    mounted_text,
    pieces_text,
    reading_text,
    uncertainty_text,
    weight_text,
    work_text,
)
from inertia.report.numerals import direction, plain
from inertia.report.svg.polar import Arrow, key, polar
from inertia.report.templates import templates

_LABELS = {
    "part": "Part", "serial": "Serial", "revision": "Revision", "customer": "Customer", "remark": "Remark",
    "name": "Machine", "calibration": "Calibration", "operator": "Operator", "date": "Date", "place": "Place",
}  # fmt: skip
_GRAM = 1e-3


def certificate_html(result: Measurement) -> str:
    """Return the certificate as the text of an HTML file.

    It states the rotor, the machine and its calibration, the balancing speed, how readings count, every run from the
    first to the last, the residual unbalance with its uncertainty against what is permissible, and who did it.
    """
    digits = work_digits(result)
    environment = templates(
        "inertia.report.measurement",
        figure=figure, direction=direction, reading=reading_text, weight=weight_text, mounted=mounted_text,
        pieces=lambda plane: pieces_text(plane, digits), work=lambda work: work_text(work, digits),
        uncertainty=uncertainty_text, breakable=_breakable,
    )  # fmt: skip
    document = measurement_document(result)
    return environment.get_template("certificate.html.j2").render(
        document=document,
        standard="" if result.balance is None else result.balance.tolerance.standard,
        unit="g" if result.job.weighed_alone else "g·mm",
        unit_key="g" if result.job.weighed_alone else "gmm",
        rotor_facts=list(_facts(document["report"])),
        machine_facts=list(_machine_facts(document)),
        plots=list(_plots(result)),
        keys={style: key(style) for style in ("before", "after", "tolerance", "disc")},
        bounded=any(math.isfinite(plane.expanded) for plane in result.planes),
    )


def _breakable(weight: Document) -> Markup:
    """Return a weight at its angle whose line may break between its figures, not within one."""
    figures = weight_text(weight).replace(" = ", "\n= ").replace(" at ", "\nat ").split("\n")
    return Markup(" ").join(Markup("<span>{}</span>").format(figure) for figure in figures)


def _facts(section: Document) -> Iterator[tuple[str, str]]:
    for name, label in _LABELS.items():
        if name in section:
            yield label, section[name]


def _machine_facts(document: Document) -> Iterator[tuple[str, str]]:
    machine = document["machine"]
    yield from _facts({name: value for name, value in machine.items() if name != "serial"})
    if "serial" in machine:
        yield "Machine serial", machine["serial"]
    speeds = sorted({channel["rpm"] for channel in document["channels"] if channel["rpm"] is not None})
    yield "Balancing speed", ", ".join(f"{plain(speed, 1)} r/min" for speed in speeds) or "not stated"
    yield "Method", method_text(document)
    yield "Angles", conventions_text(document)
    for channel in document["channels"]:
        phase, noise = channel["phase_half_width_deg"], channel["noise_half_width"]
        read = f"read to ±{100 * channel['amplitude_half_width']:.3g} %"
        read += "" if phase is None else f" and ±{phase:.3g}°"
        if noise:
            read += f", beside ±{noise:.4g} {channel['unit']} of noise"
            read += ", the minimum achievable residual unbalance" if document["method"] == "balancing machine" else ""
        yield f"{channel['sensor']}, {channel['unit']}", read


def _plots(result: Measurement) -> Iterator[Markup]:
    """Yield a plot for each plane: as it was at first, and now with its uncertainty."""
    per = _GRAM if result.job.weighed_alone else GRAM_MILLIMETRE
    first = result.runs[0].unbalance if len(result.runs) > 1 and result.estimate.tooling is None else None
    for k, plane in enumerate(result.planes):
        arrows = [] if first is None else [Arrow(complex(first[k]) / per, "before")]
        # Without a bound there is no disc that could be drawn.
        uncertainty = plane.expanded / per if math.isfinite(plane.expanded) else 0.0
        arrows.append(Arrow(plane.unbalance / per, "after", uncertainty))
        tolerance = None if plane.permissible is None else plane.permissible / per
        if any(math.isfinite(abs(arrow.vector)) and arrow.vector for arrow in arrows):
            yield polar(f"plane {plane.plane.id}", arrows, tolerance=tolerance)
