"""Units, operations, expressions, diagnostics."""
