"""What tests measure beside their bounds: each comparison that holds, with its numbers.

    python tests/bench/bench_asserts.py [PYTEST'S OWN ARGUMENTS...]

As `tests/test_ties.py -k heavy_top`, which prints how far a heavy top is off, and how far it may be. Of lines that are
run more than once, the numbers that come nearest to the bound (those of the greatest left side) and how often.
"""

from __future__ import annotations

import re
import sys
import tempfile
from typing import Any

import numpy as np
import pytest

NUMBER = r"(?:np\.float64\()?(-?\d[\d.]*(?:e[+-]?\d+)?)\)?"
BOUNDED = re.compile(rf"^{NUMBER} (?:<|<=) {NUMBER}")
LONGEST = 150


class Told:
    """Prints, behind each test, what its assertions compared."""

    def __init__(self) -> None:
        self.lines: dict[int, tuple[float, str, str, int]] = {}

        self.close = np.testing.assert_allclose
        np.testing.assert_allclose = self.allclose

    def allclose(self, actual: Any, desired: Any, rtol: float = 1e-7, atol: float = 0.0, **more: Any) -> None:
        """numpy's own, whose numbers are kept."""
        self.close(actual, desired, rtol=rtol, atol=atol, **more)
        off = float(np.abs(np.subtract(actual, desired)).max(initial=0.0))
        least = float(np.min(atol + rtol * np.abs(desired), initial=np.inf))
        self.keep(sys._getframe(1).f_lineno, off, "assert_allclose", f"{off!r} <= {least!r}")

    def pytest_assertion_pass(self, item: Any, lineno: int, orig: str, expl: str) -> None:
        """Keep the comparison that comes nearest to its bound."""
        text = " ".join(expl.split("\n")[0].split())
        found = BOUNDED.match(text)
        self.keep(lineno, float(found[1]) if found else float("-inf"), orig, text)

    def keep(self, lineno: int, size: float, orig: str, text: str) -> None:
        """Keep what a line compared, of several times the greatest."""
        before = self.lines.get(lineno)
        times = before[3] + 1 if before else 1
        if before is None or size > before[0]:
            self.lines[lineno] = (size, orig, text, times)
        else:
            self.lines[lineno] = (*before[:3], times)

    def pytest_runtest_logreport(self, report: Any) -> None:
        """Print a test's lines once it has run."""
        if report.when != "call":
            return
        print(f"\n{report.nodeid}: {report.outcome}")
        for _, (_, asked, seen, times) in sorted(self.lines.items()):
            print(
                f"    {' '.join(asked.split())[:LONGEST]}\n        {seen[:LONGEST]}" + f"   (x {times})" * (times > 1)
            )
        self.lines.clear()


if __name__ == "__main__":
    sys.pycache_prefix = tempfile.mkdtemp()  # tests that were compiled before tell nothing
    options = ["-o", "enable_assertion_pass_hook=true", "-p", "no:cacheprovider", "-p", "no:xdist", "-q", "-s"]
    sys.exit(pytest.main([*options, *sys.argv[1:]], plugins=[Told()]))
