"""Masses and springs, their slopes; pins, tears, emitters."""
