"""What can be wrong with a mesh, and where."""
