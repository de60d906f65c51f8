"""The models that follow a body: which of them a scene needs, and how each solves it."""
