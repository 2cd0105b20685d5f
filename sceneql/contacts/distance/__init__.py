"""Gaps and contacts of convex bodies.

A shape is three integers: its kind, and the offsets of its numbers and of its integers (`core_kernels`). A place is
seven numbers: the center of the body [m] and the quaternion [w, x, y, z] that turns its axes to the world's. Kernels
take working memory from the caller, one for each thread, and keep nothing in it from call to call. `nearest` in
`gap_kernels` says which kernel two kinds need.
"""
