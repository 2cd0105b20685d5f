"""Rigid bodies, exact."""
