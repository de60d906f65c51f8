"""Where the shaft of a rotor runs."""
