"""Skins nothing passes."""
