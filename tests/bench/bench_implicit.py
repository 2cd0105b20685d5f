"""Films of the common implicit scenes, of an empty picture and of a ball on a plane, beside POV-Ray.

Run it as ``python tests/bench/bench_implicit.py [--tape | --threads | --before=DIR] [SCENE...]``. Films have 48 frames
of 640 x 360 pixels, a ray each, with one hard sun, in which the thing turns: processor time of a frame on one thread
from the script to the PNG file, start and compilation apart, by its stages: ``bands`` is the whole of roots, hits and
light where one call does it. Where POV-Ray is installed, the processor
time of a whole run of it that writes a PNG file stands beside: of the same picture, without light that surfaces reflect
onto one another (`diffuse_bounces: 0`). The figure with that light, as films are by default, follows, and last that of
the same scene with an area light, a sky and reflections: things are glossy over a matte floor, and edges have 8 rays.

The second column is that of a kernel of the bench alone: one ray a pixel, and a shadow ray where the light is faced;
beside it stands the drawing of the film's frames alone, least of rounds, and its bar: twice the kernel and 12 ms.
A pixel is wrong where its center disagrees with the certified routine.
Nothing is compiled for a scene: tapes are interpreted in lanes, and where one is a polynomial or a density of points
its exact form along each ray is used besides; with ``--tape`` the interpreter works alone, beside half of each bar.
With ``--threads`` nothing but the wall time of films is measured: the gain by two threads beside that by two processes
of one thread side by side, which wants two processors with nothing else to do: see the load that is printed.
With ``--before=DIR`` nothing but the softly lit films is measured, in turns with those of another checkout's code.
POV-Ray is run where it is installed; its figures from another machine are given else, and fidget's always. Times are
medians of rounds in which each is run once, ours for some frames in a row.
"""

from __future__ import annotations

import json
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from bench_polygonise import ELSEWHERE, SCENES, quoted, register, scene_tape
from implicit_films import DRAW, film, like_for_like, scripts, softly
from implicit_films import FRAMES as FILM
from implicit_threads import before, gains

from sceneql.compiled.kernels import over_tiles
from sceneql.field.packets import packets
from sceneql.field.packets.packets import Memory, lined
from sceneql.field.tape.builder import TapeBuilder
from sceneql.field.tape.tape_ops import HIT, INSIDE
from sceneql.field.tape.tape_solid import cast, field_values

FILE = Path(__file__).parent / "scenes" / "implicit.json"
VIEW = json.loads(FILE.read_text(encoding="utf-8"))["view"]
WIDTH, HEIGHT = VIEW["size"]
POV_ELSEWHERE = ELSEWHERE["pictures"]["POV-Ray 3.7"]
"""ms with 1 and 2 threads: blob, isosurface, polynomial with sturm."""
BARS = {"blob40": 12, "gyroid": 25, "barth_sextic": 25, "kummer": 25, "steiner": 25}
ROUNDS = 9
TURNS = 3
"""Rounds of films."""
MORE = 12.0
"""ms by which ``Trace.draw`` may exceed twice the kernel of the bench."""
FRAMES = 15
CROWD = 4000
PEERS = ("blob40", "blob4000", "gyroid", "barth_sextic", "kummer", "steiner", "ball on plane")
"""Scenes that ``povray`` has."""


def crowd(count: int) -> dict[str, Any]:
    """So many blobs in the ball of blob40's centers, smaller so that their volumes together are as those."""
    generator = np.random.default_rng(40)
    few = np.array(SCENES["blob40"]["parts"])
    centers = generator.normal(size=(count, 3))
    away = np.linalg.norm(few[:, :3], axis=1).max() * generator.uniform(size=(count, 1)) ** (1 / 3)
    centers *= away / np.linalg.norm(centers, axis=1)[:, None]
    radii = generator.uniform(0.3, 0.45, (count, 1)) * (len(few) / count) ** (1 / 3)
    return SCENES["blob40"] | {"parts": np.concatenate([centers, radii], axis=1)}


SCENES["blob4000"] = crowd(CROWD)


def view(name: str) -> Any:
    """(5, 3): right, up and the way of the rays, the light, (pixel size, distance of the eye's plane, 0)."""
    a, b = np.radians(VIEW["pitch_deg"]), np.radians(VIEW["yaw_deg"])
    pitch = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    yaw = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    axes = (pitch @ yaw).T
    light = axes @ np.array(VIEW["light_view"]) / np.linalg.norm(VIEW["light_view"])
    clip, away = (SCENES[name]["clip"], 2.0) if name in SCENES else (4.0 / VIEW["window_height_over_clip"], 20.0)
    size = VIEW["window_height_over_clip"] * clip / HEIGHT
    return np.array([axes[:, 0], axes[:, 1], -axes[:, 2], light, [size, away * clip, 0.0]])


def tile_pixels() -> Any:
    """(2, 256): x and y of a tile's pixels; columns of 16 rays are blocks of 4 x 4, four of these one of 8 x 8."""
    ray = np.arange(256)
    block, own = ray % 16, ray // 16
    x, y = block & 1 | (block >> 1) & 2, (block >> 1) & 1 | (block >> 2) & 2
    return np.array([4 * x + own % 4, 4 * y + own // 4], dtype=np.float64)


class Picture:
    """A scene drawn again and again into the same arrays."""

    def __init__(self, name: str) -> None:
        self.tape, self.view, self.clip = scene_tape(name), view(name), SCENES[name]["clip"]
        self.ball = self.tape.code[-1:, 2]  # the row of the ball, by which rays are cut
        self.picture = np.zeros((HEIGHT, WIDTH), dtype=np.float32)
        self.depth = np.zeros((HEIGHT, WIDTH), dtype=np.float32)
        self.pixels = tile_pixels()
        x, y = self.pixels.astype(np.int64)
        turns = np.arange(256).reshape(16, 16).T.ravel()
        self.numbers = np.array([y * WIDTH + x, turns, turns, turns, turns])
        # Memory that goes from thread to thread goes from one core's cache to the other's, at every row.
        self.own = threading.local()

    def draw(self) -> Any:
        """(enclosures, certified, undecided) of all rays."""
        from implicit_picture_kernels import draw_row

        counts = np.zeros((-(-HEIGHT // 16), 3), dtype=np.int64)
        own = self.own

        # The middle first: what is quick fills up the time of both threads at the end.
        rows = sorted(range(len(counts)), key=lambda row: abs(2 * row + 1 - len(counts)))

        def work(tile: int) -> None:
            row = rows[tile]
            if not hasattr(own, "arrays"):
                slopes = lined((len(self.tape.code), 3, 64))
                own.arrays = Memory(self.tape, 256, self.ball), slopes, self.numbers.copy(), lined((3, 256))
            memory, slopes, numbers, starts = own.arrays
            rest = slopes, self.pixels, numbers, starts, self.view, self.clip, row, WIDTH
            arrays = self.picture.reshape(-1), self.depth.reshape(-1)
            counts[row] = draw_row(*memory.bundle, memory.found, *memory.rest, *rest, *arrays)

        over_tiles(len(counts), work)
        return counts.sum(axis=0)

    def wrong(self) -> int:
        """Pixels whose center disagrees with the certified routine."""
        size, far = self.view[4, :2]
        x = size * (np.arange(WIDTH) + 0.5 - 0.5 * WIDTH)
        y = size * (0.5 * HEIGHT - np.arange(HEIGHT) - 0.5)
        origins = x[None, :, None] * self.view[0] + y[:, None, None] * self.view[1] - far * self.view[2]
        origins = origins.reshape(-1, 3)
        along = -origins @ self.view[2]
        left = along**2 - (origins**2).sum(axis=1) + self.clip**2
        inside = np.flatnonzero(left > 0.0)
        reach = np.sqrt(left[inside])
        status, _ = cast(self.tape, origins[inside], self.view[2], along[inside] - reach, along[inside] + reach)
        met = np.zeros(WIDTH * HEIGHT, dtype=bool)
        met[inside] = (status == HIT) | (status == INSIDE)
        return int((met != (self.depth.ravel() >= 0.0)).sum())


def milliseconds(draw: Callable[[], object], threads: int, clock: Callable[[], float] = time.perf_counter) -> float:
    """Time of a picture among FRAMES in a row, as in a film: the median. POV-Ray has run before, and left other data in
    the processor's caches, and threads that slept are woken on one core and spread later."""
    os.environ["SCENEQL_THREADS"] = str(threads)
    times = []
    for _ in range(FRAMES):
        start = clock()
        draw()
        times.append(1e3 * (clock() - start))
    return statistics.median(times)


def medians(works: dict[str, Callable[[], float]], rounds: int = ROUNDS) -> dict[str, float]:
    """Of what works return, in rounds of one of each: what slows the machine down slows all of them."""
    found = [[work() for work in works.values()] for _ in range(rounds)]
    return dict(zip(works, map(statistics.median, zip(*found, strict=True)), strict=True))


def coefficients(name: str) -> str:
    """POV-Ray's polynomial of a scene: expanded from values, its order and coefficients."""
    order = {"barth_sextic": 6, "kummer": 4, "steiner": 4}[name]
    build = TapeBuilder()
    tape = build.finish(register(build, SCENES[name]["f"], SCENES[name].get("where", {})))
    powers = [p for p in product(range(order, -1, -1), repeat=3) if sum(p) <= order]
    grid = np.array(list(product(np.cos(np.pi * (np.arange(order + 1) + 0.5) / (order + 1)), repeat=3)))
    terms = np.prod(grid[:, None, :] ** np.array(powers)[None], axis=2)
    found = np.linalg.lstsq(terms, field_values(tape, grid), rcond=None)[0]
    return f"{order}, <{', '.join(f'{c:.12g}' for c in np.round(found, 11))}>"


def vector(v: Any) -> str:
    """A vector as POV-Ray writes it."""
    return f"<{', '.join(f'{x:.12g}' for x in v)}>"


def povray_object(name: str) -> str:
    """The object of a scene as POV-Ray has it: its own blob, sturm, isosurface with the true gradient."""
    if name == "ball on plane":
        return "sphere { 0, 1 pigment { rgb 1 } } plane { y, -1 pigment { rgb 1 } }"
    ball = f"sphere {{ 0, {SCENES[name]['clip']} }}"
    if name in ("blob40", "blob4000"):
        parts = "".join(f"sphere {{ {vector(row[:3])}, {row[3]:.12g}, 1 }}" for row in SCENES[name]["parts"])
        return f"blob {{ threshold 0.3 {parts} pigment {{ rgb 1 }} }}"
    if name == "gyroid":
        waves = "+".join(f"sin(20*{a})*cos(20*{b})" for a, b in ("xy", "yz", "zx"))
        function = f"max(sqrt(x*x+y*y+z*z)-0.9, abs({waves})-0.3)"
        return (
            f"isosurface {{ function {{ {function} }} contained_by {{ {ball} }} max_gradient 35 pigment {{ rgb 1 }} }}"
        )
    return f"intersection {{ poly {{ {coefficients(name)} sturm }} {ball} pigment {{ rgb 1 }} }}"


def povray(name: str, threads: int) -> tuple[float, float]:
    """ms in which POV-Ray traces a scene once, and ms of processor time of its whole run, which writes a PNG file."""
    right, up, way, light, (size, far, _) = view(name)
    camera = f"location {vector(-far * way)} right {vector(WIDTH * size * right)} up {vector(HEIGHT * size * up)}"
    text = (
        "#version 3.7; global_settings { assumed_gamma 1 }"
        f" camera {{ orthographic {camera} direction {vector(way)} }}"
        f" light_source {{ {vector(1e4 * light)}, rgb 1 parallel point_at 0 }} {povray_object(name)}"
    )
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "scene.pov").write_text(text, encoding="utf-8")
        command = [
            "povray",
            "+Iscene.pov",
            "+Oscene.png",
            "+FN",
            "-D",
            "-F",
            "-A",
            f"+W{WIDTH}",
            f"+H{HEIGHT}",
            f"+WT{threads}",
        ]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        found = re.search(r"Trace Time:.*?\(([\d.]+) seconds\)", run.stderr, re.DOTALL)
        if found is None:
            raise RuntimeError(run.stderr[-2000:])
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        whole = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return 1e3 * float(found[1]), 1e3 * whole


def films(names: list[str]) -> dict[str, float]:
    """The table of films: with light that surfaces reflect onto others, as films are by default, and without.

    Returns ms of ``Trace.draw`` alone in a frame without that light, by name.
    """
    os.environ["SCENEQL_THREADS"] = "1"
    drawn: dict[str, float] = {}
    for name, text in scripts({name: SCENES[name] for name in SCENES if name in names}):
        scene = name.split(" moving")[0]
        same, soft = like_for_like(text), softly(text)
        film(same)  # compiles

        def alone(name: str = name, same: str = same) -> float:
            found = film(same)
            drawn[name] = min(drawn.get(name, np.inf), found[DRAW])
            return found["all"]

        film(soft)
        peer = (lambda scene=scene: povray(scene, 1)[1]) if scene in PEERS and shutil.which("povray") else None
        works = {"default": lambda text=text: film(text)["all"], "same": alone}
        works["soft"] = lambda text=soft: film(text)["all"]
        took = medians(works | ({"peer": peer} if peer else {}), TURNS)
        line = f"{name:15} {took['same']:7.1f} ms of one processor a frame, {drawn[name]:.1f} of these {DRAW}"
        if peer:
            line += f", POV-Ray {took['peer']:.0f} ms, ratio {took['peer'] / took['same']:.1f}"
        line += f"; {took['default']:.1f} ms with light of surfaces"
        print(f"{line}, {took['soft']:.1f} ms softly lit, glossy over a floor", flush=True)
        for way, script in (("", same), ("with light of surfaces: ", text), ("softly lit: ", soft)):
            stages = film(script, by_stages=True)
            print(
                f"    {way}{', '.join(f'{stage} {ms:.1f}' for stage, ms in stages.items() if stage != 'all')}",
                flush=True,
            )
    return drawn


def threads(names: list[str]) -> None:
    """The table of gains: with light that surfaces reflect onto others, and without."""
    for name, text in scripts({name: SCENES[name] for name in SCENES if name in names}):
        for way, script in (("", like_for_like(text)), (" with light of surfaces", text)):
            seconds, by_threads, by_processes = gains(script, TURNS)
            print(
                f"{name}{way}: {1e3 * seconds / FILM:.1f} ms a frame by one thread; gain by two threads"
                f" {by_threads:.2f}, by two processes {by_processes:.2f}, ratio {by_threads / by_processes:.2f};"
                f" load {os.getloadavg()[0]:.1f}",
                flush=True,
            )


def compare(names: list[str], checkout: str) -> None:
    """The table of softly lit films beside those of another checkout, which may not know `diffuse_bounces`."""
    for name, text in scripts({name: SCENES[name] for name in SCENES if name in names}):
        script = softly(text).replace(", diffuse_bounces: 256", "")
        here, there = (1e3 * seconds / FILM for seconds in before(script, checkout, TURNS))
        print(
            f"{name}: {here:.1f} ms of one processor a frame softly lit, {there:.1f} before: {there / here:.2f} times"
        )


def main(names: list[str]) -> None:
    """The tables."""
    drawn = films(names)
    for name in names:
        picture = Picture(name)
        spent, certified, undecided = picture.draw()
        works = {
            "one": lambda picture=picture: milliseconds(picture.draw, 1),
            "two": lambda picture=picture: milliseconds(picture.draw, 2),
        }
        here = name in BARS and shutil.which("povray")
        if here:
            works |= {f"peer {k}": lambda name=name, k=k: povray(name, k)[0] for k in (1, 2)}
        took = medians(works)
        one, two = took["one"], took["two"]
        rays = WIDTH * HEIGHT
        line = f"{name:13} {one:6.1f} / {two:5.1f} ms (1 / 2 threads), {spent / rays:.1f} enclosures a pixel,"
        line += f" {certified} rays certified, {undecided} undecided, {picture.wrong()} wrong"
        if name in drawn:
            kernel = milliseconds(picture.draw, 1, time.process_time)
            line += f"; {DRAW} {drawn[name]:.1f} ms of one processor (bar {2.0 * kernel + MORE:.1f})"
        if name in BARS:
            peer = (took["peer 1"], took["peer 2"]) if here else POV_ELSEWHERE[name]
            line += f"; POV-Ray {'here' if here else 'elsewhere'} {peer[0]:.0f} / {peer[1]:.0f} ms:"
            line += f" ratio {peer[0] / one:.1f} / {peer[1] / two:.1f} (bar {BARS[name]})"
        print(line + quoted("pictures", name, one), flush=True)
    for who, text in ELSEWHERE["flaws"].items():
        print(f"{who} elsewhere: {text}")


if __name__ == "__main__":
    names = [name for name in sys.argv[1:] if not name.startswith("--")]
    if "--tape" in sys.argv:
        packets.plan_of = lambda tape: np.array([-1, 0, -1, -1])
        BARS = {name: bar / 2 for name, bar in BARS.items()}
    table: Callable[[list[str]], None] = threads if "--threads" in sys.argv else main
    for option in sys.argv:
        if option.startswith("--before="):
            table = partial(compare, checkout=option.partition("=")[2])
    table(names or ["blob40", "blob4000", "gyroid", "barth_sextic", "kummer", "steiner", "shell"])
