# mypy: ignore-errors
"""The derivatives of the rate of a field on elements: entries of elements are (nodes, nodes), row by row."""

from sceneql.compiled.kernels import lean
from sceneql.galerkin import field_kernels as term
from sceneql.system.signatures_kernels import TERM


@lean(TERM, inner=True)
def balance(t, y, entries, floats, ints):
    """Of every value of the matrix."""
    for k in range(entries.size):
        entries[k] -= floats[ints[term.VALUES] + k]


@lean(TERM, inner=True)
def bulk(t, y, entries, floats, ints):
    """Of each element, by the coefficient and its own derivative, and by the source's."""
    at, points, nodes, d = ints[term.B_AT], ints[term.B_POINTS], ints[term.B_NODES], ints[term.B_DIMENSION]
    conducts, slope, bend = ints[term.B_CONDUCTS], ints[term.B_SLOPE], ints[term.B_BEND]
    for e in range(ints[term.B_ELEMENTS]):
        own, first = term.B_LIST + nodes * e, nodes * nodes * e
        for q in range(points):
            p = points * e + q
            weight, shapes = floats[ints[term.B_WEIGHTS] + p], ints[term.B_SHAPES] + nodes * q
            if slope >= 0:
                made = weight * floats[slope + p]
                for i in range(nodes):
                    for j in range(nodes):
                        entries[first + nodes * i + j] += made * floats[shapes + i] * floats[shapes + j]
            if conducts >= 0:
                slopes = ints[term.B_GRADIENTS] + p * nodes * d
                for axis in range(d):
                    total = 0.0
                    if bend >= 0:
                        for j in range(nodes):
                            total += floats[slopes + d * j + axis] * y[at + ints[own + j]]
                        total *= weight * floats[bend + p]
                    for i in range(nodes):
                        mine = floats[slopes + d * i + axis]
                        for j in range(nodes):
                            change = weight * floats[conducts + p] * floats[slopes + d * j + axis]
                            entries[first + nodes * i + j] -= mine * (change + total * floats[shapes + j])


@lean(TERM, inner=True)
def given(t, y, entries, floats, ints):
    """Of values and fluxes that depend on the field."""
    nodes = ints[term.G_NODES]
    for p in range(ints[term.G_POINTS]):
        slope = floats[ints[term.G_SLOPE] + p]
        weights, shapes = ints[term.G_WEIGHTS] + nodes * p, ints[term.G_SHAPES] + nodes * p
        for i in range(nodes):
            for j in range(nodes):
                entries[nodes * (nodes * p + i) + j] += floats[weights + i] * slope * floats[shapes + j]


@lean(TERM, inner=True)
def held(t, y, entries, floats, ints):
    """Of Nitsche's terms."""
    at, nodes = ints[term.H_AT], ints[term.H_NODES]
    for p in range(ints[term.H_POINTS]):
        shapes, normal = ints[term.H_SHAPES] + nodes * p, ints[term.H_NORMAL] + nodes * p
        own, area, firm = term.H_LIST + nodes * p, floats[ints[term.H_WEIGHTS] + p], floats[ints[term.H_FIRM] + p]
        value, out = 0.0, 0.0
        for j in range(nodes):
            value += floats[shapes + j] * y[at + ints[own + j]]
            out += floats[normal + j] * y[at + ints[own + j]]
        away = floats[ints[term.H_VALUES] + p] - value
        weight = area * floats[ints[term.H_CONDUCTS] + p]
        bend = area * floats[ints[term.H_BEND] + p] if ints[term.H_BEND] >= 0 else 0.0
        rise = weight * floats[ints[term.H_SLOPE] + p] if ints[term.H_SLOPE] >= 0 else 0.0
        for i in range(nodes):
            mine, across = floats[shapes + i], floats[normal + i]
            for j in range(nodes):
                other = floats[shapes + j]
                change = (rise - weight) * other + bend * away * other
                pull = firm * change + weight * floats[normal + j] + bend * out * other
                entries[nodes * (nodes * p + i) + j] += pull * mine - change * across
