"""First roots along rays, certified, of tapes, polynomials and densities."""
