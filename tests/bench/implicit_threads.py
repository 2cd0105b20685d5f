"""What a second thread gains a film, beside what a second process gains: wall time, in turns.

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

    def __init__(self, path: Path, threads: int) -> None:
        """``path``: of the script. The process makes the film once, which compiles and loads, before it is ready."""
        env = os.environ | {"SCENEQL_THREADS": str(threads)}
        self.process = subprocess.Popen(
            [sys.executable, __file__, str(path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=env
        )
        self.seconds()

    def begin(self) -> None:
        """Have it make the film."""
        assert self.process.stdin is not None
        self.process.stdin.write("\n")
        self.process.stdin.flush()

    def seconds(self) -> float:
        """Wall time of the film, when it is made."""
        assert self.process.stdout is not None
        return float(self.process.stdout.readline())

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


def main(path: Path) -> None:
    """Make the film of a script, and then again at each line of input; write the seconds that each took."""
    graph = pipeline.load(path)
    while True:
        with tempfile.TemporaryDirectory() as folder:
            start = time.perf_counter()
            pipeline.render(graph, folder=Path(folder))
            print(time.perf_counter() - start, flush=True)
        if not sys.stdin.readline():
            return


if __name__ == "__main__":
    main(Path(sys.argv[1]))
