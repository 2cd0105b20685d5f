"""Objects made masses, tetrahedra."""
