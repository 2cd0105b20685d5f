"""Rays against what a frame holds."""
