"""The gallery: posters and expected numbers of all scenes, compared with what the program makes now."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

from sceneql import pipeline
from sceneql.failure import Unsuitable
from sceneql.files import refuse_unwritable, try_folder, whole
from sceneql.graph import SimulationGraph
from sceneql.kinds import Picture
from sceneql.report.expect import Outcome, outcomes

MEAN, NEARLY_ALL, LARGEST = 0.002, 0.05, 0.2
"""Bounds below which two posters count as the same: mean difference, that of 99.9 % of the pixels, and the largest.

A pixel's difference is that of its most different channel, from 0 to 1. The three bounds distinguish rounding by
another processor (everywhere, tiny) from damage (local, large)."""


def scenes_of(scenes: tuple[Path, ...]) -> list[Path]:
    """The scripts given, else those of the folder ``scenes``."""
    return list(scenes) or sorted(Path("scenes").glob("*.yaml"))


def poster(graph: SimulationGraph) -> Any:
    """The gallery's picture (h, w, 3) uint8 of the first output that draws."""
    settings = graph.settings.gallery
    pictures = [(name, task) for name, task in graph.tasks.items() if isinstance(task.kind, Picture)]
    if not pictures:
        raise Unsuitable(f"{graph.name} makes no picture, so there is nothing for a gallery to keep")
    name, task = pictures[0]
    small = cast(Picture, task.kind).model_copy(update={"size": settings.size})
    tools = pipeline.Tools(graph, name, pipeline.Report(), Path())
    (moment,) = pipeline.simulate(graph, [min(settings.time, graph.settings.clock.end)], [small])
    return tools.pixels(small, moment)


def numbers(scene: Path) -> list[Outcome]:
    """Outcomes of the scene's expectations, each in its own variant."""
    variants = dict.fromkeys(expect.variant for expect in pipeline.load(scene).settings.expect.values())
    graphs = ((pipeline.load(scene, variant=variant, pruned=False), variant) for variant in variants)
    return [found for graph, variant in graphs for found in outcomes(graph, variant)]


def check(scenes: tuple[Path, ...], folder: Path) -> tuple[list[str], bool]:
    """A line for every poster and number, and whether all are as they should be."""
    lines, same = [], True
    for scene in scenes_of(scenes):
        kept = folder / f"{scene.stem}.png"
        verdict, equal = compare(poster(pipeline.load(scene)), kept)
        lines.append(f"{scene.stem}: {verdict}")
        same &= equal
        for found in numbers(scene):
            lines.append(f"  {found}")
            same &= found.holds
    return lines, same


def compare(picture: Any, kept: Path) -> tuple[str, bool]:
    """Description of the difference between a picture and a kept one, and whether they count as the same."""
    import numpy as np
    from PIL import Image

    if not kept.is_file():
        return f"DIFFERS: no poster is kept as {kept}", False
    old = np.asarray(Image.open(kept).convert("RGB"))
    if old.shape != picture.shape:
        return f"DIFFERS: the size is {picture.shape[1]} x {picture.shape[0]}", False
    if old.tobytes() == picture.tobytes():
        return "ok, the same bytes", True
    off = np.abs(old.astype(float) - picture).max(axis=-1) / 255
    most = float(np.quantile(off, 0.999))
    equal = bool(off.mean() < MEAN and most < NEARLY_ALL and off.max() < LARGEST)
    verdict = "ok, nearly the same" if equal else "DIFFERS"
    return f"{verdict}: mean {off.mean():.4f}, 99.9 % {most:.3f}, largest {off.max():.3f}", equal


def update(scenes: tuple[Path, ...], folder: Path) -> list[str]:
    """Replace the kept posters and their sections of the page; sections of other scenes stay.

    Numbers are never updated: scripts say what they must be.
    """
    from io import BytesIO

    from PIL import Image

    page = folder / "README.md"
    try_folder(folder)
    lines, sections = [], _sections(page) if scenes else {}
    for scene in scenes_of(scenes):
        graph = pipeline.load(scene)
        refuse_unwritable(folder / f"{scene.stem}.png", graph.origin.files)
        data = BytesIO()
        Image.fromarray(poster(graph)).save(data, "png")
        with whole(folder / f"{scene.stem}.png") as stream:
            stream.write(data.getvalue())
        lines.append(f"kept {folder / scene.stem}.png")
        told = [graph.settings.about, "", f"![{scene.stem}]({scene.stem}.png)", ""]
        sections[scene.stem] = "\n".join([*told, *(f"- {found}" for found in numbers(scene))]).strip("\n")
    with whole(page) as stream:
        stream.write((TITLE + "".join(f"{HEADING}{name}\n\n{sections[name]}\n" for name in sorted(sections))).encode())
    return [*lines, f"wrote {page}"]


TITLE = "# Gallery\n\nMade by `sceneql gallery update`; compared by `sceneql gallery check`.\n"
HEADING = "\n## "


def _sections(page: Path) -> dict[str, str]:
    """The sections of a page, by scene."""
    if not page.is_file():
        return {}
    _, *parts = page.read_text(encoding="utf-8").split(HEADING)
    return {name: text.strip("\n") for name, _, text in (part.partition("\n") for part in parts)}
