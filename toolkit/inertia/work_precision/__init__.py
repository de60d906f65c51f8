"""Measures on one part what accuracy costs: time against error, for every method and for simpler meshes."""
