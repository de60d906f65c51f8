"""Euler's equations with any loads, step by step."""
