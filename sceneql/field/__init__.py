"""Implicit fields: tapes, bounds, first roots along rays."""
