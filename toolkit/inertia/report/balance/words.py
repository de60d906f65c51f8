"""Words that the text of a balance and its report have in common."""

TURNS = {"ccw": "counter-clockwise", "cw": "clockwise"}
"""The senses of rotation."""

KINDS = {
    "point_mass": "point mass",
    "drill_radial": "radial hole",
    "drill_axial": "axial hole",
    "mill_flat": "flat",
    "weight": "weight",
}
"""The kinds of operation."""
