"""The entry point of the command `inertia`."""
