"""What a second thread gains a film, beside what a second process gains, and films of two checkouts: in turns.

A child process makes one film each time it is asked, from the script to the PNG files. One child with one thread, one
with two, and two with one thread each at once: the last is what the machine has to give in this minute.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from sceneql import pipeline


class Child:
    """A process that makes a film again and again."""

    def __init__(self, path: Path, threads: int, checkout: str = "") -> None:
        """``path``: of the script. The process makes the film once, which compiles and loads, before it is ready.

        ``checkout``: a folder whose code makes it, in place of this one's; its kernels are kept there.
        """
        env = os.environ | {"SCENEQL_THREADS": str(threads)}
        if checkout:
            env |= {"PYTHONPATH": checkout, "SCENEQL_CACHE": str(Path(checkout, ".venv", "before"))}
        self.process = subprocess.Popen(
            [sys.executable, __file__, str(path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=env
        )
        self.seconds()

    def begin(self) -> None:
        """Have it make the film."""
        assert self.process.stdin is not None
        self.process.stdin.write("\n")
        self.process.stdin.flush()

    def seconds(self, clock: int = 0) -> float:
        """Wall time of the film, when it is made, or, of ``clock`` 1, its processor time."""
        assert self.process.stdout is not None
        return float(self.process.stdout.readline().split()[clock])

    def end(self) -> None:
        """End the process."""
        self.process.communicate()


def gains(text: str, rounds: int) -> tuple[float, float, float]:
    """(seconds of a film by one thread, gain by two threads, gain by two processes of one): medians of rounds."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "film.yaml")
        path.write_text(text, encoding="utf-8")
        one, other, both = Child(path, 1), Child(path, 1), Child(path, 2)
        found = []
        for _ in range(rounds):
            taken = []
            for children in ((one,), (both,), (one, other)):
                for child in children:
                    child.begin()
                taken.append(max(child.seconds() for child in children))
            alone, two_threads, two_processes = taken
            found.append((alone, alone / two_threads, 2.0 * alone / two_processes))
        for child in (one, other, both):
            child.end()
    seconds, by_threads, by_processes = map(statistics.median, zip(*found, strict=True))
    return seconds, by_threads, by_processes


def before(text: str, checkout: str, rounds: int) -> tuple[float, float]:
    """Processor time [s] of a film by one thread, by this code and by that of a ``checkout``: medians of rounds."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "film.yaml")
        path.write_text(text, encoding="utf-8")
        children = Child(path, 1), Child(path, 1, checkout)
        found = []
        for _ in range(rounds):
            taken = []
            for child in children:
                child.begin()
                taken.append(child.seconds(1))
            found.append(taken)
        for child in children:
            child.end()
    here, there = map(statistics.median, zip(*found, strict=True))
    return here, there


def main(path: Path) -> None:
    """Make the film of a script, and then again at each line of input; write the seconds that each took."""
    graph = pipeline.load(path)
    while True:
        with tempfile.TemporaryDirectory() as folder:
            start, spent = time.perf_counter(), time.process_time()
            pipeline.render(graph, folder=Path(folder))
            print(time.perf_counter() - start, time.process_time() - spent, flush=True)
        if not sys.stdin.readline():
            return


if __name__ == "__main__":
    main(Path(sys.argv[1]))
