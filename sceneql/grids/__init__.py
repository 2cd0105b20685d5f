"""Fields on regular grids: domains and their cells, the diffusion operator, and solvers of its linear systems."""
