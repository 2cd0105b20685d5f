"""Elastic laws: energy of strain, stress and stiffness."""
