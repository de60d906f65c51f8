"""HTML pages from templates, in which all text is escaped, and control characters in it are made visible."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from inertia.errors import visible

if TYPE_CHECKING:
    import jinja2  # slow to import


def templates(package: str, **filters: Callable[..., Any]) -> jinja2.Environment:
    """Return the templates of a package, with filters that they use.

    Parameters
    ----------
    package : the one with a folder `templates`
    filters : functions by the names that templates have for them
    """
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader(package),
        autoescape=True,
        finalize=lambda value: visible(value) if type(value) is str else value,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters.update(filters)
    return environment
