"""How numba compiles, shortened."""
