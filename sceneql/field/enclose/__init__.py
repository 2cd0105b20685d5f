"""Bounds over boxes and along rays."""
