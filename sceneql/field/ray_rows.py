"""How rays, what is asked of them and what is found lie in the arrays of a bundle: see ``packet_roots_kernels``."""

SETTLED = 1e-6
"""Change of a root, relative to the length of its search, at the last step of its polish, beyond which it is sought
anew by the certified routine."""
RAY = 8
"""Rows of rays: origin, direction, begin and end."""
FOUND_STATUS, FOUND_LOW, FOUND_HIGH, FOUND_ROOT, FOUND_SLOPE = range(5)
"""Rows of what is found, by ray; places from the ray's own start."""
NEAR, FAR, RUN, SURE = range(4)
"""Rows of what is asked, by ray: where to begin and to end, where the first segment ends, 1 where the end is known to
be inside."""
LANE_ROWS = 17
"""Rows of lanes that rays are hunted in: see ``hunt_kernels``."""
