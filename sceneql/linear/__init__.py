"""Linear systems, Newton's method of implicit steps."""
