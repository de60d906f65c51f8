"""Draw docs/gallery/: every scene and rotor that is shipped, as its recording is shown, for docs/gallery.md.

    python docs/draw_gallery.py [NAME ...]     those named, else all; `flip` is the moving picture of the README

It needs a Vulkan driver; one in software (Debian: mesa-vulkan-drivers) takes some seconds a picture.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import inertia
from inertia_meshes import path

FOLDER = Path(__file__).with_name("gallery")
SIZE = 1120, 700
INSTANTS = {
    "scenes/t_handle.toml": 1.6,
    "scenes/thrown_box.toml": 0.45,
    "scenes/feynman_plate.toml": 0.22,
    "scenes/cube.toml": 2.0,
    "scenes/explorer_1.toml": 15.0,
    "scenes/detumbling.toml": 10.0,
    "scenes/flywheel.toml": 100.0,
    "scenes/manoeuvre.toml": 6.0,
    "scenes/gravity_gradient.toml": 700.0,
    "scenes/boom_satellite.toml": 3000.0,
    "scenes/pendulum.toml": 3.0,
    "scenes/tilted_disc.toml": 0.01,
    "scenes/heavy_top.toml": 2.0,
    "scenes/spinning_top.toml": 1.0,
    "scenes/sleeping_top.toml": 1.1,
    "scenes/kovalevskaya_top.toml": 3.0,
    "scenes/rolling_disc.toml": 2.5,
    "scenes/tippe_top.toml": 1.5,
    "scenes/skater.toml": 0.55,
    "scenes/diver.toml": 0.9,
    "scenes/cat.toml": 0.2,
    "rotors/disc.toml": 0.0,
    "rotors/two_disc_rotor.toml": 0.0,
    "rotors/bent_wheel.toml": 0.0,
    "rotors/shaft_impeller.toml": 0.0,
    "rotors/overhung_impeller.toml": 0.0,
    "rotors/pump_rotor.toml": 0.0,
}
"""When each is seen, s from the start."""
FLIP = {"at": 0.4, "view": "inertial", "size": (354, 304), "frames": 60, "fps": 10.0}


def recorded(file: str, recording: Path) -> None:
    """Run a scene, or balance a rotor, and record it."""
    if file.startswith("scenes/"):
        inertia.record(inertia.simulate(inertia.Scene.load(path(file))), recording, force=True)
    else:
        inertia.record(inertia.balance(inertia.Rotor.load(path(file))), recording, force=True)


def main(names: list[str]) -> None:
    """Draw the pictures of these names, all where there are none."""
    from PIL import Image

    FOLDER.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        recording, drawn = Path(folder) / "run.rrd", Path(folder) / "run.png"
        for file, instant in INSTANTS.items():
            name = Path(file).stem
            if not names or name in names:
                recorded(file, recording)
                inertia.export_picture(recording, drawn, at=instant, size=SIZE, force=True)
                few = Image.open(drawn).quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=1).convert("RGB")
                few.save(FOLDER / f"{name}.webp", lossless=True, method=6)
                print(name, flush=True)
        if not names or "flip" in names:
            recorded("scenes/t_handle.toml", recording)
            inertia.export_picture(recording, FOLDER / "flip.gif", **FLIP, force=True)


if __name__ == "__main__":
    main(sys.argv[1:])
