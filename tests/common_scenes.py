"""Tapes of formulas, the common scenes of implicit surfaces, and random rays that the certified routine follows."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np

from sceneql.field.roots.certified_kernels import certify
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.builder import TapeBuilder
from sceneql.field.tape.tape_solid import scratch
from sceneql.quantities.bind import bind
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.expression import Symbol
from sceneql.quantities.parser import parse_expression
from sceneql.quantities.span import Source, Span

FILE = Path(__file__).parent / "bench" / "scenes" / "implicit.json"
COMMON = json.loads(FILE.read_text(encoding="utf-8"))
SCENES = COMMON["scenes"]
RAYS = 1000
TOLERANCE = 1e-9
OUTCOMES = {ops.MISS: "miss", ops.HIT: "hit", ops.INSIDE: "inside", ops.UNDECIDED: "undecided"}


def tape_of(text, where=()):
    """The tape of a formula of x, y, z; ``where`` gives its constants."""
    build = TapeBuilder()
    known = {"x": build.x, "y": build.y, "z": build.z}
    for name, formula in (dict(where) | {"": text}).items():
        found = Diagnostics()
        tree = parse_expression(formula, Span(Source("scene", formula), 0, len(formula)))
        expr = bind(tree, lambda parts, span: Symbol(".".join(parts)) if parts[0] in known else None, found)
        found.raise_errors()
        known[name] = build.expression(expr, known)
    return build.finish(known[""])


@cache
def scene(name):
    """(tape of a common scene, without its ball; radius of the ball)."""
    found = SCENES[name]
    if "parts" not in found:
        return tape_of(found["f"], found.get("where", {})), found["clip"]
    build = TapeBuilder()
    parts = np.array([[*row[:3], *row[:3], row[3], 1.0] for row in found["parts"]])
    density = build.density(parts, build.x, build.y, build.z)
    return build.finish(build.op("sub", build.constant(found["threshold"]), density)), found["clip"]


def rays(clip, count=RAYS, seed=3):
    """(origins, directions, t0, t1) of random rays, from and to where they meet a ball."""
    generator = np.random.default_rng(seed)
    origins, targets = generator.normal(size=(2, count, 3))
    origins *= 2.0 * clip / np.linalg.norm(origins, axis=1)[:, None]
    targets *= clip * generator.random((count, 1)) ** (1 / 3) / np.linalg.norm(targets, axis=1)[:, None]
    return (origins, *chords(origins, targets - origins, clip))


def chords(origins, directions, clip):
    directions = directions / np.linalg.norm(directions, axis=1)[:, None]
    nearest = -np.einsum("ij,ij->i", origins, directions)
    half = np.sqrt(np.maximum(clip**2 - np.einsum("ij,ij->i", origins, origins) + nearest**2, 1e-30))
    return directions, nearest - half, nearest + half


def certified(tape, origins, directions, t0, t1, sign=1.0, anywhere=False, touching=False):
    """(status, t) by the intervals alone."""
    room = scratch(tape)
    program = tape.code, tape.constants, tape.parts, room
    found = [
        certify(*program, *o, *d, a, b, TOLERANCE * (b - a), sign, anywhere, touching)
        for o, d, a, b in zip(origins, directions, t0, t1, strict=True)
    ]
    return np.array([status for status, _ in found]), np.array([t for _, t in found])


def check(status, t, expected, t0, t1, inside_is_hit=False):
    """What was found is what is there; how many rays were left undecided."""
    undecided = 0
    for k, (outcome, place) in enumerate(expected):
        if status[k] == ops.UNDECIDED:
            undecided += 1
            continue
        if outcome == "inside" and inside_is_hit:
            outcome = "hit"
        assert OUTCOMES[status[k]] == outcome, k
        if outcome != "miss":
            assert abs(t[k] - place) <= TOLERANCE * (t1[k] - t0[k]), k
    return undecided
