"""Masses on surfaces: impact, friction, rest."""
