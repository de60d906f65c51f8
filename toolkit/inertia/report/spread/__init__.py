"""`Ensemble` → text and JSON."""
