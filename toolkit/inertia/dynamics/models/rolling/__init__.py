"""Bodies of revolution that roll on their rim."""
