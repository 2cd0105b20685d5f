"""Linear systems of fields on grids: multigrid, relaxation, transforms, factorization."""
