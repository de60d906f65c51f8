"""The smallest model that a scene needs, and how it is called."""
