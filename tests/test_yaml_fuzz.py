"""Mutated scripts: whatever the text, reading it gives a script or located errors, and nothing else."""

from __future__ import annotations

import os
import random
from collections.abc import Iterator

import pytest

from sceneql.language.script import read_script
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.span import Source

COUNT = int(os.environ.get("SCENEQL_FUZZ", "5000"))
CHUNKS = 10

SCRIPTS = [
    """sceneql: 1
about: A soft blob on springs drops onto the floor.
define: {k: 2 kN/m, n: 3}
clock: {end: 4 s, fps: 30}
models:
  cage:
    mass_spring:
      lattice: {count: 3 3 3, spacing: 0.3 m, center: 0 1.2 0 m}
      stiffness: k
      masses: {wall: {position: 0 0 0, fixed: yes}, bob: {position: [2, "max(0, k)", 0], mass: 1e-3 kg}}
objects:
  jelly: {blobby: {points: cage.positions, color: "#ff8800", threshold: .3}}
  floor: plane
forces: [gravity, {drag: {coefficient: 0.1}}]
variants:
  soft: {define.k: 200 N/m, may_fail: yes}
  euler: {models.cage.stiffness: 1, forces.gravity.strength: 1 m/s^2}
outputs: {film: {video: {size: 960 540}}}
""",
    """templates:
  leg:
    fields: {at: , phase: 0 s, side: 1}
    gives: {end: knee.position}
    objects:
      hip: {group: {position: at, rotation: {about: z, angle: 30 deg*sin(2*pi*time/(1 s))}}}
      knee: {sphere: {position: 'hip.position + [0, -0.2, 0]'}}
    parts: {foot: {toe: {at: at}}}
  toe: {fields: {at: 0}, objects: [sphere, box]}
parts:
  front: &front {leg: {at: 0.4 0.45 0.16 m}}
  back: *front
  row:
    repeat: {count: 4, as: i}
    leg:
      at: [i - 3, 0, -0.6]
defaults: {sphere: {radius: 0.1 m}}
include: [part.yaml]
background: black
""",
    """# a film of five lines
objects:
    ball: {sphere: {radius: 0.2 m, position: 0 2 0 m}}
    text: {text: {text: |
        several
        lines
      , height: 1 m}}
models:
    ball_motion: >-
      free
forces: [gravity, collision]
expect:
    period: {of: "first(ball.position.y)", value: 2*pi, tolerance: 1e-9, because: exact}
""",
]
PART = "objects: {shared: box}\nforces: [wind]\n"
TOKENS = [
    *"{}[]():,-?&*!|>'\"%@`#\n\t\r \\.~=<", "\r\n", ": ", "- ", "---\n", "...\n", "<<: ", "&a ", "*a ", "!!x ", "#fff ",
    "{a: f(1, 2)}", "[0, 1] m", "\ufeff", "\u2028", "\x00", "\x85", "𝄞", "\ud800", "1e999", "null", "~", "yes",
    "repeat: {count: 9}\n", "include: ../x\n", "  ", '"\\u', "%YAML 1.2\n", "objects:\n", "parts: {a: leg}\n",
]  # fmt: skip
SETS = [
    "define.k=1",
    "cage.stiffness={a: 1}",
    "jelly=",
    "a..b=1",
    "models.cage.x.y=[1",
    "gravity.2=3",
    "row.repeat.count=2",
]


def mutants(chunk: int) -> Iterator[str]:
    rng = random.Random(chunk)
    for _ in range(COUNT // CHUNKS):
        text = rng.choice(SCRIPTS)
        for _ in range(rng.choice([1, 1, 2, 3, 8])):
            at, other = sorted((rng.randrange(len(text) + 1), rng.randrange(len(text) + 1)))
            match rng.randrange(6):
                case 0:
                    text = text[:at] + rng.choice(TOKENS) + text[at:]
                case 1:
                    text = text[:at] + text[at + rng.randrange(1, 6) :]
                case 2:
                    text = text[:at] + text[other:]
                case 3:
                    text = text[:at] + text[at:other] * 2 + text[other:]
                case 4:
                    lines = text.splitlines(keepends=True)
                    rng.shuffle(lines)
                    text = "".join(lines)
                case _:
                    text = text[:at] + rng.choice(TOKENS) + text[at + 1 :]
        yield text


def faults(text: str, variant: str | None, sets: list[str]) -> tuple[Diagnostic, ...]:
    try:
        read_script(Source("s.yaml", text), variant, sets, read=lambda name: Source(name, PART))
    except ScriptError as error:
        return error.diagnostics or (Diagnostic("none", "an error without a diagnostic", None),)
    return ()


@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_only_located_errors_come_out(chunk: int) -> None:
    rng = random.Random(chunk)
    wrong = 0
    for text in mutants(chunk):
        sets = [rng.choice(SETS)] if rng.random() < 0.3 else []
        found = faults(text, rng.choice([None, None, "soft", "soff"]), sets)
        wrong += bool(found)
        for diagnostic in found:
            assert diagnostic.code in str(diagnostic)
            if diagnostic.code != "unknown-variant":
                assert diagnostic.span is not None
                assert 0 <= diagnostic.span.start <= diagnostic.span.end <= len(diagnostic.span.source.text) + 1
    assert 0.5 < wrong / (COUNT // CHUNKS) < 1
