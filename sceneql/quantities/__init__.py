"""Spans, diagnostics, units, the one table of operations and the typed expression tree. Standard library only."""
