"""`Audit` → text, JSON and HTML."""
