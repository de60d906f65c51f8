"""Volumes between surfaces, in columns along an axis."""
