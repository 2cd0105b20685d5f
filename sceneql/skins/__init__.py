"""Elastic skins full of fluid, that a flow carries."""
