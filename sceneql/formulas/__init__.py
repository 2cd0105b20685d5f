"""Formulas of scripts: rows of numbers, generated code."""
