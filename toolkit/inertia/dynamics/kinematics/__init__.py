"""Attitudes, momenta and the geometry of free rotation; no motion is followed here."""
