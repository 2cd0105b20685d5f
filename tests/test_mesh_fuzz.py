"""Mutated mesh files: each is read or refused by an error that names it, in little memory and time.

SCENEQL_FUZZ says how many.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

COUNT = min(int(os.environ.get("SCENEQL_FUZZ", "600")), 20_000)


def test_mesh_fuzz():
    script = Path(__file__).with_name("mesh_mutants.py")
    done = subprocess.run(
        [sys.executable, "-W", "error", str(script), str(COUNT), "0"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-4000:]
    read = json.loads(done.stdout)
    assert read["obj"] > COUNT // 20  # some are whole in spite of it
    assert sum(read.values()) < COUNT
