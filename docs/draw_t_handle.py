"""Draw docs/t_handle.svg: the T-handle with its principal axes. Run it with `python docs/draw_t_handle.py`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import inertia
from inertia_meshes import path

SCALE, WIDTH, HEIGHT = 8.0, 840, 440
LIGHT = np.array([0.35, -0.55, 0.76])
COLORS = ("#c0392b", "#1e8449", "#2456a6")


def view() -> np.ndarray:
    """Return the rotation to screen axes (right, up, towards the viewer)."""
    turn, tilt = np.radians(-32.0), np.radians(24.0)
    toward = np.array([np.sin(turn) * np.cos(tilt), -np.cos(turn) * np.cos(tilt), np.sin(tilt)])
    right = np.array([np.cos(turn), np.sin(turn), 0.0])
    return np.array([right, np.cross(toward, right), toward])


def main() -> None:
    """Write the picture."""
    analysis = inertia.analyse(inertia.read(path("t_handle.stl")), material="steel")
    corners, screen = analysis.part.triangles.corners(), view()
    center = analysis.properties.center_of_mass * 1000.0

    def project(points: np.ndarray) -> np.ndarray:
        flat = (points - center) @ screen.T * SCALE
        return np.stack([0.45 * WIDTH + flat[..., 0], 0.5 * HEIGHT - flat[..., 1]], axis=-1)

    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    facing = np.flatnonzero(normals @ screen[2] > 0)
    depth = corners[facing].mean(axis=1) @ screen[2]
    shapes = []
    for face in facing[np.argsort(depth)]:
        shade = round(120 + 110 * max(0.0, float(normals[face] @ LIGHT)))
        color = f"rgb({shade},{shade},{min(255, shade + 12)})"
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in project(corners[face]))
        shapes.append(f'<polygon points="{points}" fill="{color}" stroke="{color}" stroke-width=".4"/>')
    for k, reach in enumerate((38.0, 22.0, 24.0)):
        axis = analysis.principal.axes[:, k]
        seen = screen @ axis
        axis = axis * np.sign(seen[np.abs(seen).argmax()])  # the end that faces right, up or the viewer
        (x0, y0), (x1, y1) = project(np.array([center, center + reach * axis]))
        moment = analysis.principal.moments[k]
        shapes.append(
            f'<line x1="{x0:.1f}" y1="{y0:.1f}" x2="{x1:.1f}" y2="{y1:.1f}" stroke="{COLORS[k]}" stroke-width="3" '
            f'marker-end="url(#tip{k})"/>'
            f'<text x="{x1 + 10:.1f}" y="{y1 - 10:.1f}" fill="{COLORS[k]}">I{k + 1} = {moment:.4g} kg m²</text>'
        )
    tips = "".join(
        f'<marker id="tip{k}" markerWidth="7" markerHeight="7" refX="1" refY="3" orient="auto">'
        f'<path d="M0,0 L7,3 L0,6 z" fill="{color}"/></marker>'
        for k, color in enumerate(COLORS)
    )
    x, y = project(center)
    shapes.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="#f4b400" stroke="#222"/>')
    text = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" '
        f'font-size="17"><rect width="100%" height="100%" fill="white"/><defs>{tips}</defs>{"".join(shapes)}</svg>\n'
    )
    Path(__file__).with_name("t_handle.svg").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
