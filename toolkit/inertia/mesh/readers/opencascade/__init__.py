"""What runs in the process that OpenCASCADE has for itself: STEP in, plain arrays out."""
