"""Moments of true shapes: solids bounded by trimmed faces, by the divergence theorem on their own surfaces."""
