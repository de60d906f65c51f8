"""Speed and memory of `inertia` beside its peers, in one run: ``python -m tests.benchmarks``."""
