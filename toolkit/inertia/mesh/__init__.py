"""File → part: reading, checking and repairing meshes."""
