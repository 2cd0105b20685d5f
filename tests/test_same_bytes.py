"""What is made has the same bytes on processors of another kind."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from bytes_made import MADE, digests

AVX2 = "haswell"
"""A processor without AVX-512."""


@pytest.mark.parametrize("name", MADE)
def test_same_bytes_with_the_processor_restricted_to_avx2(name):
    script = Path(__file__).with_name("bytes_made.py")
    environment = {**os.environ, "NUMBA_CPU_NAME": AVX2, "PYTHONPATH": os.pathsep.join(sys.path)}
    run = subprocess.run(
        [sys.executable, str(script), name], env=environment, capture_output=True, text=True, check=True
    )
    assert run.stdout.split() == digests([name])
