"""Wheels that mesh."""
