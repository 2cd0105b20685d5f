"""The part of `bench` on implicit surfaces: rays and meshes, as lines, tables, plots and files."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sceneql.files import whole
from sceneql.frame import Implicit
from sceneql.report.page import Table, beside
from sceneql.report.plots import as_png, surface_errors
from sceneql.report.surface_measures import MeshRun, RayRun, mesh_runs, ray_runs

if TYPE_CHECKING:
    from sceneql.frame import SeenFrame


@dataclass(frozen=True, slots=True)
class Section:
    """A part of a report: lines of text, tables, plots by caption, files written, and all of it as plain data."""

    lines: Sequence[str]
    tables: Sequence[Table]
    plots: Sequence[tuple[str, Path]]
    files: Sequence[Path]
    data: dict[str, Any]


def surface_section(frames: Sequence[SeenFrame], title: str, stem: Path) -> Section:
    """Measure the implicit objects of a picture in several sizes; write CSVs and a plot beside ``stem``."""
    by_size = [list(ray_runs(frame)) for frame in frames]
    rays = [run for runs in by_size for run in runs]
    solids = [shape for shape in frames[0].shapes if isinstance(shape, Implicit) and shape.within is None]
    meshes = [run for solid in solids for run in mesh_runs(solid)]
    lines = [line for runs in by_size for line in (size_line(runs[0]), *map(ray_line, runs))]
    lines += map(mesh_line, meshes)
    files = [beside(stem, "rays.csv"), beside(stem, "meshes.csv")]
    for path, kind, runs in ((files[0], RayRun, rays), (files[1], MeshRun, meshes)):
        write_rows(path, kind, runs)
    plot = beside(stem, "surfaces.svg")
    surface_errors(plot, title, rays, meshes)
    tables = [table_of("Rays", RayRun, rays), *([table_of("Meshes", MeshRun, meshes)] if meshes else [])]
    data = {"surfaces": {"rays": [asdict(run) for run in rays], "meshes": [asdict(run) for run in meshes]}}
    return Section(lines, tables, [("Implicit surfaces", plot)], [*files, plot, as_png(plot)], data)


def size_line(run: RayRun) -> str:
    """The picture of a run and others as a line of text."""
    size = f"{run.width} x {run.height}"
    return f"implicit surfaces at {size}, {run.pixels} pixels of them: rays against certified intervals"


def ray_line(run: RayRun) -> str:
    """A run as a line of text."""
    setting = f"tolerance {run.setting:.0e}" if run.renderer == "trace" else f"{run.setting:.0f} samples"
    return (
        f"  {run.renderer:<6} {setting:<17} {run.wrong:6d} wrong pixels, {run.undecided} undecided;"
        f" depth {run.depth_error:.1e} m, normal {run.normal_error:.1e} rad; {run.seconds * 1e3:.1f} ms"
    )


def mesh_line(run: MeshRun) -> str:
    """A run as a line of text."""
    away = "the finest" if math.isnan(run.hausdorff) else f"Hausdorff {run.hausdorff:.1e} m"
    return (
        f"  mesh of {run.name}, cells of {run.cell:.3g} m: {away}; volume {run.volume:.6g} m^3"
        f" ({run.volume_error:.1e}), area {run.area:.6g} m^2 ({run.area_error:.1e}),"
        f" Euler characteristic {run.euler}; {run.seconds * 1e3:.1f} ms"
    )


def table_of(caption: str, kind: type, runs: Sequence[Any]) -> Table:
    """A table of runs, which are instances of one dataclass."""
    head = [item.name.replace("_", " ") for item in fields(kind)]
    return Table(caption, head, [[(_cell(value), "") for value in asdict(run).values()] for run in runs])


def _cell(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def write_rows(path: Path, kind: type, runs: Sequence[Any]) -> None:
    """Write runs, which are instances of one dataclass, as CSV."""
    text = io.StringIO()
    writer = csv.DictWriter(text, [item.name for item in fields(kind)], lineterminator="\n")
    writer.writeheader()
    writer.writerows(asdict(run) for run in runs)
    with whole(path) as file:
        file.write(text.getvalue().encode())
