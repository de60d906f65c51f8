"""Topology and exact geometry of triangles."""
