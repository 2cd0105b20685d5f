"""Adding a word is one file: the solver of ARCHITECTURE.md, dropped into a folder, works in a script."""

import math
import re
from itertools import pairwise
from pathlib import Path

from sceneql import pipeline

PAGE = Path(__file__).parent.parent / "ARCHITECTURE.md"
SCRIPT = """
models:
  spring:
    mass_spring:
      masses: {wall: {position: 0 0 0 m, fixed: yes}, bob: {position: 1.5 0 0 m, mass: 1 kg}}
      springs: [{between: [wall, bob], rest: 1 m, stiffness: 100 N/m}]
solvers: {main: {ralston: {step: 4 ms}}}
clock: {end: 1 s}
outputs: {data: {record: {of: [spring.bob.position]}}}
"""


def test_a_solver_in_one_file(tmp_path):
    code = re.search(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert code is not None
    (tmp_path / "solvers").mkdir()
    (tmp_path / "solvers" / "ralston.py").write_text(code[1])
    scene = tmp_path / "spring.yaml"
    scene.write_text(SCRIPT)
    errors = []
    for step in ("4 ms", "2 ms", "1 ms"):
        graph = pipeline.load(scene, sets=[f"solvers.main.step={step}"], words=tmp_path)
        (moment,) = pipeline.simulate(graph, [1.0])
        errors.append(abs(moment.read("spring", "bob.position")[0] - (1 + 0.5 * math.cos(10))))
    orders = [math.log2(a / b) for a, b in pairwise(errors)]
    assert all(abs(order - 2) < 0.1 for order in orders), (errors, orders)
