"""Fields on grids: diffusion, drift, reactions."""
