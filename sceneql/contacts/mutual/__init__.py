"""Masses against one another."""
