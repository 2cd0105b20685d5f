"""Units, operations and expressions, diagnostics."""
