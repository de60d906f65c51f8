"""Attitude error against CPU time, ours beside its peers: ``python -m tests.benchmarks.motion``."""
