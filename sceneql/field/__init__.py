"""The implicit-field engine: tapes, their evaluators, root isolation."""
