"""An island's state, numbers, terms, Jacobian."""
