"""Solids in a flow: what they leave of cells."""
