"""Many runs of one scene whose numbers are drawn or swept."""
