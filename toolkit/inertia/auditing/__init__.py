"""Stated mass properties against those computed from the meshes, and the mistakes that explain a difference."""
