"""Skins of tensions solved for."""
