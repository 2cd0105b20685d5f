"""Normals and colors of implicit solids in lanes, and the cells of single rays: as they are one by one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.linalg import norm

import stage
from renderers.tracing import layout
from renderers.tracing.pack import pack
from renderers.tracing.scratch import scratch
from renderers.tracing.solids.bundles import Packets
from renderers.tracing.solids.intersect_kernels import walk
from renderers.tracing.solids.surface_kernels import normal_at
from sceneql.field.tape.builder import TapeBuilder
from sceneql.frame import Implicit
from stage import WHITE, frame
from test_ray_packets import SKY, SOLIDS, pictures


def paint():
    """Red by x, green by y^2, blue undefined for z < 0."""
    b = TapeBuilder()
    return b.finish(b.op("abs", b.x), b.op("square", b.y), b.op("sqrt", b.z))


def prism():
    """Its sides are blended, and their normals have zeros of either sign."""
    b = TapeBuilder()
    one = b.op("mul", b.op("sub", b.x, b.y), b.op("add", b.constant(0.0), b.op("mul", b.constant(2.0), b.y)))
    other = b.op("neg", b.op("mul", b.op("square", b.op("max", b.z, b.constant(0.0))), b.op("abs", b.y)))
    return Implicit("prism", WHITE, b.finish(b.op("add", one, other)), (-1.0,) * 3, (1.0,) * 3)


def crowd(count):
    """Many blobs, in a turned and stretched place, so that they are asked at points that are not those of rays."""
    random = np.random.default_rng(count)
    parts = np.zeros((count, 8))
    parts[:, :3] = parts[:, 3:6] = random.uniform(-0.8, 0.8, (count, 3))
    parts[::5, 3:6] += 0.1  # some are capsules
    parts[:, 6], parts[:, 7] = 0.4 * count ** (-1 / 3) * random.uniform(1.0, 2.0, count), random.uniform(0.5, 1, count)
    b = TapeBuilder()
    x = b.op("add", b.x, b.op("mul", b.constant(0.3), b.y))
    f = b.op("sub", b.constant(0.3), b.density(parts, x, b.y, b.op("sub", b.z, b.constant(0.1))))
    return Implicit("crowd", WHITE, b.finish(f), (-1.5,) * 3, (1.5,) * 3)


@pytest.mark.parametrize("name", [*SOLIDS, "painted", "prism", 40, 2000])
def test_normals_and_colors_in_lanes_are_those_of_single_points(name):
    shape = crowd(name) if isinstance(name, int) else SOLIDS.get(name, SOLIDS["tangle"])
    if name == "prism":
        shape = prism()
    if name == "painted":
        shape = replace(shape, paint=paint())
    other = stage.implicit_sphere(WHITE)
    shapes = other, shape
    scene, rows = pack(frame(*shapes))
    memory, random = scratch(rows), np.random.default_rng(5)
    count = 300
    met, skins = np.zeros((count, 5)), np.zeros((count, 6))
    items = scene.ints[layout.ITEMS : layout.ITEMS + 8].reshape(2, 4)
    met[:, 1] = np.where(random.random(count) < 0.8, *np.argsort(items[:, layout.SHAPE])[::-1])
    box = np.array([shape.low, shape.high])
    met[:, 2:] = random.normal(size=3) * 0.2 + random.uniform(-0.3, 0.3, (count, 3))
    met[:20, 2 + np.arange(20) % 3] = box[np.arange(20) % 2, np.arange(20) % 3]  # on faces of its box
    met[:20, 1] = np.argsort(items[:, layout.SHAPE])[1]
    hits = random.permutation(count)[:250]
    Packets(shapes, [0, 1]).skin(scene, hits, met, skins)
    for i in hits:
        nx, ny, nz, *_, r, g, b = normal_at(scene, memory, int(met[i, 1]), *met[i, 2:])
        assert skins[i] == pytest.approx([nx, ny, nz, r, g, b], abs=1e-12, nan_ok=True)
        assert (
            np.signbit(skins[i, :3]) == np.signbit([nx, ny, nz])
        ).all()  # light goes on in directions that tell these
    assert norm(skins[hits, :3], axis=1) == pytest.approx(1.0)
    assert not skins[np.setdiff1d(np.arange(count), hits)].any()


def cells(scene):
    at = [int(scene.reals[k + 6]) for k in [scene.ints[layout.ITEMS + layout.REALS_AT]]]
    first = int(scene.ints[at[0] + layout.CELLS_AT])
    return scene.ints[first : first + layout.CELLS**3]


def test_cells_are_looked_at_when_a_ray_comes_to_them():
    scene, rows = pack(frame(SOLIDS["lattice"]))
    assert (cells(scene) == layout.UNKNOWN).all()
    assert walk(scene, scratch(rows), 0.3, 5.0, 0.2, 1.0, 0.0, 0.0, 0.0, np.inf, False)[1] == -1
    assert (cells(scene) == layout.UNKNOWN).all()
    assert walk(scene, scratch(rows), 0.3, 5.0, 0.2, 0.0, -1.0, 0.0, 0.0, np.inf, False)[1] == 0
    known = cells(scene) != layout.UNKNOWN
    assert 0 < known.mean() < 0.05


def test_light_between_surfaces_is_the_same_in_waves():
    """In a lattice lit by a sun alone, where light goes back and forth, and under a roof."""
    lamp = stage.sun((0.3, 1.0, 0.5), (3.0, 3.0, 3.0))
    seen = stage.view((1.5, 1.2, 4.0), (0, 0, 0), (60, 40), 1.0)
    clay = replace(WHITE, color=(0.9, 0.8, 0.7))
    for lights in ((lamp,), (lamp, SKY)):
        shapes = replace(SOLIDS["lattice"], surface=clay), stage.floor(clay, -0.9), stage.sphere(clay, (1, 0, 0.6), 0.3)
        one, other = pictures(*shapes, lights=lights, seen=seen)
        off = np.abs(one - other).max(axis=-1)
        assert (off > 2e-3).mean() < 0.01
        assert off.mean() < 1e-3
        dark, _ = pictures(
            *(replace(s, surface=replace(clay, color=(0,) * 3)) for s in shapes), lights=lights, seen=seen
        )
        assert one.mean() > 1.2 * dark.mean()
