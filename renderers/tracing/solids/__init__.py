"""Rays against a frame's shapes."""
