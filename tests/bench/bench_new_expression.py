"""How soon a formula that was never seen before is drawn and polygonised in a warm process, and what that compiles.

Run it as ``python tests/bench/bench_new_expression.py``.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from sceneql import pipeline
from sceneql.compiled.kernels import compiled
from sceneql.report.mesh import mesh

SCENE = """\
sceneql: 1
objects:
  a: {implicit: {field: "FIELD", bounds: {ball: 1}, mode: MODE}}
  floor: {plane: {position: 0 -1 0 m}}
outputs: {still: {image: {size: 640 360}}}
"""
FIRST = "x^2 + y^2 + z^2 - 0.5"
NEW = [
    "sin(9*x)*cos(9*y) + sin(9*y)*cos(9*z) + sin(9*z)*cos(9*x)",
    "max(x*y*z, abs(atan2(x, y + 2))^2.5 - 0.3)",
    "x^2*y^2 + y^2*z^2 + z^2*x^2 - x*y*z",
    "exp(-3*x^2) + exp(-3*y^2) + log(1.5 + z) - sqrt(2.5 + x*y)",
]
BAR = 1.0


def spent(field: str, mode: str, folder: Path) -> tuple[float, float, int]:
    """Seconds of drawing a formula from its script, and of its mesh; what they compiled."""
    script, before = folder / "scene.yaml", compiled.count
    script.write_text(SCENE.replace("FIELD", field).replace("MODE", mode), encoding="utf-8")
    start = time.perf_counter()
    pipeline.render(pipeline.load(script), output=folder / "still.png")
    drawn = time.perf_counter()
    mesh(pipeline.load(script, pruned=False), "a", folder / "a.ply", cell=1 / 32)
    return drawn - start, time.perf_counter() - drawn, compiled.count - before


def main() -> None:
    """Print a line for each formula and mode."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for mode in ("solid", "surface"):
            spent(FIRST, mode, folder)
            for field in NEW:
                drawn, made, count = spent(field, mode, folder)
                verdict = "" if drawn <= BAR else f", over the bar of {BAR:g} s"
                print(f"{mode:8} drawn in {drawn:.2f} s{verdict}, mesh in {made:.2f} s, {count} compiled: {field}")


if __name__ == "__main__":
    main()
