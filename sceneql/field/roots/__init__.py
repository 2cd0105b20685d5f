"""Certified first roots, one ray at a time."""
