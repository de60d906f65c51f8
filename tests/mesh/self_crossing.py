"""Solids of one shell that crosses itself, with volumes in closed form, and their sound neighbours."""

import numpy as np

Mesh = tuple[np.ndarray, np.ndarray]


def sweep(sections: np.ndarray) -> Mesh:
    """Return the capped tube along sections (m, 4, 3), counter-clockwise seen along the way."""
    m = len(sections)
    a = np.arange(m - 1)[:, None] * 4 + np.arange(4)
    b = a - a % 4 + (a + 1) % 4
    walls = np.concatenate([np.stack([a, b, b + 4], -1), np.stack([a, b + 4, a + 4], -1)]).reshape(-1, 3)
    last = 4 * (m - 1)
    caps = [[0, 2, 1], [0, 3, 2], [last, last + 1, last + 2], [last, last + 2, last + 3]]
    return sections.reshape(-1, 3), np.concatenate([walls, caps])


def strip(path: list[tuple[float, float]], width: float, height: float) -> Mesh:
    """Return a bar along a path of axis-parallel steps, mitred; its volume is width × height × length."""
    points = np.array(path, float)
    steps = np.sign(np.diff(points, axis=0))
    before, after = np.vstack([steps[:1], steps]), np.vstack([steps, steps[-1:]])
    aside = np.column_stack([-before[:, 1], before[:, 0]]) + np.column_stack([-after[:, 1], after[:, 0]])
    aside[[0, -1]] /= 2
    left, right = points + width / 2 * aside, points - width / 2 * aside
    corners = [(right, 0.0), (right, height), (left, height), (left, 0.0)]
    return sweep(np.stack([np.column_stack([side, np.full(len(side), z)]) for side, z in corners], axis=1)[:, ::-1])


def hairpin(reach: float) -> Mesh:
    """Return a bent bar 1 wide and 2 high; from a reach of −0.5 on, its end goes through its beginning."""
    return strip([(0, 0), (10, 0), (10, 8), (5, 8), (5, 1 - reach)], 1.0, 2.0)


def ring(turn: float, segments: int = 17) -> Mesh:
    """Return an open ring of radius 5 and section 2 × 2 over an angle, of volume 20 sin(turn / segments) a segment."""
    angle = turn * np.arange(segments + 1) / segments
    out = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    corners = [(r, z) for r, z in ((4, -1), (6, -1), (6, 1), (4, 1))]
    return sweep(np.stack([r * out + [0, 0, z] for r, z in corners], axis=1)[:, ::-1])


def spring(pitch: float, turns: float = 2.5, segments: int = 40) -> Mesh:
    """Return a coil of radius 5 and section 2 × 2; its coils are apart where the pitch is above 2."""
    angle = 2 * np.pi * turns * np.arange(segments + 1) / segments
    out = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    rise = (pitch * angle / (2 * np.pi))[:, None] * [0, 0, 1]
    corners = [(4, -1), (6, -1), (6, 1), (4, 1)]
    return sweep(np.stack([r * out + rise + [0, 0, z] for r, z in corners], axis=1)[:, ::-1])


def pentagram(points: int = 5, step: int = 2) -> Mesh:
    """Return the prism, 1 high, over a star {points/step} of radius 1, of volume points · sin(2π step / points) / 2."""
    angle = 2 * np.pi * step * np.arange(points) / points
    outline = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    vertices = np.concatenate([outline, outline + np.array([0, 0, 1]), [[0, 0, 0], [0, 0, 1]]])
    a = np.arange(points)
    b, low, high = (a + 1) % points, 2 * points, 2 * points + 1
    faces = [
        np.stack([a, b, b + points], -1),
        np.stack([a, b + points, a + points], -1),
        np.stack([b, a, 0 * a + low], -1),
        np.stack([a + points, b + points, 0 * a + high], -1),
    ]
    return vertices, np.concatenate(faces)


CROSSING: dict[str, Mesh] = {
    "hairpin": hairpin(6.0),
    "hairpin whose end stays inside": hairpin(1.0),
    "ring with overlapping ends": ring(6.6),
    "spring with coils that overlap": spring(1.7),
    "pentagram": pentagram(),
    "heptagram": pentagram(7, 3),
}

SOUND: dict[str, Mesh] = {
    "hairpin short of touching": hairpin(-1.0),
    "hairpin a hair short of touching": hairpin(0.5 - 1e-12),
    "hairpin that touches": hairpin(0.5),
    "ring with a gap": ring(6.0),
    "ring with a gap of 1e-12": ring(2 * np.pi - 1e-12),
    "spring with coils apart": spring(2.5),
    "pentagon": pentagram(5, 1),
}
