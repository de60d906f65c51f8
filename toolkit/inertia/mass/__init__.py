"""Part → mass properties: moments with error bounds, Steiner's theorem, principal axes."""
