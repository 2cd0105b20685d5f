"""Composing a 10 MB script, beside draining PyYAML's events of it: prints the ratio of the medians (bar: 3.5).

Run it as ``python tests/bench/bench_compose.py [MB] [ROUNDS]``.
"""

from __future__ import annotations

import random
import statistics
import sys
import time
from collections.abc import Callable

import yaml

from sceneql.language.compose import compose
from sceneql.quantities.span import Source


def scene(megabytes: float) -> str:
    """A script of many objects, in block and flow style."""
    rng = random.Random(1)
    parts, size = ["sceneql: 1\nobjects:\n"], 0
    while size < megabytes * 1e6:
        x, y, z, r = (f"{rng.random():.4f}" for _ in range(4))
        parts.append(
            f"  ball_{len(parts)}:\n    sphere:\n      radius: {r} m\n      position: [{x}, {y}, {z}]\n"
            f"      material: {{glossy: {{color: tomato, roughness: {r}}}}}\n"
        )
        size += len(parts[-1])
    return "".join(parts)


def drain(text: str) -> None:
    """Read all events and drop them."""
    for _ in yaml.parse(text, Loader=yaml.CLoader):
        pass


def seconds(work: Callable[[], object]) -> float:
    """How long a call takes; what it returns is dropped outside the time."""
    start = time.perf_counter()
    result = work()
    elapsed = time.perf_counter() - start
    del result
    return elapsed


def main() -> None:
    """Measure in turn, so that both meet the same machine."""
    megabytes = float(sys.argv[1]) if len(sys.argv) > 1 else 10
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    text = scene(megabytes)
    drained, composed = [], []
    for _ in range(rounds):
        drained.append(seconds(lambda: drain(text)))
        composed.append(seconds(lambda: compose(Source("bench.yaml", text))))
    events, tree = statistics.median(drained), statistics.median(composed)
    print(f"{megabytes:g} MB: events {events:.2f} s, compose {tree:.2f} s, ratio {tree / events:.2f} (bar 3.5)")


if __name__ == "__main__":
    main()
