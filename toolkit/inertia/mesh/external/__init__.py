"""Closure of surfaces that are larger than memory."""
