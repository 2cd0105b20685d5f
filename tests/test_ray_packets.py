"""Laws of rays that are met in packets: what is told of them is what single rays find, and pictures are the same."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import stage
from renderers.trace import Trace
from renderers.tracing import layout
from renderers.tracing.certified import TOLERANCE
from renderers.tracing.pack import pack
from renderers.tracing.probe import probe
from renderers.tracing.scratch import scratch
from renderers.tracing.solids.bundles import Packets, solids_in_lanes
from renderers.tracing.solids.intersect_kernels import walk
from sceneql.field.roots.clips import clips_of
from sceneql.field.tape.builder import TapeBuilder
from sceneql.field.tape.tape_solid import field_values
from sceneql.frame import Implicit, PointLight, Sky, Surface
from stage import GLOW, WHITE, frame, sun, view

SKY = Sky((0.9, 1.0, 1.2), (0.8, 0.8, 0.8), (0.3, 0.3, 0.3))
GLASS = Surface(color=(0.9, 1.0, 0.95), roughness=0.0, transmission=1.0)
ONE_BY_ONE = 0.5 * TOLERANCE
"""A tolerance at which no packets are asked."""
MIRROR = Surface(color=(0.9, 0.9, 0.9), roughness=0.0, metallic=1.0)


def lattice(surface, center=(0.0, 0.0, 0.0)):
    """A cube cut from a gyroid's walls: of operations that have lanes, no exact form."""
    b = TapeBuilder()
    axes = [
        b.op("mul", b.constant(5.0), b.op("sub", a, b.constant(c)))
        for a, c in zip((b.x, b.y, b.z), center, strict=True)
    ]
    waves = [b.op("mul", b.op("sin", axes[k]), b.op("cos", axes[(k + 1) % 3])) for k in range(3)]
    f = b.op("sub", b.op("abs", b.op("add", b.op("add", *waves[:2]), waves[2])), b.constant(0.4))
    low, high = (tuple(c + s * 0.8 for c in center) for s in (-1, 1))
    return Implicit("lattice", surface, b.finish(f), low, high)


def tangle(surface):
    """A quartic with eight lobes."""
    b = TapeBuilder()
    terms = []
    for axis in (b.x, b.y, b.z):
        square = b.op("square", b.op("mul", b.constant(2.5), axis))
        terms.append(b.op("mul", square, b.op("sub", square, b.constant(5.0))))
    f = b.op("add", b.op("add", b.op("add", terms[0], terms[1]), terms[2]), b.constant(11.8))
    return Implicit("tangle", surface, b.finish(f), (-1.1,) * 3, (1.1,) * 3)


def clipped(shape, center, radius):
    """A solid cut by a ball, a cylinder along x + y and a slanted face: a quadric each, the ball as a distance."""
    b = TapeBuilder()
    u, v, w = (b.op("sub", a, b.constant(c)) for a, c in zip((b.x, b.y, b.z), center, strict=True))
    squares = b.op("add", b.op("add", b.op("square", u), b.op("mul", v, v)), b.op("square", w))
    ball = b.op("sub", b.op("sqrt", squares), b.constant(radius))
    across = b.op("add", b.op("square", b.op("sub", u, v)), b.op("square", w))
    pipe = b.op("sub", b.op("mul", b.constant(0.5), across), b.constant(0.5))
    face = b.op("sub", b.op("add", u, b.op("mul", b.constant(0.3), w)), b.constant(0.6))
    f = b.op("max", b.op("max", shape(b), ball), b.op("max", pipe, b.op("mul", b.constant(2.0), face)))
    return Implicit("clipped", GLOW, b.finish(f), tuple(c - radius for c in center), tuple(c + radius for c in center))


def saddle(b):
    """A cubic."""
    return b.op("sub", b.op("mul", b.op("mul", b.x, b.y), b.z), b.op("mul", b.constant(0.2), b.x))


def waves(b):
    return b.op("add", b.op("sin", b.op("mul", b.constant(4.0), b.x)), b.op("mul", b.y, b.op("cos", b.z)))


def test_a_field_is_positive_outside_of_its_clips():
    random = np.random.default_rng(4)
    for shape in (clipped(saddle, (0.2, 0.1, 0.0), 1.1), clipped(waves, (0.0, 0.0, 0.3), 0.9)):
        clips = clips_of(shape.tape)
        assert clips.shape == (3, 10)
        p = random.uniform(-1.5, 1.5, (20000, 3))
        x, y, z = p.T
        terms = np.stack([x * x, y * y, z * z, x * y, y * z, z * x, x, y, z, 1.0 + 0.0 * x])
        inside = field_values(shape.tape, p) < 0.0
        assert 500 < inside.sum() < 15000
        assert (clips @ terms < 1e-12)[:, inside].all()
        # Each leaves out something that no other does.
        beyond = clips @ terms > 0.0
        assert all((beyond[k] & ~np.delete(beyond, k, axis=0).any(axis=0)).any() for k in range(3))
    assert len(clips_of(stage.torus(GLOW, 1.0, 0.3).tape)) == 0


SOLIDS = {
    "cubic": clipped(saddle, (0.2, 0.1, 0.0), 1.1),
    "waves": clipped(waves, (0.0, 0.0, 0.3), 0.9),
    "sphere": stage.implicit_sphere(GLOW),
    "torus": stage.torus(GLOW, 0.8, 0.3),
    "blob": stage.blob(GLOW),
    "lattice": lattice(GLOW),
    "tangle": tangle(GLOW),
}


def told(shape, rays, far, want):
    """What packets tell of rays (n, 6)."""
    packets = Packets((shape,), solids_in_lanes((shape,)))
    asked = packets.asked(len(rays))
    asked[1:, : layout.FAR], asked[1:, layout.FAR] = rays, far
    asked[1:, layout.WANT], asked[0, layout.NEXT] = want, len(rays) + 1
    packets.meet(asked)
    return asked[1:, layout.ANSWERS]


def one_by_one(shape, rays, far, anywhere):
    scene, rows = pack(frame(shape))
    return np.array(
        [walk(scene, scratch(rows), *ray, 0.0, end, anywhere)[0] for ray, end in zip(rays, far, strict=True)]
    )


@pytest.mark.parametrize("name", SOLIDS)
@settings(max_examples=15, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    spread=st.sampled_from([0.0, 0.02, 3.0]),
    count=st.integers(1, 400),
    back=st.sampled_from([0.0, 0.0, 1e4]),
)
def test_what_is_told_of_rays_is_what_they_find_one_by_one(name, seed, spread, count, back):
    """From anywhere, the inside and far behind included, near each other or not, to lights near and far."""
    random, shape = np.random.default_rng(seed), SOLIDS[name]
    origins = random.uniform(-2, 2, 3) + spread * random.uniform(-0.5, 0.5, (count, 3))
    ways = random.normal(size=3) * 0.5 - origins.mean(axis=0) + random.normal(size=(count, 3)) * (0.05 + 0.3 * spread)
    rays = np.hstack([origins, ways / np.linalg.norm(ways, axis=1)[:, None]])
    rays[:, :3] -= back * rays[:, 3:]
    far = back + np.where(random.random(count) < 0.7, math.inf, random.uniform(0.1, 4.0, count))

    first, single = told(shape, rays, far, layout.FIRST), one_by_one(shape, rays, far, False)
    sure = ~np.isnan(first)
    assert (np.isfinite(first) == np.isfinite(single))[sure].all()
    hit = sure & np.isfinite(single)
    assert first[hit] == pytest.approx(single[hit], abs=1e-6)
    outside = one_by_one(shape, rays, np.full(count, 1e-7), True) == math.inf
    assert sure[outside].all()

    shaded, single = told(shape, rays, far, layout.ANYWHERE), one_by_one(shape, rays, far, True)
    sure = ~np.isnan(shaded)
    assert (np.isfinite(shaded) == np.isfinite(single))[sure].all()
    assert sure[outside].all()
    hit = sure & np.isfinite(shaded)
    assert ((shaded[hit] >= 0.0) & (shaded[hit] <= far[hit])).all()


def test_what_is_looked_at_is_met_in_packets(monkeypatch):
    """At the usual tolerance: see `bench` of surfaces."""
    asked = []
    meet = Packets.meet
    count = layout.NEXT
    monkeypatch.setattr(Packets, "meet", lambda self, rays: asked.append(int(rays[0, count]) - 1) or meet(self, rays))
    scene = frame(*(SOLIDS[name] for name in ("lattice", "cubic", "blob")), seen=view(size=(70, 45)))
    single, together = probe(scene, ONE_BY_ONE), probe(scene)
    assert sum(asked) == 70 * 45
    assert (np.isfinite(single.depth) == np.isfinite(together.depth)).all()
    met = np.isfinite(single.depth)
    assert 0.2 < met.mean() < 0.9
    assert np.abs(single.depth[met] - together.depth[met]).max() < 1e-5
    # A crease has two normals.
    assert (np.abs(single.normals - together.normals).max(axis=-1) > 1e-5).mean() < 0.005
    assert (single.undecided == together.undecided).all()


def pictures(*shapes, lights, seen, samples=4):
    one, other = (
        Trace(samples=samples, tolerance=tolerance).draw(frame(*shapes, lights=lights, seen=seen))
        for tolerance in (ONE_BY_ONE, TOLERANCE)
    )
    assert one.undecided == other.undecided == 0
    return one.linear, other.linear


@pytest.mark.parametrize(
    "surface",
    [WHITE, GLASS, MIRROR, replace(WHITE, roughness=0.1, specular=0.05)],
    ids=["matte", "glass", "mirror", "gloss"],
)
@pytest.mark.parametrize("orthographic", [True, False])
def test_pictures_are_the_same_in_packets(surface, orthographic):
    """With lights of no size, whose shadows have no width that depends on where on its way a ray was stopped."""
    seen = view((1.5, 1.2, 4.0), (0, 0, 0), (100, 64), 1.2 if orthographic else 0.35, orthographic)
    shapes = stage.floor(WHITE, -0.8), lattice(surface, (-1.0, 0.0, 0.0)), stage.blob(surface, (0.7, 0.1, 0.0))
    lights = SKY, sun((0.5, 0.8, 0.4)), PointLight((-1.0, 3.0, 2.0), (3.0, 3.0, 3.0), 0.0)
    one, other = pictures(*shapes, stage.torus(surface, 0.3, 0.12), lights=lights, seen=seen)
    off = np.abs(np.minimum(one, 1.0) - np.minimum(other, 1.0)).max(axis=-1)
    # What grazes an edge, or comes through much glass, tells the last place of a root.
    assert (off > 2e-3).mean() < 0.005
    assert off.mean() < 1e-3


def test_soft_shadows_are_as_soft_in_packets():
    seen = view((0.0, 2.5, 4.0), (0, -0.5, 0), (64, 40), 1.4)
    one, other = pictures(
        stage.floor(WHITE, -0.9), stage.blob(WHITE), lights=(SKY, sun((0.5, 0.8, 0.4), (2.0,) * 3, 0.1)), seen=seen
    )
    off = np.abs(one - other).max(axis=-1)
    assert off.mean() < 1e-3
    assert off.max() < 0.2


def test_threads_do_not_change_a_bit_in_packets(monkeypatch):
    shapes = stage.floor(WHITE, -0.8), lattice(MIRROR, (-0.9, 0.0, 0.0)), stage.blob(WHITE, (0.7, 0.1, 0.0))
    seen = view((1.5, 1.2, 4.0), (0, 0, 0), (80, 70), 1.2)
    scene = frame(*shapes, lights=(SKY, sun((0.5, 0.8, 0.4), (2.0,) * 3, 0.1)), seen=seen)
    made = []
    for threads in (1, 3):
        monkeypatch.setenv("SCENEQL_THREADS", str(threads))
        made.append(Trace().draw(scene).linear.tobytes())
    assert made[0] == made[1]
