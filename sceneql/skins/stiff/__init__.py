"""Skins whose tensions are solved for."""
