"""Audit every robot below some folders, make mistakes on purpose in their consistent links, and write docs/robots.md.

pip download --no-deps -d wheels pybullet gymnasium-robotics robosuite dm_control
for wheel in wheels/*; do python -m zipfile -e $wheel robots/$(basename $wheel .whl); done
python -m tests.benchmarks.robots robots/*
"""

from __future__ import annotations

import argparse
import json
import os
import random
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from inertia.auditing.audit import Audit, audit
from inertia.auditing.bodies import Body
from inertia.auditing.claim import Claim, Context, Mistake, Statement, difference
from inertia.auditing.hypotheses import KINDS
from inertia.auditing.search import EXPLAINED, Search, explain
from inertia.errors import InertiaError

from .measure import ROOT

KINDS_OF_FILES = ("*.urdf", "*.xml", "*.sdf", "*.usda")
MARKS = (b"<robot", b"<mujoco", b"<sdf", b"#usda")
NOISE = (0.0, 0.001, 0.01)
SEEN = 3 * EXPLAINED
"""A mistake that changes less cannot be told from noise at the tolerance, and is not made."""


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.robots", description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--limit", type=float, default=300.0, help="seconds a file")
    parser.add_argument("--alike", type=int, default=60, help="files of one folder that are audited, at most")
    parser.add_argument("--mutations", type=int, default=12, help="mistakes made a consistent link and noise")
    parser.add_argument("--into", type=Path, default=ROOT / "docs" / "robots.md")
    parser.add_argument("--one", action="store_true", help="audit one file and print the result as JSON")
    options = parser.parse_args()
    if options.one:
        print(json.dumps(one(options.folders[0], options.mutations)))
        return
    files = sorted(_files(options.folders, options.alike))
    with ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(lambda file: _apart(file, options), files))
    text = page(results, sys.argv[1:])
    options.into.write_text(text, encoding="utf-8")
    options.into.with_suffix(".json").write_text(json.dumps(results), encoding="utf-8")
    print(text)


def _files(folders: list[Path], alike: int) -> Iterator[Path]:
    """Yield the robots below some folders; of folders with many alike, a fixed choice."""
    by_folder: dict[Path, list[Path]] = {}
    for folder in folders:
        for pattern in KINDS_OF_FILES:
            for file in sorted(folder.rglob(pattern)):
                with file.open("rb") as opened:
                    if any(mark in opened.read(65_536) for mark in MARKS):
                        key = file.parents[1] if "random_urdfs" in file.parts else file.parent
                        by_folder.setdefault(key, []).append(file)
    for files in by_folder.values():
        yield from files if len(files) <= alike else random.Random(1).sample(files, alike)


def _apart(file: Path, options: argparse.Namespace) -> dict[str, Any]:
    """Audit a file in a process of its own, with a limit of time."""
    command = [
        sys.executable,
        "-m",
        "tests.benchmarks.robots",
        "--one",
        "--mutations",
        str(options.mutations),
        str(file),
    ]
    try:
        result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=options.limit)
    except subprocess.TimeoutExpired:
        return {"file": str(file), "error": f"no answer within {options.limit:g} s", "kind": "limit"}
    if result.returncode != 0:
        return {"file": str(file), "error": result.stderr[-300:], "kind": "fault"}
    document: dict[str, Any] = json.loads(result.stdout)
    return document


def one(file: Path, mutations: int) -> dict[str, Any]:
    """Audit one file, and make mistakes in its consistent links."""
    began = time.process_time()
    try:
        result = audit(file)
    except InertiaError as error:
        return {"file": str(file), "error": str(error), "kind": "refused"}
    seconds = time.process_time() - began
    links = [
        {
            "name": link.name,
            "state": link.state,
            "codes": [finding.code for finding in link.findings],
            "sentences": [finding.sentence for finding in link.findings],
            "difference": None if link.difference is None else link.difference.inertia,
        }
        for link in result.links
    ]
    made = Counter(_mutated(result, mutations))
    return {
        "file": str(file),
        "format": result.robot.format,
        "verdict": result.verdict,
        "seconds": seconds,
        "links": links,
        "mutations": [[*key, count] for key, count in made.items()],
    }


def _mutated(result: Audit, count: int) -> Iterator[tuple[int, float, str, str]]:
    """Make mistakes in consistent links, and yield how many at once, the noise, their kinds, and what came of it."""
    rng = random.Random(str(result.robot.path.name))
    for link in result.links:
        if link.state != "consistent" or link.stated is None or link.findings:
            continue
        context = Context(Statement(link.stated, np.eye(3)), link.shapes)
        kinds: dict[str, list[Mistake]] = {}
        for kind in KINDS:
            for mistake in kind(context):
                kinds.setdefault(mistake.code, []).append(mistake)
        for noise in NOISE:
            stated = _noisy(context.truth.body, noise, rng)
            sound = Context(Statement(stated, np.eye(3)), link.shapes)
            yield 0, noise, "", "quiet" if sound.truth.residual <= EXPLAINED else "false alarm"
            for number in range(count):
                together = 1 + number % 2
                codes = rng.sample(sorted(kinds), together)
                mistakes = sorted((rng.choice(kinds[code]) for code in codes), key=lambda each: each.stage)
                body = _with(context, mistakes)
                if body is None:
                    continue
                search = explain(Context(Statement(_noisy(body, noise, rng), np.eye(3)), link.shapes))
                yield together, noise, " + ".join(sorted(codes)), _outcome(context, search, set(codes), body)


def _with(context: Context, mistakes: list[Mistake]) -> Body | None:
    """Return what is stated with mistakes; None where one of them makes no difference that could be seen."""
    truth = context.truth

    def claim(some: list[Mistake]) -> Claim:
        result = truth
        for mistake in some:
            result = mistake.make(result)
        return result

    body = claim(mistakes).body
    if not np.isfinite(body.inertia).all():
        return None
    for left_out in range(len(mistakes)):
        rest = claim(mistakes[:left_out] + mistakes[left_out + 1 :]).body
        if difference(context, rest, body) <= SEEN:
            return None
    return body if difference(context, truth.body, body) > SEEN else None


def _noisy(body: Body, noise: float, rng: random.Random) -> Body:
    def blurred(values: np.ndarray) -> np.ndarray:
        return values * (1 + noise * np.array([rng.uniform(-1, 1) for _ in range(values.size)]).reshape(values.shape))

    inertia = np.tril(blurred(body.inertia))
    return Body(body.mass, blurred(body.center), inertia + np.tril(inertia, -1).T)


def _outcome(context: Context, search: Search, codes: set[str], body: Body) -> str:
    if search.named is not None:
        same = search.named.codes == codes or difference(context, search.named.body, body) < 1e-6
        return "named" if same else "wrong"
    return "ambiguous" if search.candidates else "unexplained"


def page(results: list[dict[str, Any]], arguments: list[str]) -> str:
    """Return the page of what was found."""
    audited = [each for each in results if "links" in each]
    links = [link for each in audited for link in each["links"]]
    states = Counter(link["state"] for link in links)
    codes = Counter(code for link in links for code in dict.fromkeys(link["codes"]))
    failures = Counter(each["kind"] for each in results if "error" in each)
    made: Counter[tuple[int, float, str]] = Counter()
    for each in audited:
        for together, noise, _, outcome, count in each["mutations"]:
            made[together, noise, outcome] += count
    seconds = sorted(each["seconds"] / max(1, len(each["links"])) for each in audited)
    lines = [
        "# Robots audited",
        "",
        f"`python -m tests.benchmarks.robots`: {len(results)} files, {len(audited)} audited with {len(links)} links;"
        f" {failures['refused']} were refused",
        f"with a sentence, {failures['limit']} took too long, {failures['fault']} failed.",
        f"CPU time a link: median {np.median(seconds):.2g} s, 95 % within {np.quantile(seconds, 0.95):.2g} s.",
        "",
        "| State | links |",
        "|---|---:|",
        *(f"| {state} | {count} |" for state, count in states.most_common()),
        "",
        "| Finding | links |",
        "|---|---:|",
        *(f"| `{code}` | {count} |" for code, count in codes.most_common()),
        "",
        "## Mistakes made on purpose",
        "",
        "In links that are consistent, mistakes of every kind were made, alone and in pairs, and what is then stated",
        "was blurred by noise.",
        "",
        "| Mistakes | noise | made | named | ambiguous | unexplained | wrong |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    for together, label in ((1, "one"), (2, "two")):
        for noise in NOISE:
            counts = {name: made[together, noise, name] for name in ("named", "ambiguous", "unexplained", "wrong")}
            total = sum(counts.values())
            shares = " | ".join(f"{100 * count / max(total, 1):.1f} %" for count in counts.values())
            lines.append(f"| {label} | {100 * noise:g} % | {total} | {shares} |")
    quiet = sum(made[0, noise, "quiet"] for noise in NOISE)
    alarms = sum(made[0, noise, "false alarm"] for noise in NOISE)
    lines += ["", f"Without a mistake: {quiet + alarms} statements, {alarms} false alarms.", ""]
    return "\n".join(lines)


if __name__ == "__main__":
    main()
