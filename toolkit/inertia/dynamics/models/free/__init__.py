"""Free rotation in closed form: one body or a million."""
