"""What is public changes on purpose only: names, parameters, members, commands and options are stored."""

import importlib.util
from difflib import unified_diff
from pathlib import Path

import pytest

import inertia
from inertia import deprecation

DOCS = Path(__file__).resolve().parent.parent / "docs"


def test_what_is_public_changes_on_purpose_only() -> None:
    spec = importlib.util.spec_from_file_location("list_names", DOCS / "list_names.py")
    assert spec is not None
    assert spec.loader is not None
    lists = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(lists)
    stored, now = (DOCS / "public.txt").read_text(encoding="utf-8").splitlines(), lists.surface().splitlines()
    changes = [line for line in unified_diff(stored, now, "stored", "now", lineterm="", n=0) if line[:2] != "@@"]
    assert changes == [], "public, see docs/stability.md: say so in CHANGELOG.md, and run python docs/list_names.py"


def test_what_goes_warns_where_it_is_called_and_says_what_to_use() -> None:
    @deprecation.deprecated("inertia.weigh", since="0.9", instead="inertia.mass_properties")
    def weigh(mass: float) -> float:
        """Return the mass."""
        return mass

    try:
        assert deprecation.last["inertia.weigh"] == (0, 10)  # 0.9 and 0.10: two minor versions
        sentence = r"^inertia\.weigh is deprecated since 0\.9 and may go after 0\.10: use inertia\.mass_properties$"
        with pytest.warns(DeprecationWarning, match=sentence) as warned:
            assert weigh(2.0) == 2.0
    finally:
        del deprecation.last["inertia.weigh"]
    assert [each.filename for each in warned] == [__file__]
    assert weigh.__doc__ == "Return the mass."


def test_nothing_that_warns_is_kept_for_longer_than_is_said() -> None:
    now = tuple(int(part) for part in inertia.__version__.split(".")[:2])
    for name in inertia.__all__:
        getattr(inertia, name)
    assert {name: version for name, version in deprecation.last.items() if version < now} == {}
