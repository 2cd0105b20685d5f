"""What is made has the same bytes on processors of another kind, and by numba without its shortcuts."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from bytes_made import MADE, digests
from sceneql.compiled.kernels import MODE

AVX2 = "haswell"
"""A processor without AVX-512."""


def digests_of_a_process(name, **environment):
    """The digests that a process of its own makes, told by environment variables how to compile."""
    script = Path(__file__).with_name("bytes_made.py")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **environment}
    run = subprocess.run(
        [sys.executable, str(script), name], env=environment, capture_output=True, text=True, check=True
    )
    return run.stdout.split()


@pytest.mark.long
@pytest.mark.parametrize("name", MADE)
def test_same_bytes_with_the_processor_restricted_to_avx2(name):
    assert digests_of_a_process(name, NUMBA_CPU_NAME=AVX2) == digests([name])


def test_no_kernel_lets_the_processor_say_in_which_order_it_adds():
    """Which would be another one where registers are wider: this holds for what the short run does not draw, too."""
    root = Path(__file__).parent.parent
    files = [path for folder in ("sceneql", "renderers") for path in (root / folder).rglob("*.py")]
    assert len(files) > 1000
    assert [path.name for path in files if "fastmath" in path.read_text(encoding="utf-8")] == []


@pytest.mark.skipif("SCENEQL_LONG" not in os.environ, reason="without the shortcuts it compiles for minutes")
@pytest.mark.parametrize("name", MADE)
def test_same_bytes_with_and_without_the_shortcuts_through_numba(name):
    assert digests_of_a_process(name, SCENEQL_NUMBA="" if MODE == "plain" else "plain") == digests([name])
