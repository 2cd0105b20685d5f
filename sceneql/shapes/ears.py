"""A polygon as triangles, by cutting off ears (Meisters 1975)."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats


def ears(corners: Floats) -> NDArray[int64]:
    """(n - 2, 3) numbers of the corners (n, 3) of triangles that fill a simple, nearly flat polygon."""
    import numpy as np

    following = np.roll(corners, -1, axis=0)
    normal = np.cross(corners, following).sum(axis=0)  # Newell's: twice the area
    axis = int(np.argmax(np.abs(normal)))
    flat = np.delete(corners, axis, axis=1)
    if (normal[axis] < 0) != (axis == 1):
        flat = flat[:, ::-1]
    left, found = list(range(len(corners))), []
    while len(left) > 3:
        k = next((k for k in range(len(left)) if _is_ear(flat, left, k)), 0)
        found.append([left[k - 1], left[k], left[(k + 1) % len(left)]])
        del left[k]
    return np.array([*found, left])


def _is_ear(flat: Floats, left: list[int], k: int) -> bool:
    """Whether the triangle at corner k of the remaining polygon is inside: it turns left and holds no other corner."""
    a, b, c = (flat[left[(k + step) % len(left)]] for step in (-1, 0, 1))
    if _turn(a, b, c) <= 0:
        return False
    others = (flat[i] for i in left if i not in (left[k - 1], left[k], left[(k + 1) % len(left)]))
    return not any(min(_turn(a, b, p), _turn(b, c, p), _turn(c, a, p)) >= 0 for p in others)


def _turn(a: Floats, b: Floats, c: Floats) -> float:
    """Twice the signed area of a triangle in the plane."""
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
