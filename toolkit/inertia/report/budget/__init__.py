"""`Budget` and `Assembly` → JSON, text and CSV."""
