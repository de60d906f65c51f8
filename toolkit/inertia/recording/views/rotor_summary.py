"""The text beside a rotor: verdict, unbalance, forces and operations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from inertia.balancing.balance import Balance
from inertia.balancing.shop_units import in_degrees, in_gmm
from inertia.balancing.unbalance import Unbalance


def summary(balance: Balance, pace: str, shown: Iterable[str]) -> str:
    """Return Markdown; `pace` says how fast it turns, `shown` what else was chosen for display only."""
    return "\n".join(
        [*_verdict(balance), "", pace, "", *_planes(balance), "", *_bearings(balance), "", *_notes(balance, shown)]
    )


def _verdict(balance: Balance) -> Iterator[str]:
    yield f"**{Path(balance.rotor.name).name}: {balance.verdict.outcome.upper()}**"
    if balance.verdict.outcome != balance.initial_verdict.outcome:
        yield f"after correction, {balance.initial_verdict.outcome.upper()} as modelled."
    yield f"{balance.tolerance.standard}. {' '.join(_sentence(each) for each in balance.verdict.why)}"


def _planes(balance: Balance) -> Iterator[str]:
    if not balance.planes:
        return
    corrected = balance.correction is not None
    yield f"| Correction plane | As modelled |{' Corrected |' if corrected else ''}"
    yield f"|-|-|{'-|' if corrected else ''}"
    for plane in balance.planes:
        after = f" {_polar(plane.residual)} |" if corrected else ""
        yield f"| {plane.id}, z = {1e3 * plane.z:.6g} mm | {_polar(plane.initial)} |{after}"


def _bearings(balance: Balance) -> Iterator[str]:
    states: list[tuple[str, Unbalance]] = [("as modelled", balance.initial)]
    if balance.correction is not None:
        states.append(("corrected", balance.residual))
    yield f"| Bearing | Permissible | {' | '.join(f'Force {name}' for name, _ in states)} |"
    yield f"|-|-|{'-|' * len(states)}"
    forces = [balance.forces(unbalance) for _, unbalance in states]
    for number, name in enumerate("AB"):
        felt = " | ".join(f"{abs(each[number]):.4g} N" for each in forces)
        yield f"| {name} | {in_gmm(balance.tolerance.permissible[number]):.4g} g·mm | {felt} |"


def _notes(balance: Balance, shown: Iterable[str]) -> Iterator[str]:
    yield f"**On the screen.** {' '.join(_sentence(each) for each in shown)}"
    if balance.rigid is not None:
        yield ""
        yield _sentence(balance.rigid.text)
    for note in balance.notes:
        yield f"- {note}"


def _polar(vector: complex) -> str:
    return f"{in_gmm(vector):.4g} g·mm at {in_degrees(vector):.1f}°"


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}{'' if text.endswith('.') else '.'}"
