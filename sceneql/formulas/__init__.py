"""Formulas of scripts as generated code, as rows."""
