"""One file → one row: the verb's own result flattened, or why there is none, and the files that it rests on."""

from __future__ import annotations

import json
import os
import re
import stat
import sys
import sysconfig
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import field
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from inertia.batching.columns import COLUMNS, State
from inertia.batching.sources import Task, is_url, local_copy
from inertia.errors import GeometryError, InertiaError, ReadError, Remedy, Sentence, Wording, WriteError, visible
from inertia.mesh.external.memory import in_bytes, resident
from inertia.mesh.version import CHANGED, sha256_of, state_of
from inertia.output import inputs_noted, status_of
from inertia.records import dataclass

Row = dict[str, Any]
T = TypeVar("T")

_FAULT = 1  # the exit code where the process that answers dies
READ = ("unit", "format", "unpack_limit")
WEIGHED = ("density", "material", "mass")  # which say the same in different ways
_SLOWEST = 1e7  # bytes that a mount reads each second, at least
_MEMORY = Remedy("batch", "memory", "BYTES")
_TIMEOUT = Remedy("batch", "timeout", "SECONDS")

MOUNT = 60.0
"""s that a mount may take to answer where a file that had no answer is hashed."""


@dataclass(frozen=True)
class Setup:
    """What is asked of all files.

    Attributes
    ----------
    verb : "analyse", "check", "balance" or "audit"
    options : of that verb
    timeout : s that a file may take; None for any
    memory : bytes that a file may take beside what the process takes without one; None for any
    wording : of remedies and fields in sentences
    """

    verb: str
    options: Mapping[str, Any] = field(default_factory=dict)
    timeout: float | None = None
    memory: int | None = None
    wording: Wording = str

    def options_of(self, task: Task) -> dict[str, Any]:
        """Return the options of a file: its own, and those of all files that they do not take the place of."""
        weighed = any(name in task.options for name in WEIGHED)
        common = {name: value for name, value in self.options.items() if not (weighed and name in WEIGHED)}
        return {**common, **task.options}

    def failed(
        self,
        task: Task,
        state: State,
        why: str,
        seconds: float | None = None,
        before: os.stat_result | None = None,
        folder: str = "",
    ) -> Answer:
        """Return the row of a file that the process which answered for it did not survive, or not in time.

        `before` is what the file, relative to the folder, was when it was its turn. It is hashed, whatever the load;
        not where a mount hangs, nor where it lies in an archive.
        """
        words: tuple[str | Remedy, ...] = (visible(task.path), ": ", why)
        if state == "timed_out":
            words = (*words, ": look at the file, or allow it more by ", _TIMEOUT)
        code = GeometryError.exit_code if state == "timed_out" else _FAULT
        row = self.empty(task) | {
            "state": state,
            "exit_code": code,
            "message": Sentence(*words).worded(self.wording),
            "seconds": seconds,
        }
        size, time_ns, digest = None, None, None
        if before is not None:
            size, time_ns = before.st_size, before.st_mtime_ns
            if not task.archive:
                patience = MOUNT + size / _SLOWEST
                name, kept = os.fspath(Path(folder, task.file)), state_of(before)
                row["sha256"] = digest = within(patience, lambda: _digest_if(name, kept), None)
        return Answer(row, (Used(task.file, size, time_ns, digest),))

    def empty(self, task: Task) -> Row:
        """Return a row of nothing but the path."""
        return dict.fromkeys(column.name for column in COLUMNS[self.verb]) | {"path": task.path}


class Used(NamedTuple):
    """A file that an answer rests on, as it was: its size and time are None where it is not there.

    Of what is not on this machine, as a URL, it is not known whether it has changed; what changed while it was being
    answered for counts as such.
    """

    path: str
    size: int | None
    time_ns: int | None
    sha256: str | None
    here: bool = True

    @property
    def unchanged(self) -> bool:
        """Whether it still has those contents; of the same size and time of change, it is taken to have them."""
        if not self.here:
            return False
        try:
            status = Path(self.path).stat()
        except OSError:
            return self.size is None
        if (status.st_size, status.st_mtime_ns) == (self.size, self.time_ns):
            return True
        if status.st_size != self.size or self.sha256 is None:
            return False
        with suppress(OSError):
            return _digest(Path(self.path)) == self.sha256
        return False


class Answer(NamedTuple):
    """A row, the files that it rests on, and whether an earlier run gave it."""

    row: Row
    files: tuple[Used, ...]
    stored: bool = False


def answer(task: Task, setup: Setup) -> Answer:
    """Return the row of a file; whatever goes wrong with it stands in the row."""
    started = time.perf_counter()
    row, file = setup.empty(task), task.path

    def worded(sentence: Sentence | str) -> str:
        text = sentence.worded(setup.wording) if isinstance(sentence, Sentence) else visible(sentence)
        return text if file == task.path else text.replace(visible(file), visible(task.path))

    def failed(state: State, code: int, *words: str | Remedy) -> None:
        row.update(state=state, exit_code=code, message=worded(Sentence(*words)))

    short = False
    options = setup.options_of(task)
    before = {task.file: status_of(task.file)}
    with ExitStack() as stack:
        opened, noted = stack.enter_context(_opened()), stack.enter_context(inputs_noted())
        stack.enter_context(warnings.catch_warnings())
        warnings.simplefilter("ignore")
        warnings.simplefilter("error", RuntimeWarning)  # as on the command line: an overflow is no ground for an answer
        try:
            file = stack.enter_context(local_copy(task, options.get("unpack_limit")))
            row.update(state="answered", exit_code=0)
            _VERBS[setup.verb](file, options, row, worded)
        except InertiaError as error:
            state: State = "unreadable" if isinstance(error, ReadError | WriteError) else "refused"
            if setup.memory is not None and _for_memory(error):
                failed(state, error.exit_code, *_beyond(file, setup.memory))
                short = True
            else:
                placed = visible(file) in error.sentence
                failed(state, error.exit_code, *(() if placed else (file, ": ")), error.sentence)
        except (RuntimeWarning, OverflowError) as beyond:
            says = f": its figures lead beyond what float64 holds ({beyond}): check their sizes and units"
            failed("refused", GeometryError.exit_code, file, says)
        except MemoryError:
            failed("refused", GeometryError.exit_code, *_beyond(file, setup.memory))
            short = True
        except Exception as fault:
            failed("crashed", _FAULT, file, f": a fault of this program, {type(fault).__name__}: {fault}")
        if short and setup.verb == "analyse" and setup.memory is not None:
            known = _fault_by_pieces(file, options, setup.memory)
            if known is not None:
                failed("refused", known.exit_code, known.sentence)
        if row["sha256"] is None and file != task.path:
            with suppress(OSError, ValueError):
                row["sha256"] = _digest(Path(file))
    if task.member:
        files = _used(before)
    elif is_url(task.path):
        files = (Used(task.path, None, None, None, False),)
    else:
        others = {os.fspath(name): status for name, status in noted.items() if isinstance(name, Path)}
        files = _used(before | others | opened | before, task.file, row["sha256"])
        row["sha256"] = row["sha256"] or next((used.sha256 for used in files if used.path == task.file), None)
    row["seconds"] = time.perf_counter() - started
    return Answer(row, files)


def _beyond(file: str, memory: int | None) -> tuple[str | Remedy, ...]:
    if memory is None:
        return file, " needs more memory than there is: split the part or use a larger machine"
    return file, f" needs more memory than a file may take, {in_bytes(memory)}: allow more by ", _MEMORY


def _fault_by_pieces(file: str, options: Mapping[str, Any], memory: int) -> GeometryError | None:
    """Return what is wrong with a part that takes more memory than it may, where that shows piece by piece."""
    from inertia.mass.analyse import analyse

    with suppress(Exception):  # that it takes too much is the answer then
        part, others = _part(file, options, {})
        try:
            analyse(part, memory=resident() + memory, **others)
        except GeometryError as fault:  # in its words before what remedies take, which depends on what ran before
            return fault.__context__ if isinstance(fault.__context__, GeometryError) else fault
    return None


def _for_memory(error: BaseException | None) -> bool:
    while error is not None and not isinstance(error, MemoryError):
        error = error.__cause__
    return error is not None


def within(seconds: float | None, function: Callable[[], T], otherwise: T) -> T:
    """Return what a function returns, or `otherwise` where it takes longer: a mount that hangs never answers."""
    if seconds is None:
        return function()
    results: list[T] = []
    thread = threading.Thread(target=lambda: results.append(function()), daemon=True)
    thread.start()
    thread.join(min(seconds, threading.TIMEOUT_MAX))
    return results[0] if results else otherwise


def _digest(path: Path) -> str:
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):  # before it is opened: a pipe without a writer would wait for one
        raise ReadError("it is not a regular file")
    return sha256_of(path, status.st_size)


_Statuses = dict[str, os.stat_result | None]
"""What files were before they were read, by name."""

_open_files: _Statuses | None = None
"""Those that the verb has opened; None where nobody asks."""


@contextmanager
def _opened() -> Iterator[_Statuses]:
    """Yield the files that are opened in the context."""
    global _open_files
    if not _hooked:
        sys.addaudithook(_audit)
        _hooked.append(True)
    files: _Statuses = {}
    _open_files = files
    try:
        yield files
    finally:
        _open_files = None


_hooked: list[bool] = []
_OURS = tuple(
    f"{folder}{os.sep}"
    for folder in {
        *(sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")),
        str(Path(os.__file__).parent),
        str(Path(__file__).parent.parent),
        "/proc",
        "/sys",
    }
)
"""Folders with what belongs to the program and to Python, and what is no file."""

_TEMPORARY = re.compile(rf"\.kernel$|\.inertia(?:$|{re.escape(os.sep)})").search


def _audit(event: str, arguments: tuple[Any, ...]) -> None:
    if event == "open" and _open_files is not None and isinstance(arguments[0], str | os.PathLike):
        name = os.fspath(arguments[0])
        if isinstance(name, str) and name not in _open_files and not name.startswith(_OURS) and not _TEMPORARY(name):
            _open_files[name] = status_of(name)


def _used(before: _Statuses, read: str = "", digest: str | None = None) -> tuple[Used, ...]:
    """Return files as they were before and still are; `digest` is that of the one that was `read`, if it is known."""
    files = []
    for name, status in before.items():
        after = status_of(name)
        if after is None:  # of what the verb itself has put there, nothing is left
            files.append(Used(name, None, None, None))
        elif stat.S_ISREG(after.st_mode):
            try:
                known = digest if name == read else None
                if status is None or state_of(after) != state_of(status):
                    raise ReadError(CHANGED)
                files.append(Used(name, after.st_size, after.st_mtime_ns, known or _digest_as(name, state_of(after))))
            except (OSError, ValueError):
                files.append(Used(name, None, None, None, False))
    return tuple(files)


@lru_cache(maxsize=64)  # an archive has many members
def _digest_as(name: str, state: tuple[int, ...]) -> str:
    """Return the SHA-256 of a file that is in a state; raise `ReadError` where it is not."""
    digest = _digest(Path(name))
    if state_of(Path(name).stat()) != state:
        raise ReadError(CHANGED)
    return digest


def _digest_if(name: str, state: tuple[int, ...]) -> str | None:
    """Return the SHA-256 of a file; None where it is not in that state, or cannot be read."""
    with suppress(OSError, ValueError, ReadError):
        return _digest_as(name, state)
    return None


_Worded = Callable[[Sentence | str], str]


def _part(file: str, options: Mapping[str, Any], row: Row) -> tuple[Any, dict[str, Any]]:
    """Return the part in a file, and the options that are not those of reading."""
    from inertia.mesh.read import read

    part = read(file, **{name: options[name] for name in READ if name in options})
    row.update(sha256=part.source.sha256, unit=part.unit.name, unit_from=part.unit_from)
    return part, {name: value for name, value in options.items() if name not in READ}


def _analyse(file: str, options: Mapping[str, Any], row: Row, worded: _Worded) -> None:
    from inertia.exchange.rotations import quaternion_of
    from inertia.mass.analyse import analyse
    from inertia.once import checking_once

    part, others = _part(file, options, row)
    with checking_once():
        try:
            analysis = analyse(part, **others)
        except GeometryError as error:
            row.update(place=_place_of(part, others, error))
            raise
    properties, principal = analysis.properties, analysis.principal
    tensor, bounds = properties.inertia, properties.error
    w, *vector = quaternion_of(principal.axes)
    row.update(
        density=analysis.density,
        density_from=analysis.density_from,
        triangles=analysis.triangles,
        bodies=analysis.bodies,
        volume=properties.volume,
        area=analysis.area,
        mass=properties.mass,
        **_named("com_", "xyz", properties.center_of_mass.tolist()),
        **_named("i", ("xx", "yy", "zz", "xy", "xz", "yz"), [*tensor.diagonal().tolist(), *tensor[_ABOVE].tolist()]),
        **_named("i", "123", principal.moments.tolist()),
        **_named("axes_", "xyzw", [*vector, w]),
        **{"class": principal.kind},
        error_volume=bounds.volume,
        error_mass=bounds.mass,
        error_com=bounds.center_of_mass,
        error_inertia=bounds.inertia,
        method=bounds.method,
    )
    if analysis.doubts:
        row["message"] = worded(Sentence(analysis.doubts[0].message))


_ABOVE = (0, 0, 1), (1, 2, 2)  # the diagonal


def _named(prefix: str, names: Iterable[str], values: Iterable[float]) -> dict[str, float]:
    return {f"{prefix}{name}": value for name, value in zip(names, values, strict=True)}


def _place_of(part: Any, options: Mapping[str, Any], error: GeometryError) -> str | None:
    """Return where a part has the fault that it is refused for, where the check knows."""
    from inertia.mesh.check import check

    with suppress(Exception):
        known = {name: options[name] for name in ("intersections", "parts") if name in options}
        for finding in check(part, **known).findings:
            if finding.place is not None and (finding.statement or finding.message) in error.sentence:
                return _place(finding.place)
    return None


def _place(place: Any) -> str | None:
    return None if place is None else ", ".join(repr(float(k)) for k in place)


def _check(file: str, options: Mapping[str, Any], row: Row, worded: _Worded) -> None:
    from inertia.mesh.check import check

    part, others = _part(file, options, row)
    orientation = others.pop("orientation", "stored")
    report = check(part, **others)
    faults = report.faults(orientation)
    milder = [finding for finding in report.findings if finding.severity != "error"]
    first = next(iter((*faults, *milder)), None)
    row.update(
        **{name: getattr(report, name) for name in ("triangles", "vertices", "closed", "consistent", "outward")},
        fit=not faults,
        bodies=report.bodies,
        crossings_examined=report.crossings_examined,
        errors=len(faults),  # without those that the orientation forgives
        warnings=[finding.severity for finding in milder].count("warning"),
        findings=" ".join(finding.code for finding in report.findings),
    )
    if first is not None:
        row.update(message=worded(Sentence(first.message)), place=_place(first.place))
    if faults:
        row.update(state="refused", exit_code=GeometryError.exit_code)


def _audited(file: str, options: Mapping[str, Any], row: Row, worded: _Worded) -> None:
    from inertia.auditing.audit import audit
    from inertia.report.audit.document import audit_document

    result = audit(file, **{"densities" if k == "density" else k: v for k, v in options.items()})
    document = audit_document(result)
    links = document["links"]
    states = [link["state"] for link in links]
    differences = [link["difference"] for link in links if link["difference"] is not None]
    findings = [finding for link in links for finding in link["findings"]]
    row.update(
        sha256=document["source"]["sha256"],
        robot=document["name"],
        verdict=document["verdict"],
        exit_code={"consistent": 0, "inconsistent": 5, "undecided": 4}[document["verdict"]],
        links=len(links),
        **{state: states.count(state) for state in ("consistent", "inconsistent", "unphysical", "unjudged")},
        stated_mass=sum(link["stated"]["mass"] for link in links if link["stated"] is not None),
        findings=" ".join(dict.fromkeys(finding["code"] for finding in findings)),
    )
    if differences:
        for column, name in (("worst_mass", "mass"), ("worst_com", "center_of_mass"), ("worst_inertia", "inertia")):
            row[column] = max(float(difference[name]) for difference in differences)
    to_blame = {"inconsistent": ("inconsistent", "unphysical"), "undecided": ("unjudged",)}.get(document["verdict"], ())
    told = [link for link in result.links if link.state in to_blame and link.findings]
    if told:
        first = next((link for link in told if link.comparable), told[0])
        row["message"] = worded(f"{first.name}: {first.findings[0].sentence}")
    elif document["notes"]:
        row["message"] = worded(document["notes"][0])


def _balance(file: str, options: Mapping[str, Any], row: Row, worded: _Worded) -> None:
    from inertia.balancing.balance import balance
    from inertia.balancing.rotor import Rotor
    from inertia.report.balance.document import balance_document
    from inertia.report.balance.figures import report_data

    rotor = Rotor.load(file)
    if "time" in options:
        rotor = rotor.planned_in(options["time"])
    data = report_data(balance(rotor))
    document, outcomes = balance_document(data), [plane.outcome for plane in data.verdict.planes]
    verdict, scatter = document["verdict"], document["scatter"]
    code = {"pass": 0, "fail": 5, "undecided": 4, "conditional": 4}[verdict]
    if verdict == "conditional" and scatter["within"] is not None and scatter["within"] < 0.5:
        code = 5
    row.update(
        exit_code=code,
        verdict=verdict,
        initial_verdict=document["initial_verdict"],
        rpm=document["rpm"],
        mass=document["mass"],
        static_gmm=document["static_unbalance"]["gmm"],
        static_deg=document["static_unbalance"]["deg"],
        couple_gmm2=document["couple_unbalance"]["gmm2"],
        couple_deg=document["couple_unbalance"]["deg"],
        grade_mm_s=document["achieved_grade_mm_s"],
        within=scatter["within"],
        operations=len(document["corrections"]),
        shares=json.dumps({line["name"]: line["share"] for line in scatter["sensitivities"]}),
    )
    before, after = document["tolerance_planes"], document["residual"]["tolerance_planes"]
    for k, plane in enumerate("ab"):
        row[f"permissible_{plane}_gmm"] = after[k]["permissible_gmm"]
        row[f"initial_{plane}_gmm"], row[f"initial_{plane}_deg"] = before[k]["unbalance"].values()
        row[f"residual_{plane}_gmm"], row[f"residual_{plane}_deg"] = after[k]["unbalance"].values()
        row[f"bound_{plane}_gmm"] = sum(after[k]["uncertainty_gmm"].values())
        row[f"residual_95_{plane}_gmm"] = scatter["residual_95_gmm"][k]
    correction = document["correction"]
    hurried = [correction["why"]] if correction is not None and correction["cut_short"] else []  # as the load allowed
    decides = outcomes.index(verdict) if verdict in outcomes else -1  # a plane, or what is said behind both
    row["message"] = worded("; ".join([document["why"][decides], *hurried]))


_VERBS: dict[str, Callable[[str, Mapping[str, Any], Row, _Worded], None]] = {
    "analyse": _analyse,
    "check": _check,
    "balance": _balance,
    "audit": _audited,
}
