"""Rigid bodies: mass and inertia."""
