"""The command line. Nothing but click is imported before a command runs.

Its exit codes are in exits.py.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from sceneql import __version__, interrupts, room
from sceneql.exits import GALLERY_DIFFERS, OK, failed, stopped
from sceneql.options import ABOVE_ZERO, SCENE, as_length, as_path, as_seconds, as_target, as_words, meant, options

if TYPE_CHECKING:
    from pathlib import Path

    from sceneql.graph import SimulationGraph


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="sceneql")
def cli() -> None:
    """A compiler from scene scripts to films."""
    from sceneql.compiled import variables
    from sceneql.failure import Unsuitable

    try:
        variables.check()
    except ValueError as error:
        raise Unsuitable(str(error)) from error


def main() -> None:
    """The entry point of the program: exceptions become messages and exit codes."""
    interrupts.end_at_once()
    _without_plugins()
    _without_overflows()
    room.ask_before_imports()
    try:
        with interrupts.raised(stopped) as interrupted:
            code = _run(interrupted)
    except KeyboardInterrupt as error:
        code = stopped(error)
    interrupts.end_at_once(code)  # there is nothing more to keep
    sys.exit(code)


def _run(interrupted: Callable[[], bool]) -> int:
    try:
        code = cli.main(prog_name="sceneql", standalone_mode=False)
    except click.exceptions.Abort as abort:
        if isinstance(abort.__cause__, EOFError):  # click takes it for the end of what is typed
            return failed(abort.__cause__)
        return stopped(abort.__cause__)
    except click.ClickException as error:
        error.show()
        if (help := meant(error)) is not None:
            click.echo(f"help: {help}", err=True)
        return error.exit_code
    except Exception as error:
        return stopped(error) if interrupted() else failed(error)
    return code if isinstance(code, int) else OK


def _without_plugins() -> None:
    """Hide plugins from pydantic: the imports of its search for them take longer than reading a scene."""
    from types import ModuleType

    loader = ModuleType("pydantic.plugin._loader")
    loader.get_plugins = tuple  # type: ignore[attr-defined]  # a module of our own making
    sys.modules[loader.__name__] = loader


def _without_overflows() -> None:
    """Hide NumPy's warnings of overflows: parts that have no finite value tell so themselves, at their place."""
    if not sys.warnoptions:
        warnings.simplefilter("ignore", RuntimeWarning)


@cli.command()
@SCENE
@options
@click.option(
    "-o", "--output", "target", callback=as_target, metavar="PATH",
    help="File to make, for a script with one output; or a folder for all of them, `films/`.",
)  # fmt: skip
@click.option("--report", "account", is_flag=True, help="Tell how far energy and momentum drifted.")
@click.option("--draft", is_flag=True, help="Pictures of `trace` less sharp, in a sixth of the time.")
@click.option("--limit", callback=as_seconds, metavar="TIME", help="Fail after so long, as 20s; what is made is kept.")
def render(scene: Path, variant: str | None, sets: tuple[str, ...], words: Path | None, **how: Any) -> None:
    """Make the outputs of a scene."""
    from sceneql import pipeline
    from sceneql.report.progress import bar

    with bar(scene.stem):
        graph = pipeline.load(scene, variant=variant, sets=sets, words=words)
    _warn(graph)
    with bar(graph.name) as progress:
        report = pipeline.render(graph, progress=progress, **how.pop("target"), **how)
    _warn(report)
    for path in report.files:
        click.echo(f"made {path}")
    line = f"run {report.run_seconds:.2f} s"
    if report.frames:
        line += f", {report.frames} frames"
    if report.steps:
        line += f", {report.steps} steps"
    line += f"; compile {report.compile_seconds:.2f} s"
    click.echo(line + (f" ({report.compilations} functions)" if report.compilations else ""))
    for found in report.conserved if how["account"] else ():
        click.echo(found)
    for name, frames in report.undecided.items():
        worst = max(frames, key=lambda index: frames[index])
        unsearched = report.unsearched.get(name, 0)
        click.echo(
            f"{name}: {sum(frames.values())} pixels undecided in {len(frames)} frames, at most {frames[worst]} in frame"
            f" {worst}: proved neither hit nor miss at the tolerance; `renderer: undecided` shows them"
            + (f"; {unsearched} rays were given up unsearched, after others beside them" if unsearched else "")
        )


@cli.command()
@SCENE
@options
def check(scene: Path, variant: str | None, sets: tuple[str, ...], words: Path | None) -> None:
    """Find what is wrong in a script, its variants and its studies, as far as that is seen without running it."""
    from sceneql import pipeline
    from sceneql.compiler.variants import check_variants, errors_in_variants
    from sceneql.quantities.diagnostic import Diagnostics, ScriptError
    from sceneql.report.progress import bar

    with bar(scene.stem):
        found = Diagnostics()
        try:
            graph = pipeline.load(scene, variant=variant, sets=sets, words=words)
        except ScriptError as error:
            found.extend(error.diagnostics)
            found.extend(errors_in_variants(scene, sets, words, error.diagnostics) if variant is None else ())
            raise ScriptError(found.found) from None
        found.extend(check_variants(graph, scene, variant, sets, words))
        found.extend(pipeline.errors_of_layout(graph))
    found.raise_errors()
    _warn(graph)
    for warning in found.found:
        click.echo(str(warning), err=True)
    click.echo(
        f"{scene}: ok, {len(graph.tasks)} parts" + (f", {len(graph.left_out)} not needed" if graph.left_out else "")
    )


@cli.command()
@SCENE
@options
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.option("--defaults", is_flag=True, help="Print what the script leaves unsaid, as entries to paste into it.")
def explain(
    scene: Path, variant: str | None, sets: tuple[str, ...], words: Path | None, as_json: bool, defaults: bool
) -> None:
    """Tell what will run, with which solver and step bound, and what is left out and why."""
    from sceneql import pipeline
    from sceneql.report.explain import explain as account
    from sceneql.report.explain import text
    from sceneql.report.progress import bar

    if defaults:
        from sceneql.report.unsaid import unsaid

        click.echo(unsaid(pipeline.load(scene, variant=variant, sets=sets, words=words)) or "# the script says all")
        return
    with bar(scene.stem):
        graph = pipeline.load(scene, variant=variant, sets=sets, words=words)
        found = account(graph)
    if as_json:
        import json

        click.echo(json.dumps(found, indent=2))
    else:
        _warn(graph)
        click.echo(text(found))


@cli.command()
@SCENE
@options
@click.option("-o", "--output", callback=as_path, help="Folder for the files, or their path without extension.")
@click.option("--error", type=ABOVE_ZERO, help="Name the cheapest solver for this relative error.")
@click.option("--solvers", callback=as_words, metavar="A,B", help="Measure these solvers alone.")
def bench(
    scene: Path, variant: str | None, sets: tuple[str, ...], words: Path | None, output: Path | None, **how: Any
) -> None:
    """Measure error against run time: physics by every solver that applies, implicit surfaces by rays and meshes."""
    from sceneql import pipeline
    from sceneql.report.bench import bench as measure
    from sceneql.report.progress import bar

    graph = pipeline.load(scene, variant=variant, sets=sets, words=words)
    with bar(graph.name) as progress:
        say = partial(click.echo, err=True)
        report = measure(graph, output, words, how["error"], progress, how["solvers"], say)
    click.echo(report)


@cli.command()
@SCENE
@options
@click.option(
    "--sweep", metavar="PATH=LOW..HIGH", help="As 'define.k=1e0..1e12 N/m'; by default steps, as 'step=1e-5..1'."
)
@click.option("--points", type=click.IntRange(min=1), help="Values of the sweep; by default 13.")
@click.option("--error", type=ABOVE_ZERO, default=0.1, show_default=True, help="Larger relative errors are inaccurate.")
@click.option("-o", "--output", callback=as_path, help="Folder for the files, or their path without extension.")
def stability(
    scene: Path,
    variant: str | None,
    sets: tuple[str, ...],
    words: Path | None,
    sweep: str | None,
    points: int | None,
    error: float,
    output: Path | None,
) -> None:
    """Map where each solver is stable, inaccurate or fails while a step or a value of the script is swept."""
    from sceneql import pipeline
    from sceneql.report.progress import bar
    from sceneql.report.stability import stability as survey

    def load(more: Sequence[str]) -> SimulationGraph:
        return pipeline.load(scene, variant=variant, sets=(*sets, *more), words=words)

    with bar(scene.stem) as progress:
        report = survey(load, sweep, points, output, words, error, progress)
    click.echo(report)


@cli.command()
@SCENE
@click.argument("name", required=False)
@options
@click.option("-o", "--output", callback=as_path, help="Folder for the files, or their path without extension.")
def study(
    scene: Path, name: str | None, variant: str | None, sets: tuple[str, ...], words: Path | None, output: Path | None
) -> None:
    """Run a study of the script (NAME, where there are several): errors, run times and outcomes over all its values."""
    from sceneql import pipeline
    from sceneql.report.progress import bar
    from sceneql.report.study_page import study as survey

    def load(more: Sequence[Any]) -> SimulationGraph:
        return pipeline.load(scene, variant=variant, sets=(*sets, *more), words=words, pruned=False)

    with bar(scene.stem) as progress:
        report = survey(load, name, output, progress)
    click.echo(report)


@cli.command()
@SCENE
@options
@click.option("--object", "name", required=True, metavar="NAME", help="The object.")
@click.option("-o", "--output", callback=as_path, required=True, help="File to make: .ply, .stl, .obj or .glb.")
@click.option("--cell", callback=as_length, metavar="LENGTH", help="Largest cell, as 2mm; else 1/128 of its size.")
@click.option(
    "--tolerance", callback=as_length, metavar="LENGTH", help="Distance from the surface, in place of --cell."
)
@click.option("--sharp", is_flag=True, help="Keep edges and corners.")
@click.option("--time", type=click.FloatRange(min=0), default=0.0, metavar="SECONDS", help="Instant of the simulation.")
def mesh(
    scene: Path,
    variant: str | None,
    sets: tuple[str, ...],
    words: Path | None,
    name: str,
    output: Path,
    cell: float | None,
    tolerance: float | None,
    sharp: bool,
    time: float,
) -> None:
    """Make triangles of an object's surface."""
    from sceneql import pipeline
    from sceneql.report.mesh import mesh as polygonise

    if cell is not None and tolerance is not None:
        raise click.UsageError("--cell and --tolerance exclude each other")
    graph = pipeline.load(scene, variant=variant, sets=sets, words=words, pruned=False)
    click.echo(polygonise(graph, name, output, cell=cell, tolerance=tolerance, time=time, sharp=sharp).text())


@cli.command()
@click.argument("word", required=False)
@click.option(
    "--words", "folder", type=click.Path(file_okay=False, exists=True), callback=as_path, help="Your own words."
)
def words(word: str | None, folder: Path | None) -> None:
    """List the words of the language, or show the manual of one."""
    from sceneql.compiler.catalogue import Catalogue
    from sceneql.report.manual import listing, manual

    catalogue = Catalogue(folder)
    click.echo(listing(catalogue) if word is None else manual(catalogue, word))


@cli.command()
@click.option(
    "--words", "folder", type=click.Path(file_okay=False, exists=True), callback=as_path, help="Your own words."
)
def schema(folder: Path | None) -> None:
    """Print the JSON Schema of scripts, for editors."""
    import json

    from sceneql.compiler.catalogue import Catalogue
    from sceneql.report.schema import schema as build

    click.echo(json.dumps(build(Catalogue(folder)), indent=1))


@cli.command()
@click.argument("name")
def new(name: str) -> None:
    """Write a commented first script, NAME.yaml, with the schema that editors read beside it."""
    from sceneql.report.new import write

    for path in write(name):
        click.echo(f"made {path}")


@cli.group()
def gallery() -> None:
    """Compare scenes with their kept posters and expected numbers."""


@gallery.command("check")
@click.argument("scenes", nargs=-1, type=click.Path(exists=True), callback=as_path)
@click.option("--folder", callback=as_path, default="gallery", help="Where the posters are kept.")
def gallery_check(scenes: tuple[Path, ...], folder: Path) -> None:
    """Run scenes small and short; compare posters and expected numbers."""
    from sceneql.report.gallery import check as compare

    lines, same = compare(scenes, folder)
    for line in lines:
        click.echo(line)
    if not same:
        sys.exit(GALLERY_DIFFERS)


@gallery.command("update")
@click.argument("scenes", nargs=-1, type=click.Path(exists=True), callback=as_path)
@click.option("--folder", callback=as_path, default="gallery", help="Where the posters are kept.")
def gallery_update(scenes: tuple[Path, ...], folder: Path) -> None:
    """Keep the posters of scenes as they are now, and write the gallery's page."""
    from sceneql.report.gallery import update

    for line in update(scenes, folder):
        click.echo(line)


@cli.command()
def warmup() -> None:
    """Compile everything once, so that no later run has to."""
    from sceneql.report.warmup import warmup as compile_all

    click.echo(compile_all())


def _warn(told: Any) -> None:
    for warning in told.warnings:
        click.echo(str(warning), err=True)


if __name__ == "__main__":
    main()
