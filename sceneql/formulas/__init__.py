"""Formulas of a script, of place, time or state, as rows of numbers or as generated programs."""
