# mypy: ignore-errors
"""f at the nodes of a block."""

from sceneql.compiled.kernels import inlined
from sceneql.field.tape.batch_kernels import LANES, along_z, evaluate
from sceneql.mesh.cubes.grid import BLOCK

NODES = BLOCK + 1
"""Nodes along a block; those on its high sides are shared with its neighbors."""
LAYERS = NODES // -(-NODES // (LANES // NODES**2))
"""Layers of nodes that are sampled at once: equal shares of NODES, as many as LANES have room for."""


@inlined
def sample(code, constants, parts, registers, rest, points, grid, i, j, k, values):
    """f at the nodes of the block whose first node is (i, j, k), x fastest; ``rest`` (rows, 4) is room for a tape.

    Layers are sampled LAYERS at a time; rows of the tape that do not depend on z are evaluated for the first ones only.
    """
    h = grid[3]
    last = code.shape[0] - 1
    n = LAYERS * NODES * NODES
    along_z(code, rest)
    for lane in range(n):
        points[0, lane] = grid[0] + (i + lane % NODES) * h
        points[1, lane] = grid[1] + (j + lane // NODES % NODES) * h
    for z in range(0, NODES, LAYERS):
        for lane in range(n):
            points[2, lane] = grid[2] + (k + z + lane // NODES**2) * h
        evaluate(code if z == 0 else rest[: code.shape[0]], constants, parts, registers, points, n)
        for lane in range(n):
            values[z * NODES**2 + lane] = registers[last, lane]
