"""The command `batch`."""

from __future__ import annotations

import argparse
import sys
import time
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inertia.errors import FieldPath, ReadError, Remedy, UsageError
from inertia.report.numerals import significant
from inertia_cli.options import (
    accuracy,
    add_density,
    add_faults,
    add_intersections,
    add_orientation,
    add_parts,
    add_reading,
    by_name,
    estimate,
    size,
)
from inertia_cli.printing import show
from inertia_cli.wording import as_option

if TYPE_CHECKING:
    from inertia.batching.summary import Summary

VERBS = "analyse", "check", "balance", "audit"
_REFUSED = 4
EVERY = 10.0  # s between lines of progress where there is no terminal

_EXAMPLES = """examples:
  inertia batch 'parts/**/*.stl' -o parts.parquet --material steel
  inertia batch manifest.csv -o parts.csv --timeout 60 --memory 4e9
  find . -name '*.stl' -print0 | inertia batch - -o parts.jsonl
  inertia batch 'parts/*.stl' -o shard-$N.parquet --shard $N/8      # as one of eight jobs
  inertia batch --merge shard-*.parquet -o parts.parquet
"""


def add(parsers: Any) -> None:
    """Add ``inertia batch``."""
    parser = parsers.add_parser(
        "batch",
        help="many files to one table: a row for each, refusals included",
        description="Answer for many files in worker processes and write one table with a row for each of them. "
        "A run that was cut short goes on where it was when it is started again.",
        epilog=_EXAMPLES,
    )
    parser.set_defaults(run=run)
    parser.add_argument(
        "paths",
        nargs="*",
        metavar="GLOB",
        help="files, globs (** goes through folders), archives, URLs, manifests (.csv, .parquet); - for a list of "
        "paths on standard input",
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="TABLE",
        help="write TABLE: .parquet, .csv or .jsonl; without it, rows are printed as JSON lines",
    )
    parser.add_argument("--force", action="store_true", help="write over TABLE where it exists")
    parser.add_argument(
        "--verb",
        choices=VERBS,
        default="analyse",
        help="what is asked of every file: analyse (the default), check, balance (rotor files), audit (robots)",
    )
    parser.add_argument("--manifest", metavar="FILE", help="a manifest, whatever its name: CSV or Parquet")
    work = parser.add_argument_group("who works, and within what")
    work.add_argument("--jobs", type=int, metavar="N", help="worker processes: one for each processor, if not given")
    work.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="use the workers of that Dask scheduler, as tcp://host:8786; local for one in this process",
    )
    work.add_argument("--timeout", type=float, metavar="SECONDS", help="that one file may take")
    work.add_argument("--memory", type=size, metavar="BYTES", help="that one file may take, as 4GB (Linux)")
    work.add_argument("--shard", type=_shard, metavar="I/N", help="every N-th file from the I-th, as 3/8")
    work.add_argument(
        "--merge", nargs="+", metavar="TABLE", help="write one table from those of all shards, and do nothing else"
    )
    work.add_argument("--strict", action="store_true", help="exit code 4 where some file has no answer")
    work.add_argument("--timings", action="store_true", help="write the seconds that each file took")
    work.add_argument("--json", action="store_true", help="print the summary as a JSON document (inertia/batch/1)")
    options = parser.add_argument_group("of the verb, for every file; columns of a manifest come first")
    add_reading(options)
    add_density(parser)
    options.add_argument(
        "--shell", type=estimate, metavar="THICKNESS", help="the surface, which may be open, in --unit"
    )
    options.add_argument("--accuracy", type=accuracy, metavar="REL", help="relative bound that must be reached")
    options.add_argument("--union", action="store_true", default=None, help="count once what is enclosed twice")
    add_orientation(options)
    add_intersections(options)
    add_parts(options)
    add_faults(options)
    options.add_argument("--tolerance", type=float, metavar="REL", help="of audit: up to which figures agree (0.02)")
    options.add_argument("--lump", action="store_true", default=None, help="of audit: count fixed links as one")
    options.add_argument("--time", type=float, metavar="SECONDS", help="of balance: how long a plan is looked for (10)")


_OPTIONS = (
    "unit", "format", "unpack_limit", "mass", "shell", "accuracy", "union", "orientation", "intersections", "parts",
    "allow_faults", "tolerance", "lump", "time",
)  # fmt: skip
_WEIGHED = ("density", "material")
_OF_A_MERGE = ("merge", "output", "force", "strict", "json")
_DEFAULTS = {"orientation": "stored", "parts": "together"}


def run(options: argparse.Namespace) -> int:
    """Run ``inertia batch``."""
    options.part = "the batch"  # what faults of this program are said of
    try:
        return _run(options)
    except ReadError:
        options.part = ""  # it says by itself what it is said of
        raise


def _run(options: argparse.Namespace) -> int:
    from inertia.batching.batch import engine_for, setup_for, sharded, tasks_for
    from inertia.batching.table import merge, write_batch
    from inertia.tables import require_table

    output = None if options.output is None else require_table(options.output, force=options.force)
    if output is None and (options.json or options.merge is not None):
        raise UsageError("rows are printed where there is no table to write: name one with -o")
    if options.merge is not None:
        if options.paths:
            raise UsageError("--merge takes tables only: leave the files out")
        for action in _parser()._actions:
            given = action.option_strings and getattr(options, action.dest, action.default) != action.default
            if given and action.dest not in _OF_A_MERGE:
                raise UsageError(f"{action.option_strings[0]} has no meaning with --merge: leave it out")
        assert output is not None
        summary = merge(output, [Path(name) for name in options.merge])
    else:
        if not options.paths and options.manifest is None:
            raise UsageError("there are no files: name some, or a --manifest")
        asked = {name: getattr(options, name) for name in _OPTIONS}
        asked = {name: value for name, value in asked.items() if value not in (None, _DEFAULTS.get(name))}
        for name in _WEIGHED:
            if (values := by_name(name, getattr(options, name))) is not None:
                asked[name] = values[""] if set(values) == {""} else values
        setup = setup_for(
            options.verb,
            asked,
            timeout=options.timeout,
            memory=options.memory,
            offered=(*_OPTIONS, *_WEIGHED),
            wording=_worded,
        )
        engine = engine_for(setup, options.jobs, options.dask)
        everything = tasks_for(options.paths, setup, manifest=options.manifest)
        tasks = sharded(everything, options.shard)
        with _Progress(len(tasks)) as progress:
            summary = write_batch(
                output,
                tasks,
                setup,
                engine,
                shard=options.shard,
                everything=everything,
                force=options.force,
                timings=options.timings,
                progress=progress,
            )
    if output is None:
        print(summary.text(), file=sys.stderr)
    else:
        show(options.json, summary.document, summary.text)
    return _REFUSED if options.strict and summary.refused else 0


def _worded(word: Remedy | FieldPath) -> str:
    """Return the option of this command that a remedy is, or that of the command which is asked of every file.

    >>> [_worded(Remedy(*remedy)) for remedy in (("analyse", "union", True), ("repair",), ("check",))]
    ['--union', '`inertia analyse --repair`', '`inertia check`']
    """
    option = as_option(word)
    elsewhere = option.startswith("--") and option.partition(" ")[0] not in _parser()._option_string_actions
    return f"`inertia analyse {option}`" if elsewhere else option


@cache
def _parser() -> argparse.ArgumentParser:
    """Return the parser of this command alone."""
    parsers = argparse.ArgumentParser().add_subparsers()
    add(parsers)
    return parsers.choices["batch"]


def _shard(text: str) -> tuple[int, int]:
    number, _, count = text.partition("/")
    try:
        return int(number), int(count)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no shard: give two numbers, as 3/8") from None


class _Progress:
    """Rate, remaining time and counts by state: a bar on a terminal, else a line now and then."""

    def __init__(self, files: int) -> None:
        self._files, self._started = files, time.monotonic()
        self._terminal = sys.stderr is not None and sys.stderr.isatty()
        self._next = self._started + (0.5 if self._terminal else EVERY)
        self._bar: Any = None

    def __enter__(self) -> _Progress:
        """Return the callable itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Wipe the bar."""
        if self._bar is not None:
            self._bar.stop()

    def __call__(self, summary: Summary) -> None:
        """Show how far the batch is, if it is time."""
        now = time.monotonic()
        if now < self._next or sys.stderr is None:
            return
        self._next = now + (0.1 if self._terminal else EVERY)
        done = summary.rows - summary.stored
        rate = done / (now - self._started)
        left = f"{_time((self._files - summary.rows) / rate)} left" if rate else "time left not known"
        states = ", ".join(f"{count} {state}" for state, count in sorted(summary.states.items()))
        text = f"{summary.rows} of {self._files} files, {significant(rate, 3, 3)} files/s, {left}: {states}"
        if not self._terminal:
            print(f"inertia: {text}", file=sys.stderr, flush=True)
            return
        if self._bar is None:
            self._bar = _bar()
        self._bar.update(self._bar.task_ids[0], total=self._files, completed=summary.rows, description=text)
        self._bar.refresh()


def _bar() -> Any:
    """Return a bar that is drawn only when it is told to, and is wiped when it is stopped."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    bar = Progress(
        BarColumn(20), TextColumn("{task.description}"), console=Console(file=sys.stderr), auto_refresh=False,
        transient=True, redirect_stdout=False, redirect_stderr=False,
    )  # fmt: skip
    bar.add_task("")
    bar.start()
    return bar


def _time(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s" if minutes else f"{rest} s"
