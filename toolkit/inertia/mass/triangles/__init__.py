"""Moments of the volume inside triangles, in four arithmetics, with bounds."""
