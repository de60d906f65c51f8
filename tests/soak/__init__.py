"""Campaigns that try to crash `inertia`, by seed and case: ``python -m tests.soak``."""
