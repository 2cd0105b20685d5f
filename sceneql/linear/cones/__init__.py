"""Friction as cone programs."""
