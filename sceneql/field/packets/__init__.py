"""First roots along packets of neighboring rays, in lanes."""
