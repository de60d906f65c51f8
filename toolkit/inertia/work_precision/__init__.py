"""Measures what accuracy costs on one part or scene: time against error for every method, and a recommendation."""
