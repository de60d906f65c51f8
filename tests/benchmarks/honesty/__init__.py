"""Whether the accuracy that a run of `inertia.simulate` states holds: random scenes against quadruple precision."""
