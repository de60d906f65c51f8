"""Every figure of the README is a claim that `python -m tests.benchmarks --quick` holds against what it measures."""

import pytest
from tests.benchmarks.claims import Claim, untied
from tests.benchmarks.measure import ROOT
from tests.benchmarks.quick import CLAIMS

README = (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: f"{claim.page}: {claim.words.strip()[:40]}")
def test_the_page_says_so(claim: Claim) -> None:
    assert claim.words in (ROOT / claim.page).read_text(encoding="utf-8")


def test_each_figure_of_the_readme_is_claimed() -> None:
    assert untied(README, [claim for claim in CLAIMS if claim.page == "README.md"]) == []


def test_a_figure_that_nothing_measures_shows() -> None:
    added = README + "\nIt is 42 times as fast.\n"
    assert untied(added, CLAIMS) == ["It is 42 times as fast."]
