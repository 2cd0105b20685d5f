"""Linear systems and Newton's method of implicit steps."""
