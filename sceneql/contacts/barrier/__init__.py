"""Contact by a barrier: skins of solids that nothing passes (incremental potential contact, Li et al. 2020)."""
