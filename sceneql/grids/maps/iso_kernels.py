# mypy: ignore-errors
"""How the interpolant of a grid's values passes through each of its cubes."""

from sceneql.compiled.kernels import lean
from sceneql.mesh.cubes.decide_kernels import CASES, decide


@lean(f"void(float64[:, ::1], int32[::1], {CASES}, int32[::1])")
def variants(values, config, first, faces, tunnel, variant):
    """Write the variant (m,) of cubes with 8 corner values (m, 8) and a configuration (m,): mesh.cases."""
    for n in range(values.shape[0]):
        variant[n] = decide(values[n], config[n], first, faces, tunnel)
