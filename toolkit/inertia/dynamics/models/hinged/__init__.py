"""A body on a fixed axle: its angle, and what the axle holds it with."""
