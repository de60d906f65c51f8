"""Mending surfaces: each step, on plain arrays."""
