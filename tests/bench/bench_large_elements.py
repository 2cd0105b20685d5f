"""Large elastic solids by tr_bdf2 and bdf2, two ways of order 2: errors of places over processor time.

Run: python tests/bench/bench_large_elements.py
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np

from sceneql.pipeline import load
from sceneql.run.run import Run


def large() -> None:
    """Errors of places over processor time by tr_bdf2 and bdf2: a bar of 15,360 p1 elements that falls, held at an end,
    by tolerances, and a block of 7,840 that falls onto a torus, by steps of one length."""
    bar = "size: 1 0.25 0.25 m, cells: [48, 8, 8], cut: five}, hold: {end: {where: x < -0.4999}}, "
    bar += "law: {neo_hookean: {modulus: 300 kPa, poisson: 0.4}"
    by_methods("bar", bar, 0.6, "tolerance: 1e-6", [f"tolerance: {one}" for one in ("1e-3", "1e-4", "3e-5")])
    block = "size: 0.78 0.4 0.78 m, center: 0 0.45 0 m, cells: [14, 8, 14], cut: five}, "
    block += "law: {neo_hookean: {modulus: 55 kPa, poisson: 0.4}"
    touch = "objects: {ring: {torus: {radius: 0.3 m, tube: 0.1 m, position: 0 0.1 0 m}}}\n"
    touch += "contacts: {touch: {collision: {between: [body, ring], friction: 0.3}}}\n"
    steps = [f"step: {1000 / rate} ms, newton: 1e-3" for rate in (100, 240, 480, 960)]
    by_methods("block in touch", block, 0.4, f"step: {1000 / 1920} ms, newton: 1e-4", steps, touch)


def by_methods(called: str, fields: str, end: float, finest: str, settings: list[str], more: str = "") -> None:
    """Print error at ``end`` [s], beside tr_bdf2 by its ``finest`` setting, and processor time by each setting."""
    script = f"clock: {{end: {end} s}}\nforces: [gravity]\n{more}models: {{body: {{elastic: {{element: p1, block: {{"
    right = None
    for setting in (finest, *settings):
        for solver in ("tr_bdf2", "bdf2")[: 1 if right is None else 2]:
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "scene.yaml"
                path.write_text(f"{script}{fields}}}}}}}}}\nsolvers: {{main: {{{solver}: {{{setting}}}}}}}\n")
                run, start = Run(load(path, pruned=False)), time.process_time()
                *_, last = run.moments([0, end])
            places, seconds = np.array(last.read("body", "positions")), time.process_time() - start
            right = places if right is None else right
            error = np.sqrt(((places - right) ** 2).sum(axis=1).mean())
            print(f"{called}, {solver}, {setting}: error {error:.2e} m, {seconds:.1f} s of processors", flush=True)


if __name__ == "__main__":
    large()
