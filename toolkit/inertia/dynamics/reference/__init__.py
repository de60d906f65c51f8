"""Motion to some thirty digits, whatever a scene holds: what the error of a run is measured against."""
