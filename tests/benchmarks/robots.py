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
from inertia.auditing.bodies import Body, Shape, together
from inertia.auditing.claim import Claim, Context, Mistake, Statement, difference
from inertia.auditing.hypotheses import KINDS
from inertia.auditing.search import EXPLAINED, Search, explain
from inertia.errors import InertiaError

from .measure import ROOT

KINDS_OF_FILES = ("*.urdf", "*.xml", "*.sdf", "*.usda")
MARKS = (b"<robot", b"<mujoco", b"<sdf", b"#usda")
BY_HAND = "## Examined by hand"
"""Heading of the page's section that stays when the page is written again."""
NOISE = (0.0, 0.001, 0.01)
SEEN = 3 * EXPLAINED
"""A mistake that changes less cannot be told from noise at the tolerance, and is not made."""
GROSS = ((1.0, 1.0), (1e3, 1.0), (1e-3, 1.0), (1.0, 1e3), (1.0, 1 / 0.0254), (1.0, 1e-3))
"""Factors that the mass and the lengths of the meshes are wrong by; the first is none."""
PLAIN = 0.8
"""Share of the mistakes that are made where neither is wrong."""


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.robots", description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--limit", type=float, default=300.0, help="seconds a file")
    parser.add_argument("--alike", type=int, default=60, help="files of one folder that are audited, at most")
    parser.add_argument("--mutations", type=int, default=12, help="mistakes made a consistent link and noise")
    parser.add_argument("--into", type=Path, default=ROOT / "docs" / "robots.md")
    parser.add_argument("--results", type=Path, help="write what each file gave to this JSON file")
    parser.add_argument("--one", action="store_true", help="audit one file and print the result as JSON")
    options = parser.parse_args()
    if options.one:
        print(json.dumps(one(options.folders[0], options.mutations)))
        return
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
        variants = [_variant(context, mass, length) for mass, length in GROSS]
        for noise in NOISE:
            stated = _noisy(context.truth.body, noise, rng)
            sound = Context(Statement(stated, np.eye(3)), link.shapes)
            yield 0, noise, "", "quiet" if sound.truth.residual <= EXPLAINED else "false alarm"
            for number in range(count):
                at_once = 1 + number % 2
                about, mistakes = _made(variants[0] if rng.random() < PLAIN else rng.choice(variants), at_once, rng)
                body = _with(about, mistakes)
                if body is None:
                    continue
                codes = {mistake.code for mistake in mistakes}
                search = explain(Context(Statement(_noisy(body, noise, rng), np.eye(3)), about.shapes))
                yield at_once, noise, " + ".join(sorted(codes)), _outcome(about, search, codes, body)
            body = _noisy(_hollow(context, rng), noise, rng)
            hollow = Context(Statement(body, np.eye(3)), link.shapes)
            if hollow.truth.residual > EXPLAINED:
                yield -1, noise, "", "wrong" if explain(hollow).named else "quiet"


def _variant(context: Context, mass: float, length: float) -> Context:
    """Return what a claim is made about whose mass or meshes are wrong by a factor."""
    body = context.stated.body
    shapes = [
        Shape(
            shape.name,
            shape.corners * length,
            Body(shape.solid.mass * length**3, shape.solid.center * length, shape.solid.inertia * length**5),
            shape.rotation,
            shape.origin * length,
        )
        for shape in context.shapes
    ]
    return Context(Statement(body._replace(mass=body.mass * mass), context.stated.rotation), shapes)


def _made(context: Context, count: int, rng: random.Random) -> tuple[Context, list[Mistake]]:
    """Choose mistakes of different kinds; in a variant, what made it one is among them."""
    kinds: dict[str, list[Mistake]] = {}
    gross = []
    for kind in KINDS:
        for mistake in kind(context):
            kinds.setdefault(mistake.code, []).append(mistake)
            if mistake.of_mesh or mistake.mass in (1e3, 1e-3):
                gross.append(mistake)
    codes = rng.sample(sorted(kinds), count)
    mistakes = [rng.choice(kinds[code]) for code in codes]
    if gross:
        mistakes[0] = rng.choice(gross)
        mistakes = mistakes[:1] + [each for each in mistakes[1:] if each.code != mistakes[0].code]
    return context, sorted(mistakes, key=lambda each: each.stage)


def _hollow(context: Context, rng: random.Random) -> Body:
    """Return what a link has whose mass is partly in its skin, partly in two motors near its corners."""
    truth = context.truth.body
    shell = together(shape.shell for shape in context.shapes)
    bodies = [truth.weighed(rng.uniform(0.2, 1)), shell.weighed(truth.mass / shell.mass * rng.uniform(0.1, 0.5))]
    corners = np.concatenate([shape.corners.reshape(-1, 3) for shape in context.shapes])
    for _ in range(2):
        place = np.mean([corners[rng.randrange(len(corners))] for _ in range(3)], axis=0)
        mass = truth.mass * rng.uniform(0.1, 0.6)
        bodies.append(Body(mass, place, mass * (0.05 * context.size) ** 2 * np.eye(3)))
    whole = together(bodies)
    return whole.weighed(truth.mass / whole.mass)


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
        alike = [search.named.codes, *(each.codes for each in search.named.alike)]
        same = codes in alike or difference(context, search.named.body, body) < 1e-6
        return "named" if same else "wrong"
    return "ambiguous" if search.candidates else "unexplained"


def page(results: list[dict[str, Any]]) -> str:
    """Return the page of what was found, but for what is written by hand."""
    audited = [each for each in results if "links" in each]
    links = [link for each in audited for link in each["links"]]
    states = Counter(link["state"] for link in links)
    codes = Counter(code for link in links for code in dict.fromkeys(link["codes"]))
    failures = Counter(each["kind"] for each in results if "error" in each)
    made: Counter[tuple[int, float, str]] = Counter()
    for each in audited:
        for at_once, noise, _, outcome, count in each["mutations"]:
            made[at_once, noise, outcome] += count
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
    for at_once, label in ((1, "one"), (2, "two")):
        for noise in NOISE:
            counts = {name: made[at_once, noise, name] for name in ("named", "ambiguous", "unexplained", "wrong")}
            total = sum(counts.values())
            shares = " | ".join(f"{100 * count / max(total, 1):.1f} %" for count in counts.values())
            lines.append(f"| {label} | {100 * noise:g} % | {total} | {shares} |")
    quiet = sum(made[0, noise, "quiet"] for noise in NOISE)
    alarms = sum(made[0, noise, "false alarm"] for noise in NOISE)
    lines += ["", f"Without a mistake: {quiet + alarms} statements, {alarms} false alarms.", ""]
    quiet = sum(made[-1, noise, "quiet"] for noise in NOISE)
    alarms = sum(made[-1, noise, "wrong"] for noise in NOISE)
    lines += [
        f"With half of the mass moved into the skin and into two motors: {quiet + alarms} statements, in {alarms} of",
        "which a mistake is named that nobody made.",
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    main()
