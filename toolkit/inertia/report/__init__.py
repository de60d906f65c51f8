"""Analyses and findings → text and JSON."""
