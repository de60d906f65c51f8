"""Mass properties and a scene in, a run out: the smallest model that the scene needs."""
