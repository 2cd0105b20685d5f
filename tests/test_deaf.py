"""Signals that come while compiled code is in a step that does not end."""

import os
import signal
import subprocess
import sys
import time

import pytest

DEAF = """
import hashlib, sys
from pathlib import Path
from sceneql import interrupts
from sceneql.exits import stopped
interrupts.DEAF = {deaf}
with interrupts.raised(stopped), interrupts.keeping(lambda: [Path("film.partial.mp4")]):
    try:
        print("begun", flush=True)
        hashlib.pbkdf2_hmac("sha256", b"", b"", {turns})  # without the interpreter's lock, as kernels
    except KeyboardInterrupt:
        print("heard", flush=True)
"""


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_that_is_not_handled_keeps_what_was_made_and_ends_the_process(number):
    command = [sys.executable, "-c", DEAF.format(deaf=0.3, turns=10**9)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        assert run.stdout.readline() == "begun\n"
        time.sleep(0.2)  # it has begun to count
        os.kill(run.pid, number)
        out, told = run.communicate(timeout=60)
    assert run.returncode == 128 + number
    assert "kept film.partial.mp4" in told
    assert told.endswith("interrupted\n")
    assert out == ""


def test_a_signal_that_is_handled_late_is_an_interrupt_as_ever():
    command = [sys.executable, "-c", DEAF.format(deaf=60.0, turns=10**6)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        assert run.stdout.readline() == "begun\n"
        os.kill(run.pid, signal.SIGTERM)
        out, told = run.communicate(timeout=60)
    assert (out, run.returncode) == ("heard\n", 0), told
