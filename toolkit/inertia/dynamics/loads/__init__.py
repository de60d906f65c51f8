"""Loads on a body: what pulls at it, as a section of a scene and as the torque that it makes."""
