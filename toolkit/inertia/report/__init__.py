"""Analyses, findings, balances and runs as text and JSON; balances also as CSV and HTML, with pictures in SVG."""
