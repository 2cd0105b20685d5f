"""The one file that joins the stages: load, compile, simulate, render. Also the public Python interface.

import sceneql.pipeline as sceneql
graph = sceneql.load("scenes/first.yaml")
report = sceneql.render(graph)
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, suppress
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import BaseModel

from sceneql import doing
from sceneql.compiler.catalogue import Catalogue
from sceneql.compiler.check import KEYS
from sceneql.compiler.compile import compile_script
from sceneql.failure import (
    LimitRefused,
    OutOfMemory,
    OutOfTime,
    RunFailure,
    Unsuitable,
    failing_itself,
    starved,
    want_of_memory,
)
from sceneql.files import NUMBERS, refuse_unwritable, try_folder
from sceneql.graph import SimulationGraph
from sceneql.interrupts import held, keeping, within
from sceneql.kinds import FAMILIES, Camera, Kind, Model, Output, Picture
from sceneql.language.patch import Patch
from sceneql.language.script import read_script
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError
from sceneql.tools import Report, Tools, frame_of, shapes_of

if TYPE_CHECKING:
    from sceneql.run.instant import Instant
    from sceneql.run.run import Run

__all__ = ["Report", "Tools", "frame_of", "load", "render", "shapes_of", "simulate"]


def load(
    path: Path | str,
    *,
    variant: str | None = None,
    sets: Sequence[str | Patch] = (),
    words: Path | None = None,
    pruned: bool = True,
) -> SimulationGraph:
    """Read, check and compile a script; ``sets`` are patches or ``path=value``. Raises ScriptError with all errors."""
    found = Diagnostics()
    families = tuple(kind.family for kind in FAMILIES)
    script = read_script(Path(path), variant, sets, families=families, settings=KEYS, found=found)
    graph = compile_script(script, Catalogue(words), found, pruned=pruned)
    of_name = cache(lambda name: load(path, variant=name, sets=sets, words=words, pruned=pruned))
    return replace(graph, variants=replace(graph.variants, load=of_name, this=variant or ""))


def errors_of_layout(graph: SimulationGraph) -> list[Diagnostic]:
    """The errors that fields alone do not show: those of islands that `check` lays out (Kind.told_by_layout)."""
    found: list[Diagnostic] = []
    for island in graph.islands:
        if any(graph.tasks[name].kind.told_by_layout() for name in island.models):
            from sceneql.march.assembled import models_of

            made = models_of(graph, island, marched=False)
            if not made.found.errors:
                made.act()
            found += made.found.found
    return found


def simulate(
    graph: SimulationGraph, times: Iterable[float], outputs: Sequence[Output] | None = None
) -> Iterator[Instant]:
    """The moments of a run at increasing instants [s], for some outputs or for any use. Raises RunFailure."""
    from sceneql.run.run import Run

    marching = outputs is None or any(_shows_script(graph, kind) for kind in outputs)
    return Run(graph, marching=marching).moments(times)


def render(
    graph: SimulationGraph,
    *,
    output: Path | None = None,
    folder: Path | None = None,
    account: bool = False,
    draft: bool = False,
    limit: float | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Report:
    """Run a graph and make its outputs, in one pass over the union of their times.

    ``output`` overrides the file of a single output; with ``account`` energies are observed in every frame; with
    ``draft`` pictures are drawn coarsely; after ``limit`` seconds the run fails. After a failure, what was made is kept
    beside the final names, listed in ``error.kept`` of the exception. Raises RunFailure, LimitRefused, OSError, and
    Unsuitable for one file with several outputs and for drafts of a renderer that has none.
    """
    started, compiled = time.perf_counter(), _compiled()
    report = Report()
    outputs = {name: task.kind for name, task in graph.tasks.items() if isinstance(task.kind, Output)}
    if output is not None and len(outputs) > 1:
        raise Unsuitable(f"one file is named, but the script has {len(outputs)} outputs: {', '.join(outputs)}")
    if output is not None:
        refuse_unwritable(output, marks=NUMBERS)
        if not output.parent.is_dir():
            raise FileNotFoundError(f"there is no folder {output.parent}")
    times = {name: kind.times(graph.settings.clock) for name, kind in outputs.items()}
    instants = sorted(set().union(*times.values()))
    tools = {
        name: Tools(
            graph, name, report, _target(graph, name, len(outputs), output, folder or Path()), output is not None, draft
        )
        for name in outputs
    }
    for tool in tools.values():
        try_folder(tool.target.parent)
    sinks: dict[str, Any] = {}
    parts = [name for name, task in graph.tasks.items() if isinstance(task.kind, Model)] or [*outputs]
    now, busy = 0.0, _Busy("starting the run", parts)
    run: Any = None
    ending = ExitStack()
    late = ending.enter_context(within(limit, lambda: doing.now(0.0)))
    ending.enter_context(keeping(lambda: [*report.files, *_kept(sinks, KeyboardInterrupt())]))
    try:
        late.begin()
        for name, kind in outputs.items():
            if isinstance(kind, Picture):
                tools[name].prepare(kind)
        for name, kind in outputs.items():
            with failing_itself(name, now, graph.tasks[name].span):
                sinks[name] = kind.open(tools[name])
        wanted = {name: set(at) for name, at in times.items()}
        from sceneql.run.blind import warnings as blind
        from sceneql.run.covered import warnings as covered
        from sceneql.run.never_drawn import decided_by_rounding, missing
        from sceneql.run.run import Run
        from sceneql.run.watch import Watch

        run = Run(graph, marching=any(_shows_script(graph, kind) for kind in outputs.values()))
        watch = Watch(run, always=account)
        if run.islands and instants and instants[0] > 0.0:
            watch.look(run.at(0.0))  # what is gained is gained over the start
        busy = solving = _Busy("solving", parts)
        for done, moment in enumerate(run.moments(instants)):
            progress(done, len(instants))
            late.look()  # its signal is lost in a callback of a C library
            if done == 1:
                gc.freeze()  # what lives by now lives on, and is not looked over in every collection
            watch.look(moment, last=done == len(instants) - 1)
            now = moment.time
            for name, sink in sinks.items():
                if moment.time in wanted[name]:
                    busy = _Busy("making the frame", [name])
                    with failing_itself(name, now, graph.tasks[name].span):
                        sink.take(moment)
            busy = solving
        progress(len(instants), len(instants))
        runs = [run, *(panel.run for tool in tools.values() for panel in tool.panels.values())]
        report.steps = sum(island.march.statistics.steps for one in runs for island in one.islands)
        for name in outputs:
            busy = _Busy("finishing the file", [name])
            with held(), failing_itself(name, now, graph.tasks[name].span):
                report.files += sinks[name].close()
                del sinks[name]
    except BaseException as error:
        told = _out_of_memory(error, graph, now, busy) if starved(error) else error
        if late.passed and not isinstance(error, RunFailure | LimitRefused | ScriptError):
            told = _out_of_time(graph, run, now, busy, f"the limit of {limit:g} s has passed", late.doing)
        with suppress(KeyboardInterrupt), held():
            told.kept = [*report.files, *_kept(sinks, told)]  # type: ignore[attr-defined]
        if told is not error:
            raise told from error
        raise
    finally:
        gc.unfreeze()
        ending.close()
    report.warnings = (*missing(report.present, graph.tasks), *decided_by_rounding(report.rounded, graph.tasks))
    report.warnings += (*watch.warnings(), *run.warnings(), *_diverged(runs))
    report.warnings += (*blind(report.within, graph.tasks, graph.warnings), *covered(report.covered, graph.tasks))
    report.conserved = watch.account()
    seconds, count = _compiled()
    report.compile_seconds, report.compilations = seconds - compiled[0], count - compiled[1]
    report.run_seconds = time.perf_counter() - started - report.compile_seconds
    return report


def _diverged(runs: Iterable[Run]) -> Iterable[Diagnostic]:
    """A warning for each variant that the panels of others leave out."""
    return {one.graph.variants.this: one.warning() for run in runs for one in run.diverged}.values()


class _Busy(NamedTuple):
    """The present activity of a run, and the parts concerned."""

    doing: str
    parts: Sequence[str]


LESS = {"size": "smaller", "count": "smaller", "samples": "smaller", "cell": "larger", "spacing": "larger"}
"""Fields that determine how much memory a part takes, and in which direction it takes less."""


def _out_of_memory(error: BaseException, graph: SimulationGraph, now: float, busy: _Busy) -> OutOfMemory:
    """A lack of memory as a failure of the present activity, with the fields that would take less as help."""
    part, span, message = ", ".join(busy.parts) or graph.name, None, want_of_memory(error)
    if isinstance(error, RunFailure):
        part, span, now, message = error.part, error.span, error.time, error.message
    message = f"{message}, when {busy.doing}"
    names = dict.fromkeys((*busy.parts, part.partition(".")[0]))
    tasks = [graph.tasks[name] for name in names if name in graph.tasks]
    large = [(task.name, field, LESS[field.rpartition(".")[2]]) for task in tasks for field in _large(task.kind)]
    less = " or ".join(f"a {size} `{field}` of '{name}'" for name, field, size in large)
    help = f"{less} takes less" if less else None
    return OutOfMemory(message, part=part, time=now, span=span or (tasks[0].span if tasks else None), help=help)


def _out_of_time(
    graph: SimulationGraph, run: Run | None, now: float, busy: _Busy, message: str, doing: str
) -> OutOfTime:
    """The failure at the time limit: of the island that is farthest behind, else of the present activity."""
    part = busy.parts[0] if busy.parts else graph.name
    if run is not None and run.islands and busy.doing == "solving":
        behind = min(run.islands, key=lambda island: island.march.time)
        part, now = next(iter(behind.island.models)), behind.march.time
    span = graph.tasks[part].span if part in graph.tasks else None
    drawn = busy.doing == "making the frame" and not doing.startswith("solving")  # as where a film is run ahead of
    less = "a smaller `size` and `--draft`" if drawn else "larger steps and coarser models"
    help = f"allow more by `--limit`; {less} take less"
    return OutOfTime(f"{message}, when {doing or busy.doing}", part=part, time=now, span=span, help=help)


def _large(record: BaseModel) -> Iterator[str]:
    """The fields of a word, or of a record in it, that determine how much memory it takes."""
    for name in type(record).model_fields:
        value = getattr(record, name)
        if name in LESS and value is not None:
            yield name
        elif isinstance(value, BaseModel) and not isinstance(value, Kind):
            yield from (f"{name}.{inner}" for inner in _large(value))


def _shows_script(graph: SimulationGraph, output: Output) -> bool:
    """Whether an output shows the script itself, and not only its variants."""
    if not isinstance(output, Picture) or not output.layout:
        return True
    return any(isinstance(graph.tasks[ref.name].kind, Camera) for ref in output.laid_out)


def _kept(sinks: dict[str, Any], error: BaseException) -> list[Path]:
    """Abort open outputs and return the files kept.

    Errors here are noted: the error that stopped the run is the one to tell.
    """
    kept: list[Path] = []
    for name, sink in sinks.items():
        try:
            kept += sink.abort()
        except Exception as second:
            same = second in (error, error.__cause__)
            error.add_note(f"nothing of '{name}' could be kept" + ("" if same else f": {second}"))
    return kept


def _compiled() -> tuple[float, int]:
    """Seconds and number of the process's compilations."""
    import sys

    kernels = sys.modules.get("sceneql.compiled.kernels")
    return (0.0, 0) if kernels is None else (kernels.compiled.seconds, kernels.compiled.count)


def _target(graph: SimulationGraph, name: str, count: int, output: Path | None, folder: Path) -> Path:
    """Path without extension (its own, if the user gave one)."""
    if output is not None:
        return output
    return folder / (graph.name if count == 1 else f"{graph.name}.{name}")
