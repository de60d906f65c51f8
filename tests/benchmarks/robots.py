"""Audit every robot below some folders, make mistakes on purpose with their meshes, and write docs/robots.md.

pip download --no-deps -d wheels pybullet gymnasium-robotics robosuite dm_control example-robot-data icub-models \\
    mani-skill metaworld drake gym-aloha gym-hil dm-robotics-panda myosuite
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
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from inertia.auditing.audit import audit
from inertia.auditing.judge import LinkAudit
from inertia.errors import InertiaError

from .measure import ROOT
from .mistakes import NOISE, tried

KINDS_OF_FILES = ("*.urdf", "*.xml", "*.sdf", "*.usda")
MARKS = (b"<robot", b"<mujoco>", b"<mujoco ", b"<sdf", b"#usda")  # not <mujocoinclude>, a piece of a model
BY_HAND = "## Examined by hand"
"""Heading of the page's section that stays when the page is written again."""
MOST_SHAPES, MOST_TRIANGLES = 30, 5_000
"""Of a link that mistakes are made with."""
OUTCOMES = ("named", "same", "ambiguous", "unexplained", "unphysical", "consistent", "wrong")


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.robots", description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--limit", type=float, default=300.0, help="seconds a file")
    parser.add_argument("--alike", type=int, default=60, help="files of one folder that are audited, at most")
    parser.add_argument("--mutations", type=int, default=4, help="mistakes made a link and noise")
    parser.add_argument("--into", type=Path, default=ROOT / "docs" / "robots.md")
    parser.add_argument("--results", type=Path, help="write what each file gave to this JSON file")
    parser.add_argument("--merge", action="store_true", help="the arguments are such files: write the page of them")
    parser.add_argument("--one", action="store_true", help="audit one file and print the result as JSON")
    options = parser.parse_args()
    if options.one:
        print(json.dumps(one(options.folders[0], options.mutations)))
        return
    if options.merge:
        results = [each for file in options.folders for each in json.loads(file.read_text(encoding="utf-8"))]
    else:
        files = sorted(_files(options.folders, options.alike))
        with ThreadPoolExecutor(options.jobs) as pool:
            results = list(pool.map(lambda file: _apart(file, options), files))
    if options.results is not None:
        options.results.write_text(json.dumps(results), encoding="utf-8")
    before = options.into.read_text(encoding="utf-8") if options.into.exists() else ""
    text = page(results) + before[before.find(BY_HAND) :] * (BY_HAND in before)
    options.into.write_text(text, encoding="utf-8")
    print(text)


def _files(folders: list[Path], alike: int) -> Iterator[Path]:
    """Yield the robots below some folders; of folders with many alike, a fixed choice."""
    by_folder: dict[Path, list[Path]] = {}
    for folder in folders:
        for pattern in KINDS_OF_FILES:
            for file in sorted(folder.rglob(pattern)):
                with file.open("rb") as opened:
                    beginning = opened.read(65_536)
                if any(mark in beginning for mark in MARKS):
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
    return {
        "file": str(file),
        "format": result.robot.format,
        "verdict": result.verdict,
        "seconds": seconds,
        "links": links,
        "made": [row for link in result.links for row in _made(link, f"{file.name} {link.name}", mutations)],
    }


def _made(link: LinkAudit, seed: str, mutations: int) -> Iterator[dict[str, Any]]:
    """Make mistakes with the meshes of a link that are closed, and of no great number or size."""
    shapes = link.shapes
    if not (mutations and shapes and link.room == 0 and len(shapes) <= MOST_SHAPES):
        return
    if sum(len(shape.corners) for shape in shapes) > MOST_TRIANGLES:
        return
    meshes = sha256(b"".join(shape.corners.round(9).tobytes() for shape in shapes)).hexdigest()
    for row in tried(shapes, mutations, random.Random(seed)):
        yield {**row, "meshes": meshes, "link": seed}


def page(results: list[dict[str, Any]]) -> str:
    """Return the page of what was found, but for what is written by hand."""
    audited = [each for each in results if "links" in each]
    links = [link for each in audited for link in each["links"]]
    states = Counter(link["state"] for link in links)
    codes = Counter(code for link in links for code in dict.fromkeys(link["codes"]))
    failures = Counter(each["kind"] for each in results if "error" in each)
    made = [row for each in audited for row in each["made"]]
    links_of: dict[str, str] = {}
    made = [row for row in made if links_of.setdefault(row["meshes"], row["link"]) == row["link"]]  # meshes once
    counts: Counter[tuple[int, float, str]] = Counter()
    for row in made:
        at_once = -1 if row["made"] == ["hollow"] else len(row["made"])
        counts[at_once, row["noise"], row["outcome"]] += 1
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
        f"Of {len(links_of)} links the closed meshes were taken, true mass properties of them stated, and mistakes",
        "made in these, alone and in pairs, by code that shares nothing with the search (`benchmarks/mistakes.py`);",
        "then every number was blurred by noise. *Same*: another mistake is named that leads to the same numbers",
        "within 0.5 % with this link, so that nobody could tell.",
        "",
        f"| Mistakes | noise | made | {' | '.join(OUTCOMES)} |",
        f"|---|---:|---:|{'---:|' * len(OUTCOMES)}",
    ]
    for at_once, label in ((1, "one"), (2, "two")):
        for noise in NOISE:
            some = [counts[at_once, noise, outcome] for outcome in OUTCOMES]
            shares = " | ".join(f"{100 * count / max(sum(some), 1):.1f} %" for count in some)
            lines.append(f"| {label} | {100 * noise:g} % | {sum(some)} | {shares} |")
    quiet, alarms = (sum(counts[0, noise, outcome] for noise in NOISE) for outcome in ("quiet", "false alarm"))
    lines += ["", f"Without a mistake: {quiet + alarms} statements, {alarms} false alarms.", ""]
    quiet, alarms = (sum(counts[-1, noise, outcome] for noise in NOISE) for outcome in ("quiet", "wrong"))
    lines += [
        f"With half of the mass moved into the skin and into two motors: {quiet + alarms} statements, in {alarms} of",
        "which a mistake is named that nobody made.",
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    main()
