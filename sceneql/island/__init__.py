"""State, numbers, terms, breakpoints, Jacobian."""
