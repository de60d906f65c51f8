"""A balance as text, JSON, CSV and HTML."""
