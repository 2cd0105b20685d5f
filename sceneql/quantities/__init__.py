"""Units, typed expressions, diagnostics; no libraries."""
