"""The command `tumble`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inertia.errors import GeometryError, UsageError
from inertia.standard_input import NAME as STANDARD_INPUT
from inertia_cli.options import add_density, add_input, by_name, estimate, triple
from inertia_cli.simulate import FIELDS, add_result, add_settings, follow
from inertia_cli.wording import with_options

if TYPE_CHECKING:
    from inertia.dynamics.scene.body import SceneBody

_EXAMPLES = """examples:
  inertia tumble t_handle.stl --spin 0.001,10,0 --for 60
  inertia tumble part.stl --unit in --spin 0,0,25 --for 2 --json
  inertia tumble sheet.obj --shell 1.5 --material steel --spin 0,3,1 --for 20
  inertia tumble part.stl --spin 0,3,1 --for 20 -o run.rrd && inertia play run.rrd
"""


def add(parsers: Any) -> None:
    """Add ``inertia tumble``."""
    parser = parsers.add_parser(
        "tumble",
        help="let a part spin freely, and follow it",
        description="Let a part spin with no torque on it, and follow its attitude.",
        epilog=_EXAMPLES,
    )
    parser.set_defaults(run=run)
    add_input(parser)
    add_density(parser)
    model = parser.add_argument_group("what carries the mass")
    model.add_argument("--shell", type=estimate, metavar="THICKNESS", help="the surface, which may be open, in --unit")
    model.add_argument(
        "--wire", type=estimate, metavar="AREA", help="the lines of the mesh, cross-section in --unit squared"
    )
    motion = parser.add_argument_group("run")
    motion.add_argument(
        "--spin", type=triple, required=True, metavar="X,Y,Z", help="rad/s along the principal axes, moments ascending"
    )
    motion.add_argument(
        "--for", dest="duration", type=float, required=True, metavar="SECONDS", help="how long to follow the part"
    )
    add_settings(motion)
    add_result(parser)


def run(options: argparse.Namespace) -> int:
    """Run ``inertia tumble``."""
    from inertia.dynamics.scene.body import is_assembly, of_tree
    from inertia.dynamics.scene.document import Scene
    from inertia.dynamics.scene.sections import Settings, Start

    body = of_tree(Path(options.part)) if is_assembly(options.part) else _integrated(options)
    try:
        start, settings = Start(options.spin), Settings(options.duration)
        return follow(Scene(body, start, settings, text=_text(options), name=options.part), options)
    except (UsageError, GeometryError) as error:
        raise with_options(error, FIELDS) from None


def _integrated(options: argparse.Namespace) -> SceneBody:
    from inertia.dynamics.scene.body import SceneBody, accuracy_for
    from inertia.mass.analyse import analyse, sound_solids_only
    from inertia.mesh.read import read

    limit = {} if options.unpack_limit is None else {"unpack_limit": options.unpack_limit}
    part = read(options.part, options.unit, format=options.format, **limit)
    density, material = by_name("density", options.density), by_name("material", options.material)
    with sound_solids_only("tumbling takes a sound solid, or a surface by its thickness", but=("shell", "wire")):
        analysis = analyse(
            part,
            density,
            material=material,
            mass=options.mass,
            shell=options.shell,
            wire=options.wire,
            accuracy=accuracy_for(part, solid=options.shell is None and options.wire is None),
        )
    return SceneBody.of_analysis(analysis)


def _text(options: argparse.Namespace) -> str | None:
    """Return the scene file that says the same as the options; None where no scene file can."""
    from inertia.documents import toml_text

    density, material = dict(options.density), dict(options.material)
    if options.part == STANDARD_INPUT or options.format is not None or any(name for name in (*density, *material)):
        return None
    body = {
        "part": Path(options.part).name,
        "unit": options.unit,
        "density": density.get(""),
        "material": material.get(""),
        "mass": options.mass,
        "shell": options.shell,
        "wire": options.wire,
    }
    start = {"angular_velocity": options.spin, "frame": "principal"}
    return toml_text({"schema": 1, "body": body, "start": start, "run": {"duration": options.duration}})
