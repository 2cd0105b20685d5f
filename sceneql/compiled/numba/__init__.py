"""How numba compiles kernels: its own pipeline, shortened."""
