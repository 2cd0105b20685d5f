"""An island's state, numbers, terms, breakpoints, Jacobian."""
