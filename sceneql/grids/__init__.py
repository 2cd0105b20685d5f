"""Fields on grids: diffusion, drift, reactions, implicit stages."""
