"""Cubes and their variants: closed, of the topology of the trilinear interpolant."""

import numpy as np

from meshes import tape_of
from sceneql.mesh.cubes.cases import CENTERS, cases, decisions
from sceneql.mesh.cubes.cube import FACES_OF, segments
from sceneql.mesh.cubes.polygonise import polygonise
from sceneql.mesh.measures import edge_counts, euler_characteristic


def all_variants():
    table = cases()
    for config in range(256):
        for bits, joined in enumerate(decisions(config)):
            variant = int(table.first[config]) + bits
            yield config, joined, variant
            for piped in np.unique(table.tunnel[variant]):
                if piped >= 0:
                    yield config, joined, int(piped)


def test_every_variant_is_closed_but_for_the_curves_on_the_faces_and_has_no_chord_in_a_face():
    table = cases()
    for config, joined, variant in all_variants():
        rows = table.triangles[table.start[variant] : table.start[variant + 1]].tolist()
        sides = [(row[k], row[(k + 1) % 3]) for row in rows for k in range(3)]
        assert len(set(sides)) == len(sides)
        border = {side for side in sides if side[::-1] not in sides}
        assert border == {pair for face in range(6) for pair in segments(config, face, face in joined)}
        for a, b in set(sides) - border:
            assert max(a, b) >= CENTERS or not FACES_OF[a] & FACES_OF[b]


def trilinear(values):
    """The formula whose values at the cube's corners are these, times 1/10 of the largest."""
    values = 0.1 * np.asarray(values) / np.abs(values).max()
    terms = []
    for corner, value in enumerate(values):
        factors = [name if corner >> k & 1 else f"(1 - {name})" for k, name in enumerate("xyz")]
        terms.append(f"({value:.17g})*{'*'.join(factors)}")
    return " + ".join(terms)


def characteristic(values, n):
    """Euler characteristic of {trilinear interpolant < 0} in the cube, by n^3 samples."""
    t = np.linspace(0.0, 1.0, n)
    cube = np.asarray(values, dtype=float).reshape(2, 2, 2)
    for axis in range(3):
        low, high = np.take(cube, [0], axis), np.take(cube, [1], axis)
        shape = [1, 1, 1]
        shape[axis] = n
        cube = low + (high - low) * t.reshape(shape)
    whole = cube < 0
    total = 0
    for axes in range(8):
        part = whole
        for axis in range(3):
            if axes >> axis & 1:
                part = np.take(part, range(n - 1), axis) & np.take(part, range(1, n), axis)
        total += (-1) ** axes.bit_count() * int(part.sum())
    return total


def test_ambiguous_cubes_have_the_topology_of_the_trilinear_interpolant():
    # Nodes at -1, 0, 1 and 2: the cells around the cube cap the solid, whose surface then has twice its characteristic.
    rng = np.random.default_rng(3)
    judged = tubes = 0
    for trial in range(240):
        values = rng.uniform(0.1, 1.0, 8) * rng.choice([-1.0, 1.0], 8)
        if trial % 2:  # strong opposite corners among weak ones: where tubes are
            strong = trial % 8
            values = np.full(8, 0.1) * rng.uniform(0.1, 2.0, 8)
            values[strong], values[7 - strong] = -rng.uniform(0.5, 1.0, 2)
            values *= rng.choice([-1.0, 1.0])
        expected = characteristic(values, 24)
        if expected != characteristic(values, 41):
            continue
        judged += 1
        found = polygonise(tape_of(trilinear(values)), (-0.15,) * 3, (1.65,) * 3, 1.0)
        assert edge_counts(found.triangles)[1:] == (0, 0)
        assert euler_characteristic(found.triangles) == 2 * expected, values
        tubes += trial % 2 and (values < 0).sum() == 2 and expected == 1
    assert judged > 200
    assert tubes > 10
