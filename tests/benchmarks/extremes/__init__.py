"""Accuracy at the extremes, beside other programs: ``python -m tests.benchmarks.extremes`` writes docs/extremes.md."""
