"""An island under construction: its state, numbers, terms and values in time, and its Jacobian."""
