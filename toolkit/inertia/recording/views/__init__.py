"""One module for each kind of motion: its `screen` says what is logged and how the views are arranged."""
