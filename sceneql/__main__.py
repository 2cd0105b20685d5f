"""The program, by its name or as ``python -m sceneql``: quiet when a signal comes while it is loaded, or ends."""

import os


def main() -> None:
    """The entry point of the program. It ends without taking the interpreter down, which a signal would break off."""
    signal = __import__("_signal")  # what `signal` has inside: no time passes before the first handler is set
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, lambda number, frame: os._exit(128 + number))
    import atexit
    import sys
    from contextlib import suppress

    from sceneql import interrupts

    interrupts.end_at_once()
    from sceneql.cli import main as run

    try:
        run()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
        interrupts.end_at_once(code)
        atexit._run_exitfuncs()
        for stream in (sys.stdout, sys.stderr):
            with suppress(OSError, ValueError):
                stream.flush()
        os._exit(code)


if __name__ == "__main__":
    main()
