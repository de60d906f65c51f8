"""Runs as Rerun recordings: what is shown, how it is arranged, and files that appear whole or not at all."""
