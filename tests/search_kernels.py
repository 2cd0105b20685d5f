# mypy: ignore-errors
"""A way in to what only kernels call: the search for a ray's first root by enclosures alone."""

from sceneql.compiled.kernels import lean
from sceneql.field.roots.isolation_kernels import search
from sceneql.field.tape.tape_ops import TAPE


@lean(f"Tuple((int64, float64))({TAPE}, float64[::1], float64[::1], float64, float64, float64, boolean)")
def searched(code, constants, parts, scratch, origin, direction, t0, t1, tolerance, anywhere):
    """(status, t) of the first entry of the ray o + t d, t in [t0, t1], into {f < 0}."""
    return search(
        code, constants, parts, scratch, origin[0], origin[1], origin[2], direction[0], direction[1], direction[2],
        t0, t1, tolerance, 1.0, anywhere,
    )  # fmt: skip
