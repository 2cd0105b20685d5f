"""Whether surfaces cross, each pair of an edge and a triangle tried."""

import numpy as np


def crossings(places, triangles):
    """How many edges pass through triangles, each pair tried."""
    found = 0
    a, b, c = (places[triangles[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    for i, j in np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0):
        p, q = places[i], places[j]
        first, last = (np.einsum("ij,ij->i", end - a, across) for end in (p, q))
        k = np.flatnonzero((first * last < 0) & ~((triangles == i) | (triangles == j)).any(axis=1))
        hit = p + (first[k] / (first[k] - last[k]))[:, None] * (q - p)
        sides = [
            np.einsum("ij,ij->i", np.cross(v[k] - u[k], hit - u[k]), across[k]) for u, v in ((a, b), (b, c), (c, a))
        ]
        found += int(((sides[0] > 0) & (sides[1] > 0) & (sides[2] > 0)).sum())
    return found
