"""Plots of runs, by matplotlib, as drawings in the plane: 3-D views are projected here, so that any axes will do."""
