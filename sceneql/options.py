"""What commands are told on the command line, and how it is read. Nothing but click is imported."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from typing import Any, TypeVar

import click

ABOVE_ZERO = click.FloatRange(min=0, min_open=True)

F = TypeVar("F", bound=Callable[..., Any])


def as_length(context: click.Context, parameter: click.Parameter, value: Any) -> float | None:
    """A length as scripts write it to meters, above 0; a bare number is in meters."""
    from sceneql.quantities.dimension import LENGTH

    return None if value is None else _above_zero(value, LENGTH, f"'{value}' is no length above 0, as 2mm or 0.5")


def as_seconds(context: click.Context, parameter: click.Parameter, value: Any) -> float | None:
    """A time as scripts write it to seconds, above 0; a bare number is in seconds."""
    from sceneql.quantities.dimension import TIME

    return None if value is None else _above_zero(value, TIME, f"'{value}' is no time above 0, as 20s or 2min")


def _above_zero(value: Any, dimension: Any, wrong: str) -> float:
    """A number of a dimension, or a bare one, in SI units. Raises BadParameter, which says what is wrong."""
    from sceneql.kinds.word import literal
    from sceneql.quantities.diagnostic import ScriptError
    from sceneql.quantities.dimension import PLAIN
    from sceneql.quantities.expression import Type

    try:
        read = literal(value)
        number = read.number()
    except (ScriptError, ArithmeticError, ValueError):
        raise click.BadParameter(wrong) from None
    if read.expr.type not in (Type((), dimension), Type((), PLAIN)) or not 0.0 < number < float("inf"):
        raise click.BadParameter(wrong)
    return float(number)


def as_path(context: click.Context, parameter: click.Parameter, value: Any) -> Any:
    """Texts to paths; pathlib is not imported for ``--help``."""
    from pathlib import Path

    if isinstance(value, tuple):
        return tuple(Path(item) for item in value)
    return None if value is None else Path(value)


def as_target(context: click.Context, parameter: click.Parameter, value: str | None) -> Any:
    """A file, or with a slash behind it the folder in which files get names of their own, as `render` takes them."""
    from pathlib import Path

    if value is None:
        return {}
    path = Path(value)
    folder = value.endswith(("/", os.sep)) or (not path.suffix and os.path.isdir(value))
    if folder and os.path.isfile(value.rstrip("/" + os.sep)):
        raise click.BadParameter(f"{path} is a file, and no folder")
    return {"folder" if folder else "output": path}


def as_words(context: click.Context, parameter: click.Parameter, value: Any) -> tuple[str, ...]:
    """``a, b`` to ``("a", "b")``."""
    return tuple(word.strip() for word in (value or "").split(",") if word.strip())


_STILL = "write `sceneql render SCENE --set 'outputs={still: {image: {size: 480 270, time: 1 s}}}'`"
_MEANT = {
    **dict.fromkeys(
        ("--size", "--resolution", "--time", "--frame", "--at", "--still", "still", "image", "frame"), _STILL
    ),
    **dict.fromkeys(("--fps", "--rate"), "write `--set clock.fps=60`"),
    **dict.fromkeys(("--end", "--duration", "--length", "--seconds"), "write `--set 'clock.end=5 s'`"),
    **dict.fromkeys(("run", "play", "film", "animate", "view", "show"), "write `sceneql render SCENE`"),
    **dict.fromkeys(("help", "doc", "docs", "manual", "list"), "write `sceneql --help`, or `sceneql words`"),
    **dict.fromkeys(("validate", "lint", "test"), "write `sceneql check SCENE`"),
}
"""Options and commands of other programs, and what is written in their place."""


def meant(error: click.ClickException) -> str | None:
    """The help for an option or a command that there is not."""
    if isinstance(error, click.NoSuchOption):
        return _MEANT.get(error.option_name)
    command = re.fullmatch(r"No such command '(.*)'\.", error.message)
    if command is None:
        return None
    scene = command[1].endswith((".yaml", ".yml"))
    return f"write `sceneql render {command[1]}`" if scene else _MEANT.get(command[1])


SCENE = click.argument("scene", callback=as_path)


def options(command: F) -> F:
    """The options of every command that reads a script."""
    command = click.option("--variant", metavar="NAME", help="Apply one of the script's variants.")(command)
    command = click.option(
        "--set", "sets", multiple=True, metavar="PATH=VALUE", help="Replace a value, as --set define.k='3 N/m'."
    )(command)
    return click.option(
        "--words",
        type=click.Path(file_okay=False, exists=True),
        callback=as_path,
        help="A folder of words of your own (DIR/solvers/heun.py).",
    )(command)
