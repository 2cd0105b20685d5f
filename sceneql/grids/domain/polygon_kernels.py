# mypy: ignore-errors
"""Distances from the sides of polygons, and inside or outside by the even-odd rule.

Sides (n, 4: first corner, second corner) stand ring by ring; runs of them that follow each other are groups, (g, 4:
low corner, high corner of the box around) with the sides firsts[k] to firsts[k + 1].
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import A, I, N

ROWS = types.float64[:, ::1]


@lean_inlined
def square(x, y, sides, s):
    """Squared distance of a point from a side."""
    ax, ay = sides[s, 0], sides[s, 1]
    ux, uy = sides[s, 2] - ax, sides[s, 3] - ay
    dx, dy = x - ax, y - ay
    along = min(1.0, max(0.0, (dx * ux + dy * uy) / (ux * ux + uy * uy)))
    dx, dy = dx - along * ux, dy - along * uy
    return dx * dx + dy * dy


@lean(types.void(ROWS, ROWS, ROWS, I, A, I, N, N))
def distances(points, sides, boxes, firsts, out, nearest, begin, end):
    """Signed distance of points (m, 3) from begin to end, below 0 inside, and the number of the nearest side."""
    for p in range(begin, end):
        x, y = points[p, 0], points[p, 1]
        # The side nearest to the point before gives a good bound.
        found = nearest[p - 1] if p > begin else 0
        best = square(x, y, sides, found)
        inside = False
        for g in range(boxes.shape[0]):
            low_x, low_y, high_x, high_y = boxes[g, 0], boxes[g, 1], boxes[g, 2], boxes[g, 3]
            first, last = firsts[g], firsts[g + 1]
            dx = max(0.0, max(low_x - x, x - high_x))
            dy = max(0.0, max(low_y - y, y - high_y))
            close = dx * dx + dy * dy <= best
            if close:
                for s in range(first, last):
                    away = square(x, y, sides, s)
                    if away < best or (away == best and s < found):
                        best, found = away, s
            if low_y <= y <= high_y and x <= high_x:
                if x < low_x:
                    # All of the group lies on the ray's side: its ends tell how often it crosses.
                    inside ^= (sides[first, 1] > y) != (sides[last - 1, 3] > y)
                else:
                    for s in range(first, last):
                        ay, by = sides[s, 1], sides[s, 3]
                        if (ay > y) != (by > y):
                            inside ^= x < sides[s, 0] + (y - ay) * (sides[s, 2] - sides[s, 0]) / (by - ay)
        out[p] = -math.sqrt(best) if inside else math.sqrt(best)
        nearest[p] = found
