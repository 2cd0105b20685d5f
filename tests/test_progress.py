"""An interrupt stops a run even where a library has swallowed it."""

import os
import signal
from contextlib import suppress

import pytest

from sceneql.report.progress import bar


def test_a_swallowed_interrupt_is_raised_at_the_next_frame():
    before = signal.getsignal(signal.SIGINT)
    with bar("film") as progress:
        progress(0, 2)
        with suppress(KeyboardInterrupt):  # as a callback from C does
            os.kill(os.getpid(), signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            progress(1, 2)
    assert signal.getsignal(signal.SIGINT) is before


def test_what_fails_after_a_swallowed_interrupt_is_the_interrupt():
    def broken():
        with bar("film"):
            with suppress(KeyboardInterrupt):
                os.kill(os.getpid(), signal.SIGINT)
            raise RuntimeError("no compiled object yet")

    with pytest.raises(KeyboardInterrupt):
        broken()


def test_what_fails_without_one_stays_what_it_is():
    with pytest.raises(RuntimeError), bar("film"):
        raise RuntimeError("a bug")
