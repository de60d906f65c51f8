"""Trees of parts: one `MassProperties` with its certified bound, and the budget of what each part contributes."""
