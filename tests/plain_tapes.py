"""Tapes of plain solids whose roots are known, and rays that look at them."""

import numpy as np

from sceneql.field.tape.builder import TapeBuilder


def implicit(formula):
    """The tape of a formula of a builder's own operations."""
    builder = TapeBuilder()
    return builder.finish(formula(builder, builder.op, builder.constant))


def sphere(radius):
    def formula(b, op, c):
        squares = [op("square", register) for register in (b.x, b.y, b.z)]
        return op("sub", op("add", op("add", squares[0], squares[1]), squares[2]), c(radius**2))

    return implicit(formula)


def kernels(centers, threshold, radius=1.0):
    parts = np.array([[*center, *center, radius, 1.0] for center in centers], dtype=float)
    return implicit(lambda b, op, c: op("sub", c(threshold), b.density(parts, b.x, b.y, b.z)))


def fan(count=200, spread=1.2, seed=5):
    """Rays from z = 6 that look at a square about the middle."""
    generator = np.random.default_rng(seed)
    origins = np.column_stack([generator.uniform(-spread, spread, (count, 2)), np.full(count, 6.0)])
    targets = np.column_stack([generator.uniform(-spread, spread, (count, 2)), np.zeros(count)])
    directions = targets - origins
    return origins, directions / np.linalg.norm(directions, axis=1)[:, None]
