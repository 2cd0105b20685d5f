"""Skins full of fluid, and masses, that a flow carries."""
