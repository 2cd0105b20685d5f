"""Samples to pixels: edges, noise."""
