"""Print a JSON document."""

from __future__ import annotations

import json
from typing import Any


def print_document(document: dict[str, Any]) -> None:
    """Print one JSON document, a line for each of its fields."""
    fields = (f" {json.dumps(key)}: {_as_json(value)}" for key, value in document.items())
    print("{\n" + ",\n".join(fields) + "\n}")


def _as_json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
