"""What tessellation, the true shape's integration and OpenCASCADE's own are off by, and how long they take."""
