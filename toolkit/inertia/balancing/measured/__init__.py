"""Balancing from readings of a machine: influence coefficients, trial weights, indexing."""
