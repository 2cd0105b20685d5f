"""Layout of the arrays of a bundle: rays, search intervals and results; see ``packet_roots_kernels``."""

SETTLED = 1e-6
"""Change of a root at the last step of its polish, relative to the length of its search, above which the certified
routine takes over."""
RAY = 8
"""Rows of rays: origin, direction, begin and end."""
FOUND_STATUS, FOUND_LOW, FOUND_HIGH, FOUND_ROOT, FOUND_SLOPE = range(5)
"""Rows of results, by ray; places count from the ray's own begin."""
START, WAY_OF, NEAR, RUN, FAR, SURE, LONG = 0, 3, 6, 7, 8, 9, 10
ASK = 11
"""Rows of search intervals, by ray, places counted from its own begin: that begin (3), direction (3), begin of the
search, end of the first segment, end of the search, 1 where the end is known to be inside; length of the ray."""
LANE_ROWS = 18
"""Rows of the lanes in which rays are searched: see ``search_lanes_kernels``."""
