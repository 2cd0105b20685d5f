"""How rays, what is asked of them and what is found lie in the arrays of a bundle: see ``packet_roots_kernels``."""

SETTLED = 1e-6
"""Change of a root, relative to the length of its search, at the last step of its polish, beyond which it is sought
anew by the certified routine."""
RAY = 8
"""Rows of rays: origin, direction, begin and end."""
FOUND_STATUS, FOUND_LOW, FOUND_HIGH, FOUND_ROOT, FOUND_SLOPE = range(5)
"""Rows of what is found, by ray; places from the ray's own start."""
START, WAY_OF, NEAR, RUN, FAR, SURE, LONG = 0, 3, 6, 7, 8, 9, 10
ASK = 11
"""Rows of what is asked, by ray, places counted from its own start: that start (3), direction (3), where to begin,
where the first segment ends, where to end, 1 where the end is known to be inside; the length of the ray."""
LANE_ROWS = 18
"""Rows of lanes that rays are hunted in: see ``search_lanes_kernels``."""
