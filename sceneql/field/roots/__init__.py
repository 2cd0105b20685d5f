"""First roots, certified, ray by ray."""
