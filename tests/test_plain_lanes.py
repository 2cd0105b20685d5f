"""Rays in lanes against floors, balls, boxes and cylinders: what the walk finds one by one, to the bit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import stage
from renderers.trace import Trace
from renderers.tracing import layout
from renderers.tracing.pack import pack
from renderers.tracing.scratch import scratch
from renderers.tracing.solids import plain_lanes
from renderers.tracing.solids.intersect_kernels import walk
from renderers.tracing.solids.plain_lanes_kernels import meet_plain
from sceneql.frame import PointLight, Sky, Surface

GLASS = Surface(color=(0.8, 0.9, 1.0), roughness=0.0, transmission=1.0)
GLOSSY = Surface(color=(0.9, 0.3, 0.1), roughness=0.2)
SHAPES = (
    stage.floor(),
    stage.sphere(GLASS, (0.3, 0.8, 0.1), 0.7),
    stage.box(stage.WHITE, (-1.0, 0.5, 0.2), (0.8, 1.0, 0.6)),
    replace(stage.cylinder(GLOSSY, 0.4, 0.9), to_local=stage.local((0.9, 0.45, 1.0), (0.4, 1, 0.4))),
)
SKY = Sky((0.3, 0.4, 0.6), (0.6, 0.6, 0.6), (0.2, 0.2, 0.2))


def rays(count, seed):
    """(count, 8): origins, among them on faces, directions, among them along axes, ends, wants."""
    random = np.random.default_rng(seed)
    found = np.zeros((count, 8))
    found[:, :3] = random.normal(size=(count, 3)).round(random.integers(0, 4))
    ways = random.normal(size=(count, 3))
    ways[::7, random.integers(0, 3)] = 0.0
    ways[::11] = np.eye(3)[random.integers(0, 3, len(ways[::11]))]
    found[:, 3:6] = ways / np.linalg.norm(ways, axis=1)[:, None]
    found[:, 6] = np.where(random.integers(0, 2, count), np.inf, random.exponential(size=count))
    found[:, 7] = random.integers(0, 2, count)
    return found


@pytest.mark.parametrize("seed", range(4))
def test_lanes_find_what_the_walk_finds_to_the_bit(seed):
    scene, rows = pack(stage.frame(*SHAPES))
    found = rays(1001, seed)
    asked = np.zeros((1 + len(found), layout.ANSWERS))
    asked[1:, :8] = found
    asked[0, layout.NEXT] = len(asked)
    lanes = plain_lanes.lanes_for(scene, False)
    assert lanes is not None
    meet_plain(scene, asked, lanes)
    one = [walk(scene, scratch(rows), *ray[:6], 0.0, ray[6], ray[7] == layout.ANYWHERE) for ray in found]
    told = asked[1:, [layout.REST_AT, layout.REST_ITEM, layout.REST_LIGHT]]
    assert (told == np.array(one)).all()
    assert len(np.unique(told[:, 1])) == 1 + len(SHAPES)


@pytest.mark.parametrize("among", [(), (stage.blob(GLOSSY, (0.0, 1.6, 0.5)),)], ids=["alone", "with a blob"])
def test_pictures_are_the_same_with_and_without_lanes(monkeypatch, among):
    seen = stage.view((1.0, 1.6, 5.0), (0.0, 0.7, 0.0), (64, 48), 0.35, orthographic=False)
    lamp = PointLight((1.5, 3.0, 2.0), (9.0, 8.0, 7.0), radius=0.3)
    lights = SKY, stage.sun((0.4, 0.8, 0.6), (2.0, 2.0, 2.0), angle=0.05), lamp
    frame = stage.frame(*SHAPES, *among, lights=lights, seen=seen)
    lanes = Trace(samples=4).draw(frame).linear
    monkeypatch.setattr(plain_lanes, "MOST", 0)
    assert (lanes == Trace(samples=4).draw(frame).linear).all()


def test_what_only_the_walk_finds_is_left_to_it():
    scene, _ = pack(stage.frame(*SHAPES, stage.round_mesh(stage.WHITE, 0.3, 6)))
    assert plain_lanes.lanes_for(scene, False) is None
    scene, _ = pack(stage.frame(*SHAPES, stage.implicit_sphere(stage.WHITE)))
    assert plain_lanes.lanes_for(scene, False) is None
    assert plain_lanes.lanes_for(scene, True) is not None
