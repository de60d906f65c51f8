"""Mass properties → the text of another program's file, in that program's conventions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from types import MappingProxyType

from inertia.errors import UsageError, require_kind, visible
from inertia.exchange import abaqus, adams, csv, drake, mjcf, modelica, nastran, sdf, simscape, urdf, usd
from inertia.exchange.conventions import CONVENTIONS
from inertia.exchange.writing import Body
from inertia.mass.properties import MassProperties

WRITERS: Mapping[str, Callable[[Sequence[Body], Sequence[str]], str]] = MappingProxyType(
    {
        "urdf": urdf.write,
        "sdf": sdf.write,
        "mjcf": mjcf.write,
        "usd": usd.write,
        "modelica": modelica.write,
        "simscape": simscape.write,
        "nastran": nastran.write,
        "adams": adams.write,
        "abaqus": abaqus.write,
        "drake": drake.write,
        "csv": csv.write,
    }
)
"""The writer of each target that has one; the rows of `CONVENTIONS` beyond are to be looked up."""


def export(
    properties: MassProperties | Mapping[str, MassProperties],
    target: str,
    *,
    name: str = "part",
    comments: Sequence[str] = (),
) -> str:
    """Return mass properties as the text of a file of another program: `target` is "urdf", "mjcf", "nastran", …

    Signs, order, point, axes and units are the target's, and are said in comments with the certified bounds, where the
    format has comments. Numbers read back as the same float64, or the file says how far the format rounds them.

    Parameters
    ----------
    properties : of one body, in the axes of its part; or of several by their names, each in its own axes
    target : a name of `inertia.exchange.export.WRITERS`
    name : of the body; where the format takes letters and digits only, others become underscores
    comments : further lines for the comments

    Raises `UsageError` where nothing is written for such a target, or a number leaves what the format holds.

    >>> import inertia
    >>> ball = inertia.MassProperties(2.0, 1.0, [0, 0, 0.5], [[0.75, 0, 0], [0, 0.75, 0], [0, 0, 0.75]])
    >>> print("\\n".join(inertia.export(ball, "urdf", name="ball").splitlines()[-7:-2]))
        <inertial>
          <origin xyz="0.0 0.0 0.5" rpy="0 0 0"/>
          <mass value="2.0"/>
          <inertia ixx="0.75" ixy="0.0" ixz="0.0" iyy="0.75" iyz="0.0" izz="0.75"/>
        </inertial>
    """
    require_writer(target)
    bodies = properties if isinstance(properties, Mapping) else {name: properties}
    if not bodies:
        raise UsageError("there is nothing to write: give the mass properties of a body")
    for body_name, each in bodies.items():
        require_kind(each, MassProperties, "properties", "inertia.mass_properties(part)")
        if not isinstance(body_name, str) or not body_name.strip():
            raise UsageError(f"name is {body_name!r}: give a name that can be read")
    return WRITERS[target]([Body(visible(key), each) for key, each in bodies.items()], comments)


def require_writer(target: str) -> None:
    """Raise `UsageError` where nothing is written for a target: to be asked before work that takes a while."""
    if target in WRITERS:
        return
    known = ", ".join(WRITERS)
    if row := CONVENTIONS.get(target):
        raise UsageError(
            f"nothing is written for {target}; it takes {row.fields}, about {row.about}; written are {known}"
        )
    close = get_close_matches(str(target), WRITERS, 1)
    hint = f" (did you mean {close[0]!r}?)" if close else ""
    raise UsageError(f"{target!r} is no format that is written{hint}: choose one of {known}")
