"""Sparse systems: orders, plans, fronts."""
