"""The figures of the README, each with what measures it: fractions, 50 digits and geometry worked out by itself.

A claim is the words of a page that hold the figures, and what measures them.
"""

from __future__ import annotations

import hashlib
import io
import re
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

import inertia
from inertia_meshes import path

from . import oracles
from .measure import ROOT

NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*\w)")


@dataclass(frozen=True)
class Outcome:
    """What was measured, in words, and whether the claim holds; None where it could not be measured."""

    measured: str
    holds: bool | None


@dataclass(frozen=True)
class Claim:
    """The page, its words that hold the figures, and what measures them."""

    page: str
    words: str
    measure: Callable[[str], Outcome]


def printed(expected: Callable[[], Any]) -> Callable[[str], Outcome]:
    """Hold every number of the words against one that is known, to half a unit of its last digit."""

    def measure(words: str) -> Outcome:
        true = [float(x) for x in np.hstack([np.ravel(x) for x in expected()])]
        stated = NUMBER.findall(words)
        scale = max(map(abs, true))
        within = len(stated) == len(true) and all(
            abs(float(text) - x) <= (1e-12 * scale if float(text) == 0 else 0.5001 * _unit(text))
            for text, x in zip(stated, true, strict=True)
        )
        return Outcome(", ".join(f"{x + 0.0:.10g}" for x in true), within)

    return measure


def _unit(text: str) -> float:
    mantissa, _, exponent = text.partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def begins(expected: Callable[[], Sequence[float]]) -> Callable[[str], Outcome]:
    """Hold digits before an ellipsis against numbers that are known."""

    def measure(words: str) -> Outcome:
        true = expected()
        digits = re.findall(r"(\d+\.\d+)\.\.\.(e-\d+)?", words)
        shown = [f"{x:.16e}" if exponent else f"{x:.18f}" for x, (_, exponent) in zip(true, digits, strict=True)]
        return Outcome(", ".join(shown), all(s.startswith(d) for s, (d, _) in zip(shown, digits, strict=True)))

    return measure


def of_handle(*names: str, scales: Sequence[float] = (1.0,)) -> Callable[[str], Outcome]:
    """Hold printed figures against those of the handle, each name by each scale."""
    return printed(lambda: [np.multiply(oracles.handle()[name], scale) for scale in scales for name in names])


def _principal() -> list[Any]:
    known = oracles.handle()
    rows = zip((1, 2, 3), known["moments"], known["gyration"], known["axes"].T, strict=True)
    return [x for row in rows for x in row]


def _gap(words: str) -> Outcome:
    low, middle, high = oracles.handle()["moments"]
    gap = min(middle - low, high - middle) / high
    return Outcome(f"moments are {gap:.2g} of the largest apart", gap > float(NUMBER.findall(words)[0]))


def _bounds(words: str) -> Outcome:
    """Compare errors of the library's answer with its bounds, and these with the powers of ten on the page."""
    result = inertia.mass_properties(inertia.read(path("t_handle.stl"), unit="mm"), material="steel")
    known = oracles.handle()
    off = [
        abs(result.volume / (known["volume"] * 1e-9) - 1),
        max(abs(a - b * 1e-3) for a, b in zip(result.center_of_mass.tolist(), known["centre"], strict=True)),
        *(abs(a / b - 1) for a, b in zip(result.principal_moments.tolist(), known["moments"], strict=True)),
    ]
    moments = (result.principal.moment_bounds / result.principal.moments).tolist()
    bounds = [result.error.volume, result.error.center_of_mass, *moments]
    powers = [10.0 ** (int(k) + 1) for k in re.findall(r"\.\.\.e(-\d+)", words)]
    rounding = 2.3e-16  # of the figures that they are compared with, which are float64 themselves
    within = all(a <= b + rounding for a, b in zip(off, bounds, strict=True))
    return Outcome(f"errors up to {max(off):.1e}, bounds up to {max(bounds):.1e}", within and max(bounds) < max(powers))


def _hash(words: str) -> Outcome:
    true = hashlib.sha256(path("t_handle.stl").read_bytes()).hexdigest()
    return Outcome(true[:12] + "…", true in words)


def _open(words: str) -> Outcome:
    corners = oracles.corners_of("broken/missing_face.stl")
    edges, _ = oracles.rim(corners)
    length, centre = oracles.loop(edges)
    places = ", ".join(f"{x:.4g}" if x % 1 else f"{x:.1f}" for x in centre.tolist())
    first = {tuple(point) for point in corners[0].tolist()}
    at_first = any(edge[0] in first and edge[1] in first for edge in edges)
    text = f"1 boundary loop, {length:.2f} mm around ({places}) at triangle 0"
    return Outcome(f"{len(edges)} open edges, {length:.2f} mm around ({places})", text == words and at_first)


def _exit_code(words: str) -> Outcome:
    from inertia_cli.main import main

    with redirect_stderr(io.StringIO()):
        code = main(["analyse", str(path("broken/missing_face.stl"))])
    return Outcome(f"exit code {code}", str(code) in words)


def _python(words: str) -> Outcome:
    needs = re.findall(r'requires-python = ">=([\d.]+)"', (ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    return Outcome(f"the package asks for {needs[0]}", needs[0] in words)


def _hole(number: int, words: str) -> Outcome:
    z, degrees, radius, diameter, depth = oracles.HOLES[number]
    mass, _ = oracles.hole(radius, diameter, depth, degrees)
    same = all(text in words for text in (f" {z:.2f} ", f"{degrees:.2f}°", f" {radius:.2f} ", f"Ø{diameter:g} "))
    return Outcome(f"{mass:.3f} g by integrals over the hole", same and f" {mass:.3f} " in words)


def _residual(plane: int, words: str) -> Outcome:
    left, most = oracles.residual()[plane], oracles.limits()[plane]
    stated, give, limit = map(float, re.findall(r"[\d.]+(?= [±gG])|(?<=± )[\d.]+|(?<=against )[\d.]+", words))
    holds = abs(left - stated) <= give and abs(most / limit - 1) < 1e-3 and left < most
    return Outcome(f"{left:.4f} g·mm by fractions and integrals, against {most:.4g}", holds)


def _within(words: str) -> Outcome:
    share = oracles.share_within()
    stated = float(NUMBER.findall(words)[0]) / 100
    return Outcome(f"{100 * share:.2f} % of 2,000 draws of ours", share >= stated - 0.002)


def _attitude(words: str) -> Outcome:
    error, claim = oracles.motion_error()
    stated = 10.0 ** (int(re.findall(r"\.\.\.e(-\d+)", words)[0]) + 1)
    return Outcome(f"off by {error:.1e} rad, by 60 digits; the run says {claim:.1e}", error <= claim < stated)


README = (
    Claim("README.md", "With Python 3.11 or newer", _python),
    Claim("README.md", "SHA-256           3301a2b21984aaff4e1d06e940c0cc89275a5dcd90de9b4ddc32d580915af11b", _hash),
    Claim("README.md", "7850 kg/m³", printed(lambda: [0.03539207024 / oracles.handle()["volume"] * 1e9])),
    Claim("README.md", "594 triangles, closed, 1 body", of_handle("triangles", "pieces")),
    Claim(
        "README.md",
        "0.06, 0.01, 0.03 m\n                  = 60, 10, 30 mm",
        of_handle("size", scales=(1e-3, 1)),
    ),
    Claim("README.md", "4.50854398e-06 m³   = 4508.54398 mm³", of_handle("volume", scales=(1e-9, 1))),
    Claim("README.md", "0.002358036097 m²   = 2358.036097 mm²", of_handle("area", scales=(1e-6, 1))),
    Claim("README.md", "0.03539207024 kg", of_handle("mass")),
    Claim(
        "README.md",
        "0, 0, -0.003335138156 m\n                  = 0, 0, -3.335138156 mm",
        of_handle("centre", scales=(1e-3, 1)),
    ),
    Claim(
        "README.md",
        "   1.958350572e-06                 0                 0\n"
        "                 0   8.929341806e-06                 0\n"
        "                 0                 0   7.321532788e-06",
        of_handle("tensor"),
    ),
    Claim(
        "README.md",
        "  1          1.958350572e-06   7.438617645e-03   1.000000000   0.000000000   0.000000000\n"
        "  2          7.321532788e-06   1.438295170e-02   0.000000000   0.000000000  -1.000000000\n"
        "  3          8.929341806e-06   1.588388522e-02   0.000000000   1.000000000   0.000000000",
        printed(_principal),
    ),
    Claim("README.md", "moments count as equal within 1e-06 of the largest", _gap),
    Claim(
        "README.md",
        "semi-axes 0.03177397036, 0.01587147933, 0.004976073366 m along axes 1, 2, 3",
        printed(lambda: [oracles.handle()["semi-axes"], 1, 2, 3]),
    ),
    Claim(
        "README.md",
        "volume ...e-16, mass ...e-16, tensor ...e-16 (relative),\n"
        "                  centre of mass ...e-18 m\n"
        "                  principal moments ...e-16, ...e-16, ...e-16 (relative), axes ...e-14°, ...e-14°, ...e-14°\n"
        "                  float64, certified bound",
        _bounds,
    ),
    Claim("README.md", "exit code 4", _exit_code),
    Claim("README.md", "1 boundary loop, 34.14 mm around (-5.0, -1.464, -1.464) at triangle 0", _open),
    Claim(
        "README.md",
        "I-1         remove radial hole       90.00  210.00°   100.00     Ø10   14.20     9.350     5.00",
        partial(_hole, 0),
    ),
    Claim(
        "README.md",
        "II-1        remove radial hole      215.00   20.00°    80.00     Ø16   12.40    21.936     7.00",
        partial(_hole, 1),
    ),
    Claim("README.md", "over 99.8 % of parts within tolerance, 95 % asked for", _within),
    Claim("README.md", "plane A: 0.09973 ± 0.6562 g·mm against 109.9 g·mm", partial(_residual, 0)),
    Claim("README.md", "plane B: 0.7938 ± 0.9928 g·mm against 111 g·mm", partial(_residual, 1)),
    Claim("README.md", "attitude to ...e-14 rad, 1e-10 rad asked for", _attitude),
    Claim("README.md", "Flip period          2.996935953 s", printed(lambda: [oracles.flip_period()])),
    Claim(
        "README.md",
        "(0.0353920702..., array([1.958350...e-06, 7.321532...e-06, 8.929341...e-06]))",
        begins(lambda: [oracles.handle()["mass"], *oracles.handle()["moments"]]),
    ),
    Claim("README.md", "0.0707841404...", begins(lambda: [2 * oracles.handle()["mass"]])),
)


def untied(page: str, claims: Sequence[Claim]) -> list[str]:
    """Return the lines of a page that state a figure which no claim has; what is typed there states nothing."""
    for claim in sorted(claims, key=lambda claim: -len(claim.words)):
        page = page.replace(claim.words, "")
    page = re.sub(r"^```sh\n.*?^```$", "", page, flags=re.DOTALL | re.MULTILINE)
    page = re.sub(r"^(\$|>>>|\.\.\.) .*$|\]\([^)]*\)", "", page, flags=re.MULTILINE)
    return [line for line in page.splitlines() if re.search("[0-9]", line)]
