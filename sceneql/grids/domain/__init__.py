"""Domains cut into cells."""
