"""Ends of commands: exceptions become messages and exit codes.

Exit codes: 0 ok, 1 run failed, 2 usage, 3 script invalid, 4 gallery differs, 5 limit refused or out of memory, 130
interrupted (Ctrl-C), 143 ended by SIGTERM, 129 by the end of its terminal (SIGHUP).
"""

from __future__ import annotations

import click

from sceneql import interrupts

OK, RUN_FAILED, USAGE, SCRIPT_INVALID, GALLERY_DIFFERS, LIMIT_REFUSED = 0, 1, 2, 3, 4, 5


def stopped(error: BaseException | None) -> int:
    """Tell which files are kept after a signal; returns the signal's exit code."""
    code = interrupts.exit_code()
    interrupts.end_at_once(code)
    _say_kept(error)
    click.echo("interrupted", err=True)
    return code


def failed(error: Exception) -> int:
    """Print an error; returns the exit code. An exception without a message for users is a bug, and is raised."""
    from sceneql.failure import LimitRefused, OutOfMemory, RunFailure, Unsuitable, starved, want_of_memory
    from sceneql.quantities.diagnostic import LIMITS, ScriptError

    if isinstance(error, ScriptError):
        click.echo(str(error), err=True)
        count = len(error.diagnostics)
        click.echo(f"\n{count} error{'s' if count > 1 else ''}", err=True)
        return LIMIT_REFUSED if all(found.code in LIMITS for found in error.diagnostics) else SCRIPT_INVALID
    if isinstance(error, LimitRefused):
        click.echo(str(error), err=True)
        _say_kept(error)
        return LIMIT_REFUSED
    if isinstance(error, Unsuitable):
        click.echo(f"error: {error}", err=True)
        return USAGE
    if starved(error):
        click.echo(str(error) if isinstance(error, OutOfMemory) else f"error: {want_of_memory(error)}", err=True)
        _say_kept(error)
        return LIMIT_REFUSED
    if isinstance(error, RunFailure | OSError | EOFError):
        told = f"a file ends too soon: {error}" if isinstance(error, EOFError) else str(error)
        click.echo(told if isinstance(error, RunFailure) else f"error: {told}", err=True)
        _say_kept(error)
        return RUN_FAILED
    raise error


def _say_kept(error: BaseException | None) -> None:
    for path in getattr(error, "kept", ()):
        click.echo(f"kept {path}", err=True)
    for note in getattr(error, "__notes__", ()):
        click.echo(note, err=True)
