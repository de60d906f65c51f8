"""`Analysis` → text and JSON."""
