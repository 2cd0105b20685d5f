"""Processor time of a frame of scenes by `render --draft` beside the same frame by `trace`.

Run: python tests/bench/bench_draft.py [SCENE.yaml ...]; by default first, drops and still_life, a frame of the middle.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from tempfile import gettempdir
from typing import Any

from sceneql.kinds import Picture
from sceneql.pipeline import Tools, load, simulate
from sceneql.tools import Report

SCENES = Path(__file__).resolve().parents[2] / "scenes"
REPEATS = 5


def main() -> None:
    """Print a row for each scene."""
    for path in sys.argv[1:] or [str(SCENES / f"{name}.yaml") for name in ("first", "drops", "still_life")]:
        graph = load(path)
        name, kind = next((n, t.kind) for n, t in graph.tasks.items() if isinstance(t.kind, Picture))
        times = kind.times(graph.settings.clock)
        (moment,) = simulate(graph, [times[len(times) // 2]])
        both: list[Any] = [Tools(graph, name, Report(), Path(gettempdir()) / "x", draft=draft) for draft in (0, 1)]
        least = [float("inf")] * 2
        for k in range(1 + REPEATS):
            for which, tools in enumerate(both):
                tools.prepare(kind)()
                started = time.process_time()
                tools.pixels(kind, moment)
                if k > 0:
                    least[which] = min(least[which], time.process_time() - started)
        print(
            f"{Path(path).stem}: trace {1e3 * least[0]:.0f} ms, draft {1e3 * least[1]:.0f} ms, "
            f"1/{least[0] / least[1]:.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
