"""Skins that touch objects, one another, themselves."""
