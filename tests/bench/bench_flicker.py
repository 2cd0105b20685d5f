"""Pixels of the scenes' films that flicker: brighter or darker in one frame than in the ones before and after.

Run as ``python tests/bench/bench_flicker.py [SCENE ...]``. At INSTANTS of each film three frames are drawn, 320 x 180,
without overlays and without soft discs and mist, which take no samples. A pixel flickers that goes up and back, or down
and back, by more than LEVELS of 255 in a channel. Not counted are moving edges: pixels with a neighbor whose surface,
normal or color changes from frame to frame, seen at once or in a mirror or through glass, or where that of a finer
pixel within it changes; where a thin line is; and where more than EDGE of a lamp comes or goes, at edges of shadows.
Nor is what truly goes back and forth, in pictures of FINER times as many pixels along each side too: the pixel must go
as far beyond these, the same way. Prints the share of a film's pixels, and that of its worst instant.
"""

from __future__ import annotations

import itertools
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast
from unittest import mock

import numpy as np
from scipy.ndimage import maximum_filter

from renderers.develop import develop
from renderers.tracing import draw as tracer
from renderers.tracing.buffers import _kept
from renderers.tracing.light.visibility_kernels import FIRST_LIGHT
from renderers.tracing.record_kernels import NORMAL, OWNER, TINT, UNSURE
from sceneql import pipeline
from sceneql.frame import Mist, Points
from sceneql.kinds import Picture

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from renderers.tracing.picture import Picture as Traced
    from sceneql.frame import SeenFrame

SIZE = (320, 180)
INSTANTS = (0.15, 0.4, 0.65, 0.9)
"""Parts of a film at which three frames are drawn."""
LEVELS, FINER = 3, 3
TURNED, DYED, EDGE = 0.02, 0.02, 0.25
"""Changes of a normal, of a surface's color and of the seen share of a lamp from which on a pixel moves."""


class Drawn:
    """Pixels (h, w, 3) of one panel, what they show (2, h, w, columns), at once and behind that, and lamps' shares."""

    def __init__(self, frame: SeenFrame, picture: Traced) -> None:
        self.frame = frame
        width, height = frame.view.size
        (buffers,) = _kept
        self.linear = picture.linear
        self.pixels = develop(picture.linear).astype(np.int64)
        self.records = _layers(buffers.records, height, width)
        self.shares = _layers(buffers.visibility, height, width)[..., FIRST_LIGHT::2]

    def finer(self) -> Drawn:
        """The same of FINER times as many pixels along each side."""
        width, height = self.frame.view.size
        frame = replace(self.frame, view=replace(self.frame.view, size=(FINER * width, FINER * height)))
        return Drawn(frame, tracer.draw(frame))

    def averaged(self) -> NDArray[Any]:
        """(h / FINER, w / FINER, 3): means of FINER x FINER pixels."""
        return develop(_blocks(self.linear).mean(axis=(1, 3))).astype(np.int64)


def _layers(values: NDArray[Any], height: int, width: int) -> NDArray[Any]:
    """(2, h, w, columns): a copy; the second layer is zero where nothing mirrors or refracts and there is one alone."""
    both = np.zeros((2, height, width, values.shape[-1]), dtype=values.dtype)
    both[: len(values)] = values.reshape(len(values), height, width, -1)
    return both


def _blocks(pixels: NDArray[Any]) -> NDArray[Any]:
    """(h / FINER, FINER, w / FINER, FINER, ...): pixels (h, w, ...) in blocks."""
    height, width = pixels.shape[:2]
    return pixels.reshape(height // FINER, FINER, width // FINER, FINER, *pixels.shape[2:])


def back_and_forth(before: NDArray[Any], now: NDArray[Any], after: NDArray[Any]) -> NDArray[Any]:
    """(h, w, 3): 1 where a channel goes up and back by more than LEVELS, -1 where down and back, else 0."""
    up, down = now - before, now - after
    back = (np.sign(up) == np.sign(down)) & (np.minimum(np.abs(up), np.abs(down)) > LEVELS)
    return np.where(back, np.sign(up), 0)


def moved(before: Drawn, after: Drawn) -> NDArray[np.bool_]:
    """(h, w): whether pixels show other things after than before."""
    a, b = before.records, after.records
    there = (a[..., OWNER] > 0) & (b[..., OWNER] > 0)
    change = np.abs(b - a)
    turned = change[..., NORMAL : NORMAL + 3].max(axis=-1) > TURNED
    dyed = change[..., TINT : TINT + 3].max(axis=-1) > DYED
    shaded = np.abs(after.shares - before.shares).max(axis=-1, initial=0.0) > EDGE
    thin = (a[0, ..., UNSURE] < 0) | (b[0, ..., UNSURE] < 0)
    other: NDArray[np.bool_] = ((a[..., OWNER] != b[..., OWNER]) | there & (turned | dyed | shaded)).any(axis=0) | thin
    return other


def flickers(before: Drawn, now: Drawn, after: Drawn) -> NDArray[np.bool_]:
    """(h, w): whether pixels flicker in the middle one of three frames."""
    shown = back_and_forth(before.pixels, now.pixels, after.pixels)
    shown[maximum_filter(moved(before, now) | moved(now, after), 3)] = 0
    if shown.any():
        fine = [one.finer() for one in (before, now, after)]
        for a, b in itertools.pairwise(fine):
            shown[_blocks(moved(a, b)).any(axis=(1, 3))] = 0
        true = [one.averaged() for one in fine]
        shown *= back_and_forth(before.pixels - true[0], now.pixels - true[1], after.pixels - true[2]) == shown
    found: NDArray[np.bool_] = shown.any(axis=-1)
    return found


def triples(scene: Path) -> Iterator[list[list[Drawn]]]:
    """The panels of three frames at each of the instants, of the scene's first output that draws."""
    graph = pipeline.load(scene)
    name, task = next((name, task) for name, task in graph.tasks.items() if isinstance(task.kind, Picture))
    small = cast(Picture, task.kind).model_copy(update={"size": SIZE})
    tools = pipeline.Tools(graph, name, pipeline.Report(), Path())
    times = small.times(graph.settings.clock)[:: small.parts]
    starts = sorted({min(int(part * len(times)), len(times) - 3) for part in INSTANTS if len(times) > 2})
    wanted = [times[start + k] for start in starts for k in range(3)]
    drawn: list[Drawn] = []
    draw = tracer.draw

    def kept(frame: SeenFrame, *rest: Any, **more: Any) -> Traced:
        sampled = tuple(s for s in frame.shapes if not (isinstance(s, Mist) or (isinstance(s, Points) and s.soft)))
        frame = replace(frame, shapes=sampled)
        picture = draw(frame, *rest, **more)
        drawn.append(Drawn(frame, picture))
        return picture

    frames: list[list[Drawn]] = []
    with mock.patch.object(tracer, "draw", kept):
        for moment in pipeline.simulate(graph, sorted(set(wanted)), [small]):
            drawn.clear()
            tools.pixels(small, moment)
            frames.append(list(drawn))
    at = dict(zip(sorted(set(wanted)), frames, strict=True))
    for start in starts:
        yield [at[times[start + k]] for k in range(3)]


def main() -> None:
    """Print the table."""
    print(f"{'scene':<18}{'all [%]':>9}{'worst [%]':>11}{'s':>8}")
    scenes = [Path(name) for name in sys.argv[1:]] or sorted(Path("scenes").glob("*.yaml"))
    for scene in scenes:
        started = time.perf_counter()
        shares = []
        for triple in triples(scene):
            masks = [flickers(*panel) for panel in zip(*triple, strict=True)]
            if masks:
                shares.append(sum(mask.sum() for mask in masks) / sum(mask.size for mask in masks))
        took = time.perf_counter() - started
        if shares:
            print(f"{scene.stem:<18}{100 * np.mean(shares):>9.3f}{100 * max(shares):>11.3f}{took:>8.1f}", flush=True)
        else:
            print(f"{scene.stem:<18}{'no film that is traced':>28}", flush=True)


if __name__ == "__main__":
    main()
