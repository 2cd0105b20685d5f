"""Formulas as straight-line code."""
