"""Tapes of every operation, random tapes, and random rays, for property tests of fields."""

import numpy as np
from hypothesis import strategies as st

from sceneql.field.skeleton.skeleton import KERNELS, Skeleton
from sceneql.field.tape.builder import TapeBuilder
from sceneql.field.tape.lowered_operations import LOWERED
from sceneql.field.tape.tape_ops import (
    BINARY,
    UNARY,
)
from sceneql.field.tape.tape_solid import scratch

NAMES = sorted([*UNARY, *BINARY, "density", "skeleton", *LOWERED])
ARGUMENTS = dict.fromkeys(UNARY, 1) | dict.fromkeys(BINARY, 2)
TWO = ("mod", "hypot", "gt", "lt", "ge", "le", "eq", "step")
THREE = ("clamp", "mix", "smoothstep", "where", "density", "skeleton")
ARGUMENTS |= dict.fromkeys(LOWERED, 1) | dict.fromkeys(TWO, 2) | dict.fromkeys(THREE, 3)
JUMPS = ("floor", "sign", "ceil", "mod", "round", "step", "where", "gt", "lt", "ge", "le", "eq")
NUMBERS = st.floats(-3.0, 3.0).map(lambda number: round(number, 3) + 0.0)
COORDINATES = st.floats(-2.0, 2.0).map(lambda number: round(number, 6) + 0.0)
PARTS = np.array(
    [[0.2, 0.1, 0.0, 0.2, 0.1, 0.0, 0.9, 1.0], [-0.5, 0, 0.3, 0.6, 0.4, -0.3, 0.5, 0.7], [0, 0, 1, 0, 1, 1, 1.5, -0.5]]
)


MIXED = Skeleton(
    np.array(
        [
            [[0.2, 0.1, 0.0], [0.2, 0.1, 0.0], [0.2, 0.1, 0.0]],
            [[-0.5, 0.0, 0.3], [0.6, 0.4, -0.3], [-0.5, 0.0, 0.3]],
            [[0.6, 0.4, -0.3], [1.0, -0.2, 0.2], [0.6, 0.4, -0.3]],
            [[-0.8, -0.6, 0.1], [-0.3, 0.2, 0.6], [0.2, -0.7, 0.0]],
            [[0.0, 1.0, 0.4], [1.0, 0.2, 0.8], [0.3, 0.1, 1.2]],
        ]
    ),
    np.array([[0.7, 0.7], [0.5, 0.9], [0.9, 0.4], [0.6, 0.6], [0.8, 0.3]]),
    np.array([1.0, 0.7, 0.7, -0.5, 0.9]),
    np.array([0.0, 1.0, 1.0, 2.0, 3.0]),
    KERNELS.index("metaball"),
    np.array([np.nan, np.nan, np.nan, np.nan, 0.5]),
)
"""A point, two cones that follow each other, a triangle and a curve."""


def operation(builder, name, chosen):
    """The register of a named operation."""
    if name == "density":
        return builder.density(PARTS, *chosen)
    return builder.skeleton(MIXED, *chosen) if name == "skeleton" else builder.op(name, *chosen)


def arguments(tape):
    return tape.code, tape.constants, tape.parts, scratch(tape)


@st.composite
def tapes(draw, most=8, names=tuple(NAMES)):
    """A random tape in which every operation may meet every other."""
    builder = TapeBuilder()
    registers = [builder.x, builder.y, builder.z, builder.constant(draw(NUMBERS)), builder.constant(draw(NUMBERS))]
    for _ in range(draw(st.integers(1, most))):
        name = draw(st.sampled_from(names))
        chosen = [draw(st.sampled_from(registers)) for _ in range(ARGUMENTS[name])]
        registers.append(operation(builder, name, chosen))
    return builder.finish(registers[-1])


@st.composite
def rays(draw):
    origin = [draw(COORDINATES) for _ in range(3)]
    direction = [draw(COORDINATES) for _ in range(3)]
    start = draw(COORDINATES)
    return (
        np.array(origin),
        np.array(direction),
        start,
        start + draw(st.sampled_from([0.0, 1e-9, 1e-4, 0.01, 0.3, 1.0, 4.0])),
    )


def of_one(name):
    """A tape of one operation, on arguments that move unequally."""
    builder = TapeBuilder()
    chosen = [builder.x, builder.y, builder.z][: ARGUMENTS[name]]
    return builder.finish(operation(builder, name, chosen))


SMOOTH = ("add", "sub", "mul", "square", "sin", "cos", "density", "min", "max", "abs", "neg")
