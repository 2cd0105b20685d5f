"""Scenes and drawings with tokens gone wrong: only located errors come out, in time and memory that stay small.

SCENEQL_FUZZ says how many, and has those that pass drawn, each in a process of its own; SCENEQL_SEED=1, 2, ... tries
others.
"""

from __future__ import annotations

import os
import random
import resource
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest

from mutants import mutant, mutants, within_seconds
from sceneql import pipeline
from sceneql.failure import LimitRefused, RunFailure
from sceneql.grids.domain import svg
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

LONG = int(os.environ.get("SCENEQL_FUZZ", "0"))
SEED = 1_000 * int(os.environ.get("SCENEQL_SEED", "0"))
SCENES = min(LONG, 100_000) or 2_000
DRAWINGS = min(LONG, 20_000) or 500
STILLS = min(LONG // 50, 2_000)
CHUNKS = 10
CHECK = 5.0
"""Seconds of processor time that a check may take."""
CHECK_MEMORY = 300 * 2**10
"""KiB that it may need."""
STILL, STILL_MEMORY = 20, 2**20
SMALL = "outputs={still: {image: {size: 64 36, time: 0.1 s}}}"
SHAPES = [
    '<path d="M0 0 h10 v10 h-10 Z m 2 2 l 1 0 0 1 z" transform="rotate(30) scale(2, 3)"/>',
    '<path id="a" d="M 0,0 C 1 1 2 1 3 0 S 5 -1 6 0 Q 7 8 3 9 T 1 2 A 2 3 30 1 0 -4 5 H 3 V -2 Z"/>',
    '<g transform="translate(3,4) skewX(10)"><circle cx="1" cy="2" r="3"/><ellipse rx="2" ry="1"/></g>',
    '<rect x="1" y="2" width="30" height="4.5" transform="matrix(1 0 .5 1 0 0)"/>',
    '<polygon points="0,0 4,0 4,3"/><defs><path d="M0 0h1v1z"/></defs>',
]
DATA = "M 0,0 C 1 1 2 1 3 0 S 5 -1 6 0 Q 7 8 3 9 T 1 2 A 2 3 30 1 0 -4 5 H 3 V -2 l 3 4 Z m 1 1 h 2 v 2 z"
HEAD = ['<?xml version="1.0" encoding="utf-8"?>', '<svg xmlns="http://www.w3.org/2000/svg">', *SHAPES, "</svg>"]
WORDS = [
    "M",
    "a",
    "A",
    "Z",
    "C",
    "t",
    "1e300",
    "1e-300",
    "1e999",
    "nan",
    "-",
    ".",
    "<g>",
    "</g>",
    "&lt;",
    "&a;",
    "<!--",
]
WORDS += ["rot13", "1e100", "1e-100", "0", "-1", "rotate(", "scale(0)", "<use href='#a'/>", "\0", "é", "]]>", "'", '"']


def wrong(told: tuple[Diagnostic, ...]) -> str | None:
    """What is wrong with the errors that are told."""
    if not told:
        return "nothing is told"
    for one in told:
        if one.span is None or not 0 <= one.span.start <= one.span.end <= len(one.span.source.text) + 1:
            return f"{one.code} has no place"
        if not one.code or len(str(one)) > 6_000:
            return f"{one.code} tells too much"
    return None


@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_a_scene_with_tokens_gone_wrong_has_located_errors(chunk: int, tmp_path: Path) -> None:
    script, passed = tmp_path / "s.yaml", 0
    for number, (path, text) in enumerate(mutants(SEED + chunk, SCENES // CHUNKS)):
        script.write_text(text, encoding="utf-8")
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        found = None
        try:
            with within_seconds(CHECK):
                pipeline.load(script)
            passed += 1
        except ScriptError as error:
            found = wrong(error.diagnostics)
        except BaseException as error:
            error.add_note(f"mutant {number} of chunk {chunk}, of {path.name}:\n{text}")
            raise
        grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
        assert found is None, f"{found}: mutant {number} of chunk {chunk}, of {path.name}:\n{text}"
        assert grown < CHECK_MEMORY, f"{grown} KiB: mutant {number} of chunk {chunk}, of {path.name}:\n{text}"
    assert 0.02 < passed / (SCENES // CHUNKS) < 0.5


def drawing(rng: random.Random) -> str:
    """An SVG file with tokens gone wrong."""
    lines = [rng.choice(HEAD[2:-1]) for _ in range(rng.randrange(1, 4))]
    text = "\n".join([*HEAD[:2], *lines, HEAD[-1]])
    if rng.random() < 0.3:  # well-formed, wrong in its numbers
        data = mutant(rng, svg.NUMBER.sub(r" \g<0> ", DATA).split())
        return f'{HEAD[1]}<path d={quoteattr(data)} transform="{rng.choice(WORDS[:16])}"/></svg>'
    for _ in range(rng.choice([1, 1, 2, 4])):
        at = rng.randrange(len(text) + 1)
        match rng.randrange(4):
            case 0:
                text = text[:at] + rng.choice(WORDS) + text[at:]
            case 1:
                text = text[:at] + text[at + rng.randrange(1, 9) :]
            case 2:
                text = text[:at] + rng.choice(WORDS) + text[at + 1 :]
            case _:
                numbers = [one.span() for one in svg.NUMBER.finditer(text)] or [(0, 0)]
                first, last = rng.choice(numbers)
                text = text[:first] + rng.choice(WORDS) + text[last:]
    return text


def test_a_drawing_with_tokens_gone_wrong_has_polygons_or_is_refused_by_its_name(tmp_path: Path) -> None:
    rng, path, read = random.Random(SEED + 5), tmp_path / "s.svg", 0
    refusals: list[str] = []
    for number in range(DRAWINGS):
        text = drawing(rng)
        path.write_text(text, encoding="utf-8")
        try:
            with within_seconds(CHECK):
                rings = svg.rings(str(path))
            read += 1
            for ring in rings.values():
                assert len(ring) > 2
                assert all(abs(number) <= svg.LARGEST for corner in ring for number in corner), text
        except ValueError as error:
            refusals.append(str(error))
        except BaseException as error:
            error.add_note(f"drawing {number}\n{text}")
            raise
    assert [said for said in refusals if not said.startswith("s.svg") or len(said) > 300] == []
    assert 0.1 < read / DRAWINGS < 0.9


def still(script: Path, folder: Path) -> int:
    """0 where a script gives a still or a located failure, in a process with limits; else 1."""
    if (process := os.fork()) == 0:
        code = 1
        try:
            resource.setrlimit(resource.RLIMIT_CPU, (STILL, STILL + 1))
            pipeline.render(pipeline.load(script, sets=[SMALL]), folder=folder, limit=STILL - 3)
            code = 0
        except ScriptError as error:
            code = int(wrong(error.diagnostics) is not None)
        except (RunFailure, LimitRefused) as error:
            code = int(wrong((error.diagnostic,)) is not None)
        finally:
            os._exit(code)
    _, status, used = os.wait4(process, 0)
    return os.waitstatus_to_exitcode(status) or int(used.ru_maxrss > STILL_MEMORY)


@pytest.mark.skipif(not STILLS, reason="a still takes a second; SCENEQL_FUZZ asks for it")
@pytest.mark.parametrize("chunk", range(CHUNKS, 2 * CHUNKS))
def test_a_fuzzed_scene_that_passes_gives_a_still_or_a_located_failure(
    chunk: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SCENEQL_THREADS", "1")
    script, drawn, failed = tmp_path / "s.yaml", 0, []
    for path, text in mutants(SEED + chunk, 20 * STILLS):
        script.write_text(text, encoding="utf-8")
        try:
            pipeline.load(script)
        except ScriptError:
            continue
        drawn += 1
        if still(script, tmp_path / "stills"):
            failed.append(f"--- of {path.name}\n{text}")
        if drawn == max(1, STILLS // CHUNKS):
            break
    assert not failed, "\n".join([f"{len(failed)} of {drawn}:", *failed[:10]])
    assert drawn >= min(max(1, STILLS // CHUNKS), 20)
