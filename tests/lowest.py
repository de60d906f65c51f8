"""The lowest versions of other packages that the project admits, and whether every command works with them.

``python tests/lowest.py`` prints them as constraints for pip; ``... use``, in an environment that has them, runs the
commands, each of which must end without a fault and with the exit code that it has with the newest versions.
"""

import re
import subprocess
import sys
import tomllib
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parent.parent
EXTRAS = ("plot", "parquet")

COMMANDS = [
    (0, "analyse cube.stl"),
    (4, "analyse broken/missing_face.stl"),
    (0, "analyse broken/missing_face.stl --repair"),
    (4, "check broken/missing_face.stl"),
    (0, "analyse two_region_bar.vtk --unit mm"),
    (4, "batch cube.stl broken/missing_face.stl -o OUT.parquet --strict"),
    (4, "balance two_disc_rotor.stl"),
    (0, "balance rotors/two_disc_rotor.toml --report OUT.html --cut-part OUT.stl"),
    (0, "trade t_handle.stl --plot OUT.svg"),
    (0, "simulate scenes/t_handle.toml -o OUT.rrd --plot OUT.svg"),
    (0, "completion fish"),
]


def lowest() -> list[str]:
    """Return a constraint for each requirement of the project and of `EXTRAS`: its lowest version."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    asked = [*project["dependencies"], *(each for extra in EXTRAS for each in project["optional-dependencies"][extra])]
    return ["{}=={}".format(*re.fullmatch(r"([\w-]+)>=([\w.]+)(?:,.*)?", each).groups()) for each in asked]  # type: ignore[union-attr]


def use() -> int:
    """Run the commands on samples of the installed package; return how many ended otherwise than they should."""
    from inertia_meshes import path

    samples, faults = path("cube.stl").parent, 0
    with TemporaryDirectory() as folder:
        for number, (code, line) in enumerate(COMMANDS):
            words = [word.replace("OUT", f"{folder}/{number}") for word in line.split()]
            words = [str(samples / word) if (samples / word).is_file() else word for word in words]
            done = subprocess.run(
                [sys.executable, "-m", "inertia", *words], capture_output=True, text=True, check=False
            )
            print(f"{done.returncode} {line}")
            if done.returncode != code or "fault of this program" in done.stdout + done.stderr:
                faults += 1
                print(f"  and {code} is right, without a fault: {done.stdout}{done.stderr}")
    return faults


if __name__ == "__main__":
    if sys.argv[1:] == ["use"]:
        sys.exit(min(use(), 1))
    print("\n".join(lowest()))
