"""The command `cite`."""

from __future__ import annotations

import argparse
import json
from typing import Any

from inertia_cli.printing import print_file


def add(parsers: Any) -> None:
    """Add ``inertia cite``."""
    parser = parsers.add_parser(
        "cite",
        help="BibTeX of this program and of the methods behind an answer",
        description="Print BibTeX of this program, and of the publications that the methods named in a JSON document "
        "of it are from.",
        epilog="examples:\n  inertia simulate scene.toml --json | inertia cite -\n",
    )
    parser.set_defaults(run=run)
    parser.add_argument(
        "part", nargs="?", metavar="DOCUMENT", help="what a command printed with --json; - is standard input"
    )


def run(options: argparse.Namespace) -> int:
    """Run ``inertia cite``."""
    from inertia.encoding import text_of
    from inertia.errors import ReadError, placed
    from inertia.report.citation import cite
    from inertia.standard_input import file_of, reason_of

    documents = []
    if options.part is not None:
        try:
            documents = [json.loads(text_of(file_of(options.part).read_bytes()))]
        except OSError as error:
            raise ReadError(f"cannot read {options.part}: {reason_of(error)}", code="no_file") from None
        except ReadError as error:
            raise placed(error, f"cannot read {options.part}") from None
        except ValueError:
            raise ReadError(f"cannot read {options.part}: it is no JSON document: name what --json printed") from None
        except RecursionError:
            raise ReadError(
                f"cannot read {options.part}: its lists or objects are nested too deeply: name what --json printed"
            ) from None
    print_file(cite(*documents))
    return 0
