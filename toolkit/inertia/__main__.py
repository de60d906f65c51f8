"""``python -m inertia``: the command, where its script is not on the path."""

from runpy import run_module

run_module("inertia_cli", run_name="__main__", alter_sys=True)
