"""`Run` and `Plan` → text and JSON."""
