"""What is public changes on purpose only: names, parameters, members, commands and options are stored."""

import importlib.util
from difflib import unified_diff
from pathlib import Path

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
