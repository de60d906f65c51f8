"""One module for each kind of motion that is shown."""
