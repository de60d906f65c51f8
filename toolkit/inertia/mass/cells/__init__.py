"""Moments of volume meshes by quadrature, with bounds."""
