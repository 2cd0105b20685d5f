"""An interrupt stops a run even where a library has swallowed it; what takes long is shown."""

import os
import pty
import re
import select
import signal
from contextlib import suppress
from itertools import count

import pytest

from sceneql.doing import Deed, doing, now
from sceneql.march import pace
from sceneql.march.pace import Pace
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


def test_what_takes_long_is_shown_by_name(monkeypatch):
    main, other = pty.openpty()
    with os.fdopen(other, "w") as terminal:
        monkeypatch.setattr("sys.stderr", terminal)
        monkeypatch.setenv("TERM", "xterm")
        seen = b""
        with bar("film"), doing("running ahead"), doing("filling bone"):
            while b"filling bone" not in seen:
                ready, _, _ = select.select([main], [], [], 20)
                assert ready, seen
                seen += os.read(main, 4096)
    os.close(main)
    assert b"running ahead" not in seen


def test_the_innermost_of_what_takes_long_is_told(monkeypatch):
    monkeypatch.setattr("sceneql.doing.LONG", 0.0)
    with doing("running ahead"):
        with doing("filling bone"):
            assert now() == "filling bone"
        assert now() == "running ahead"
    assert now() == ""


def test_what_takes_minutes_is_told_in_a_line_where_there_is_no_terminal(monkeypatch, capsys):
    monkeypatch.setattr("sceneql.report.progress.LINES", 0.01)
    monkeypatch.setattr("sceneql.report.progress.LONG", 0.0)
    told = ""
    with bar("film") as step, doing("running to 1 s, 25 % of the clock"), doing("filling bone"):
        step(3, 12)
        while "12" not in told:
            told = capsys.readouterr().err
    assert "film: 3 of 12 (25 %), running to 1 s, 25 % of the clock: filling bone" in told.splitlines()


def test_frames_and_what_they_will_take_are_told_where_there_is_no_terminal(monkeypatch, capsys):
    monkeypatch.setattr("sceneql.report.progress.LINES", 0.01)
    told = ""
    with bar("film") as step:
        step(3, 36_000)
        while told.count("\n") < 2:
            told += capsys.readouterr().err
    assert re.fullmatch(r"film: 3 of 36,000 \(0 %\), about [\d.]+ (s|min|h) left", told.splitlines()[0])


def test_a_march_tells_its_steps_and_when_it_will_be_at_the_next_instant():
    deed = Deed("solving")
    march = Pace(deed, 1.0, 0.0, 0)
    assert march.at_once(1e-10, 100, 1.0) == 30
    assert deed.what == "solving, at 1e-10 s"
    assert not march.hopeless(1e-9, 1_000_000)
    assert "at 1e-09 s: steps of 1e-15 s, to the next instant" in deed.what


@pytest.mark.parametrize(("growth", "hopeless"), [(1.0, True), (2.0, False)])
def test_only_a_march_whose_steps_stay_too_short_is_given_up(growth, hopeless):
    march, t, given_up = Pace(Deed("solving"), 1.0, 0.0, 0), 0.0, False
    for look in range(1, 8):
        t += 20_000 * 1e-15 * growth**look
        given_up = given_up or march.hopeless(t, 20_000 * look)
    assert given_up == hopeless


@pytest.mark.parametrize(("seconds", "hopeless"), [(1.0, True), (1e-9, False)])
def test_few_long_steps_are_enough_where_all_would_take_years(monkeypatch, seconds, hopeless):
    clock = count(0.0, 1000 * seconds)
    monkeypatch.setattr(pace.time, "perf_counter", lambda: next(clock))
    march = Pace(Deed("solving"), 1.0, 0.0, 0)
    assert [march.hopeless(1e-12 * look, 1000 * look) for look in (1, 2, 3, 4)][3] == hopeless


def test_a_march_that_leads_nowhere_is_looked_at_more_often():
    """Calls of a million steps would take half a minute until it is known."""
    march = Pace(Deed("solving"), 1.0, 0.0, 0)
    steps = march.until_look
    assert steps is not None
    while not march.hopeless(steps * 1e-15, steps):
        assert march.until_look is not None
        steps += march.until_look
    assert steps < 100_000
    fine = Pace(Deed("solving"), 1.0, 0.0, 0)
    assert not fine.hopeless(0.1, 10_000)
    assert fine.until_look is None
