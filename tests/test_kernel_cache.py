"""Compiled code is made anew when any file that it is made of has changed, however that file is imported."""

import os
import subprocess
import sys

import pytest

from sceneql.compiled.kernels import _sources

FORCE = '''
"""even: the same force on every mass."""

from sceneql.kinds import Force


class Even(Force):
    """F = 1 N times a factor, along x."""

    def assemble(self, name, assembly, bodies):
        """Add it to every mass."""
        from sceneql.system import Slopes

        kernel = "sceneql_words.forces.even_kernels:even"
        assembly.term("force", kernel, (bodies.velocity_at, bodies.count), Slopes("", (), ()), apart=True)
'''
KERNEL = '''
"""The force of even."""

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM
IMPORT


@lean(TERM, inner=True)
def even(t, y, rate, floats, ints):
    """Adds it. ints: velocity_at, count."""
    for k in range(ints[1]):
        rate[ints[0] + 3 * k] += NAME.FACTOR
'''
SCRIPT = """
models: {ball: {particles: {list: {a: {mass: 1 kg, position: 0 0 0 m}}}}}
forces: [even]
solvers: {main: {rk4: {step: 10 ms}}}
clock: {end: 1 s}
outputs: {data: {record: {of: [ball.a.position]}}}
"""
RUN = """
import sys
from sceneql import pipeline
from pathlib import Path
(moment,) = pipeline.simulate(pipeline.load(Path(sys.argv[1]), words=Path(sys.argv[2])), [1.0])
print(moment.read("ball", "a.position")[0])
"""


STATEMENTS = {
    "from sceneql_words.forces import shared_law": "shared_law",
    "from . import shared_law": "shared_law",
    "import sceneql_words.forces.shared_law as law": "law",
    "import math; from sceneql_words.forces import shared_law": "shared_law",
    "from sceneql_words.forces import (\n    shared_law as law,\n)": "law",
    "from sceneql_words.forces import (  # the law (shared)\n    shared_law,\n)": "shared_law",
    "from sceneql_words.forces.laws import *": "shared_law",
}


def test_kernels_of_a_words_folder_follow_the_modules_that_they_import(tmp_path):
    """Each of several forces, by the way in which its kernel imports the law: they add up by powers of ten."""
    forces = tmp_path / "forces"
    laws = forces / "laws"
    laws.mkdir(parents=True)
    for number, (statement, name) in enumerate(STATEMENTS.items()):
        word = f"even{number}"
        kernel = KERNEL.replace("IMPORT", statement).replace("NAME", f"{10.0**number} * {name}")
        (forces / f"{word}_kernels.py").write_text(kernel)
        (forces / f"{word}.py").write_text(
            FORCE.replace("even_kernels", f"{word}_kernels").replace("Even", f"Even{number}")
        )
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCRIPT.replace("[even]", f"[{', '.join(f'even{k}' for k in range(len(STATEMENTS)))}]"))
    cache = str(tmp_path / "cache")
    environment = {**os.environ, "SCENEQL_CACHE": cache, "PYTHONDONTWRITEBYTECODE": "1"}
    (laws / "__init__.py").write_text('__all__ = ["shared_law"]\n')
    for factor in (1.0, 2.0):
        (laws / "shared_law.py").write_text(f"FACTOR = {factor}\n")
        (forces / "shared_law.py").write_text(f"FACTOR = {factor}\n")
        run = [sys.executable, "-c", RUN, str(scene), str(tmp_path)]
        said = subprocess.run(run, env=environment, capture_output=True, text=True, check=True).stdout
        assert float(said) == pytest.approx(1111111 * factor / 2, rel=1e-9)


def test_a_kernel_is_made_of_its_file_and_of_all_that_this_imports():
    files = {source.path.name for source in _sources("sceneql.words.forces.gravity_kernels").values()}
    assert files >= {"gravity_kernels.py", "kernels.py", "signatures_kernels.py", "shortcuts.py"}
    assert not files & {"gravity.py", "drag_kernels.py", "cli.py"}
    # A message or a word of another program that is told from now on makes no machine code anew.
    for module in ("sceneql.words.forces.gravity_kernels", "sceneql.march.march_kernels"):
        assert not [name for name in _sources(module) if name.startswith(("sceneql.quantities", "sceneql.failure"))]
    assert all(source.path.is_file() for source in _sources("sceneql.march.march_kernels").values())
