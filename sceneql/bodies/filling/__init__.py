"""Objects filled with masses, and with tetrahedra of masses."""
