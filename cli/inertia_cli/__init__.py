"""The command `inertia`: parse the options, call one library function, render its result."""
