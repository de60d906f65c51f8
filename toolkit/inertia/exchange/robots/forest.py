"""What each link hangs on, where a file says of joints which two links they join."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from inertia.errors import visible
from inertia.exchange.robots.links import Joint


def forest(
    joints: Iterable[tuple[str | None, Joint]], links: Iterable[str], roots: Iterable[str] = ()
) -> tuple[dict[str, Joint], list[Joint]]:
    """Return what each link hangs on, by names as they may be printed, and the joints that would close a loop.

    What is joined to the world hangs on it. Of other links that are joined one stands still: the first of those that
    are no joint's child and the most joints' parent, as Drake has it. Joints whose child is nearer to what stands
    still are turned round.

    Parameters
    ----------
    joints : each with its child, None for the world; of a loop the last is left out
    links : all names, in their order
    roots : those that stand still before others, where the world does not hold them
    """
    groups: dict[str | None, set[str | None]] = {}
    at: dict[str | None, list[tuple[str | None, Joint]]] = {}
    loops: list[Joint] = []
    parents: Counter[str | None] = Counter()
    children: set[str | None] = set()
    for name, joint in joints:
        child = name and visible(name)
        parents[joint.parent] += 1
        children.add(child)
        small, large = sorted((groups.setdefault(end, {end}) for end in (joint.parent, child)), key=len)
        if small is large:
            loops.append(joint)
            continue
        large |= small
        groups |= dict.fromkeys(small, large)
        for end in (joint.parent, child):
            at.setdefault(end, []).append((child, joint))
    others = sorted(map(visible, links), key=lambda link: (link in children, -parents[link]))
    hung: dict[str, Joint] = {}
    reached: set[str | None] = set()
    for root in (None, *map(visible, roots), *others):
        path = [root] if root not in reached else []
        while path:
            here = path.pop()
            reached.add(here)
            for child, joint in at.get(here, ()):
                onward, other = (joint, child) if child != here else (joint.turned_round(child), joint.parent)
                if other is not None and other not in reached:
                    hung[other] = onward
                    path.append(other)
    return hung, loops
