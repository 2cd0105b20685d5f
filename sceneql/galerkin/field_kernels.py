# mypy: ignore-errors
"""The rate of a field on elements, before its mass is divided by: matrices, sources, boundaries that vary.

Points are places of integration rules; those of one element or side follow one another. Tables in ``floats`` and
lists in ``ints`` are row by row. What comes in through the boundary and from sources is added to the entry of the
inflow.
"""

import math

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM

AT, COUNT, INFLOW, VALUES, FIXED, CROSSING, FED, STARTS = range(8)
"""Integers of `balance`: first unknown in y, how many, the entry of the inflow; offsets in floats of the matrix's
values, of what is fed into each unknown, of what crosses the boundary by each unknown, of the fixed inflow; from
STARTS on the rows' starts (count + 1), then the columns."""
S_AT, S_ROWS, S_POINTS, S_NODES, S_SHAPES, S_REPEATS, S_TARGET, S_LIST = range(8)
"""Integers of `sample`: first unknown, elements or sides, points of each, nodes of each; functions (points, nodes) of
all, or of each (S_REPEATS 0); where the field goes; the nodes from S_LIST on."""
B_AT, B_INFLOW, B_ELEMENTS, B_POINTS, B_NODES, B_DIMENSION, B_SHAPES, B_GRADIENTS, B_WEIGHTS, B_CONDUCTS, B_MADE = (
    range(11)
)
B_SLOPE, B_BEND, B_LIST = 11, 12, 13
"""Integers of `bulk`: besides offsets of functions, their gradients (none are read where B_CONDUCTS is -1) and weights,
those of the coefficient and of the source at the points (-1: none), and of their derivatives by the field (-1)."""
G_AT, G_INFLOW, G_POINTS, G_NODES, G_WEIGHTS, G_VALUES, G_SLOPE, G_SHAPES, G_LIST = range(9)
"""Integers of `given`: points, nodes of each, weights (points, nodes) of the values there and of its derivative."""
H_AT, H_INFLOW, H_POINTS, H_NODES, H_SHAPES, H_NORMAL, H_WEIGHTS, H_FIRM, H_CONDUCTS, H_VALUES, H_SLOPE, H_BEND = range(
    12
)
H_LIST = 12
"""Integers of `held`: points on sides whose value is given, where the coefficient varies."""


@lean(TERM, inner=True)
def balance(t, y, rate, floats, ints):
    """Adds fed - A c: what flows into each unknown."""
    at, n, inflow = ints[AT], ints[COUNT], floats[ints[FED]]
    columns, values, fixed, crossing = STARTS + n + 1, ints[VALUES], ints[FIXED], ints[CROSSING]
    for i in range(n):
        total = floats[fixed + i]
        for k in range(ints[STARTS + i], ints[STARTS + i + 1]):
            total -= floats[values + k] * y[at + ints[columns + k]]
        rate[at + i] += total
        inflow -= floats[crossing + i] * y[at + i]
    rate[ints[INFLOW]] += inflow


@lean(TERM, inner=True)
def sample(t, y, rate, floats, ints):
    """The field at points."""
    points, nodes, each = ints[S_POINTS], ints[S_NODES], ints[S_REPEATS]
    for e in range(ints[S_ROWS]):
        own = S_LIST + nodes * e
        shapes = ints[S_SHAPES] + (0 if each == 1 else e * points * nodes)
        for q in range(points):
            total = 0.0
            for k in range(nodes):
                total += floats[shapes + nodes * q + k] * y[ints[S_AT] + ints[own + k]]
            floats[ints[S_TARGET] + points * e + q] = total


@lean(TERM, inner=True)
def bulk(t, y, rate, floats, ints):
    """Adds what coefficients and sources that vary bring to the unknowns of elements."""
    at, points, nodes, d = ints[B_AT], ints[B_POINTS], ints[B_NODES], ints[B_DIMENSION]
    conducts, made = ints[B_CONDUCTS], ints[B_MADE]
    inflow = 0.0
    for e in range(ints[B_ELEMENTS]):
        own = B_LIST + nodes * e
        for q in range(points):
            p = points * e + q
            weight = floats[ints[B_WEIGHTS] + p]
            if made >= 0:
                source = weight * floats[made + p]
                inflow += source
                for i in range(nodes):
                    rate[at + ints[own + i]] += source * floats[ints[B_SHAPES] + nodes * q + i]
            if conducts >= 0:
                coefficient = floats[conducts + p]
                if not coefficient >= 0.0:
                    coefficient = math.nan
                slopes = ints[B_GRADIENTS] + p * nodes * d
                for axis in range(d):
                    total = 0.0
                    for j in range(nodes):
                        total += floats[slopes + d * j + axis] * y[at + ints[own + j]]
                    total *= weight * coefficient
                    for i in range(nodes):
                        rate[at + ints[own + i]] -= total * floats[slopes + d * i + axis]
    rate[ints[B_INFLOW]] += inflow


@lean(TERM, inner=True)
def given(t, y, rate, floats, ints):
    """Adds what values and fluxes that vary bring to the unknowns beside the boundary."""
    at, nodes = ints[G_AT], ints[G_NODES]
    inflow = 0.0
    for p in range(ints[G_POINTS]):
        value = floats[ints[G_VALUES] + p]
        for i in range(nodes):
            share = floats[ints[G_WEIGHTS] + nodes * p + i] * value
            rate[at + ints[G_LIST + nodes * p + i]] += share
            inflow += share
    rate[ints[G_INFLOW]] += inflow


@lean(TERM, inner=True)
def held(t, y, rate, floats, ints):
    """Adds Nitsche's terms of given values where the coefficient varies."""
    at, nodes = ints[H_AT], ints[H_NODES]
    inflow = 0.0
    for p in range(ints[H_POINTS]):
        coefficient = floats[ints[H_CONDUCTS] + p]
        if not coefficient >= 0.0:
            coefficient = math.nan
        shapes, normal, own = ints[H_SHAPES] + nodes * p, ints[H_NORMAL] + nodes * p, H_LIST + nodes * p
        value, slope = 0.0, 0.0
        for j in range(nodes):
            value += floats[shapes + j] * y[at + ints[own + j]]
            slope += floats[normal + j] * y[at + ints[own + j]]
        weight = coefficient * floats[ints[H_WEIGHTS] + p]
        away = weight * (floats[ints[H_VALUES] + p] - value)
        firm = floats[ints[H_FIRM] + p] * away + weight * slope
        inflow += firm
        for i in range(nodes):
            rate[at + ints[own + i]] += firm * floats[shapes + i] - away * floats[normal + i]
    rate[ints[H_INFLOW]] += inflow
