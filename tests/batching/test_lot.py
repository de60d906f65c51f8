"""A production lot: magnitudes of normal vectors against closed forms, and rows made by known causes."""

import json
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy import integrate, stats

from inertia.batching.lot import Lot, Magnitude
from inertia.batching.summary import Summary
from inertia_cli.main import main
from inertia_meshes import path


def magnitude(mean: tuple[float, float], deviations: tuple[float, float]) -> Magnitude:
    return Magnitude(np.array(mean), np.array(deviations))


@pytest.mark.parametrize("limit", [0.1, 1.0, 3.0])
@pytest.mark.parametrize(
    ("vector", "closed"),
    [
        (magnitude((0, 0), (0.4, 0.4)), stats.rayleigh(scale=0.4)),
        (magnitude((0.3, -0.4), (0.2, 0.2)), stats.rice(b=2.5, scale=0.2)),
        (magnitude((3, -4), (1e-3, 1e-3)), stats.rice(b=5000, scale=1e-3)),
        (magnitude((0.5, 0), (0.3, 0)), stats.foldnorm(c=0.5 / 0.3, scale=0.3)),
    ],
)
def test_the_share_above_a_limit_is_that_of_the_closed_form(vector: Magnitude, closed: object, limit: float) -> None:
    assert vector.above(limit) == pytest.approx(closed.sf(limit), abs=1e-9)


def test_the_share_above_a_limit_is_that_of_draws_where_both_deviations_differ() -> None:
    random = np.random.default_rng(0)
    x, y = random.normal(0.3, 0.5, 10**6), random.normal(-0.2, 0.1, 10**6)
    assert magnitude((0.3, -0.2), (0.5, 0.1)).above(0.8) == pytest.approx((np.hypot(x, y) > 0.8).mean(), abs=2e-3)


@pytest.mark.parametrize("mean", [(0.5, 0.6), (0.0, 0.95), (0.3, -0.8), (2.0, 1.0)])
@pytest.mark.parametrize("ratio", [0.0, 1e-6, 0.005, 0.02, 0.3])
def test_the_share_above_a_limit_is_exact_where_one_deviation_is_small_or_nothing(
    mean: tuple[float, float], ratio: float
) -> None:
    a, b = mean
    along = stats.norm(a, 0.1)

    def beyond(z: float) -> float:
        """Return the share above the limit where the other component is z deviations from its mean."""
        reach = math.sqrt(max(0.0, 1.0 - (b + 0.1 * ratio * z) ** 2))
        return float(along.cdf(-reach) + along.sf(reach))

    exact = beyond(0.0)
    if ratio:
        tips = [(k - b) / (0.1 * ratio) for k in (-1.0, 1.0)]
        points = sorted([*range(-9, 10), *(k for k in tips if abs(k) < 9)])
        pieces = (
            integrate.quad(lambda z: stats.norm.pdf(z) * beyond(z), *ends, epsabs=1e-13) for ends in pairwise(points)
        )
        exact = math.fsum(piece for piece, _ in pieces)
    assert magnitude(mean, (0.1, 0.1 * ratio)).above(1.0) == pytest.approx(exact, abs=1e-10)


def test_the_index_of_what_varies_in_one_direction_is_that_of_a_folded_normal() -> None:
    a, b, s = 0.5, 0.6, 0.1
    middle, upper = (math.hypot(b, stats.foldnorm(a / s, scale=s).ppf(share)) for share in (0.5, 0.99865))
    assert magnitude((a, b), (s, 0.0)).ppk == pytest.approx((1 - middle) / (upper - middle), rel=1e-6)


def test_the_index_is_that_of_quantiles() -> None:
    closed = stats.rayleigh(scale=0.2)
    expected = (1 - closed.ppf(0.5)) / (closed.ppf(0.99865) - closed.ppf(0.5))
    assert magnitude((0, 0), (0.2, 0.2)).ppk == pytest.approx(expected, rel=1e-9)


def row(
    initial: complex, residual: complex, upper: float, within: float, shares: dict[str, float]
) -> dict[str, object]:
    both = {}
    for plane in "ab":
        both |= {f"permissible_{plane}_gmm": 50.0, f"residual_95_{plane}_gmm": 50 * upper}
        for name, vector in (("initial", initial), ("residual", residual)):
            both |= {f"{name}_{plane}_gmm": 50 * abs(vector), f"{name}_{plane}_deg": math.degrees(np.angle(vector))}
    shares_of_both = json.dumps({name: [share, share] for name, share in shares.items()})
    return {"state": "answered", "verdict": "pass", "within": within, "shares": shares_of_both, **both}


def test_a_lot_is_told_by_what_it_was_made_of() -> None:
    random, lot, count = np.random.default_rng(1), Lot(), 4000
    initial = 2.0 + random.normal(0, 0.5, (count, 2)) @ [1, 1j]
    residual = random.normal(0, 0.1, (count, 2)) @ [1, 1j]
    inner = 0.2
    uppers = stats.rice(b=abs(residual) / inner, scale=inner).ppf(0.95)
    for before, after, upper in zip(initial, residual, uppers, strict=True):
        shares = {"drill Ø16: depth": 0.5, "drill Ø10: depth": 0.25, "zero mark: angle": 0.25}
        lot.count(row(before, after, upper, 0.99, shares))
    document = lot.document()
    assert document is not None
    a = document["initial"][0]
    assert a["share_out"] == pytest.approx(stats.rice(b=4, scale=0.5).sf(1), abs=0.02)
    assert a["out"] == (abs(initial) > 1).sum()
    made, closed = document["residual"][1], stats.rayleigh(scale=math.hypot(0.1, inner))
    assert made["median"] == pytest.approx(closed.ppf(0.5), rel=0.02)
    assert made["upper"] == pytest.approx(closed.ppf(0.99865), rel=0.02)
    assert made["ppk"] == pytest.approx((1 - closed.ppf(0.5)) / (closed.ppf(0.99865) - closed.ppf(0.5)), rel=0.03)
    assert document["expected_out"] == pytest.approx(0.01)
    assert document["variance"] == pytest.approx({"depth": 0.6, "angle": 0.2, "between rotors": 0.2}, rel=0.05)
    assert document["halved"]["cause"] == "depth"
    less = stats.rayleigh(scale=math.sqrt(0.01 + 0.04 * (0.25 + 0.75 * 0.25)))
    assert document["halved"]["ppk"] == pytest.approx(
        (1 - less.ppf(0.5)) / (less.ppf(0.99865) - less.ppf(0.5)), rel=0.03
    )


def test_rows_without_an_answer_and_a_single_rotor_are_no_lot() -> None:
    summary = Summary("balance", 2)
    empty = {"state": "refused", "exit_code": 4, "message": "no", "path": "rotor.toml", "seconds": None}
    summary.count(empty, stored=False)
    assert summary.document()["lot"] is None


def test_rotor_files_are_a_lot(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rotor = path("rotors/two_disc_rotor.toml").read_text().partition("[[plane]]")[0]
    for number, rpm in enumerate((300, 3000)):
        text = rotor.replace('file = "../', f'file = "{path("two_disc_rotor.stl").parent}/')
        (tmp_path / f"rotor{number}.toml").write_text(text.replace("rpm = 3000", f"rpm = {rpm}"))
    assert main(["batch", f"{tmp_path}/*.toml", "--verb", "balance", "-o", str(tmp_path / "lot.csv"), "--json"]) == 0
    lot = json.loads(capsys.readouterr().out)["lot"]
    assert lot["rotors"] == 2
    assert [plane["out"] for plane in lot["residual"]] == [1, 1] == [plane["out"] for plane in lot["initial"]]
    assert next(iter(lot["variance"])) == "between rotors"
