"""What holds for all tests: none of them fails for taking long, since machines differ and may be busy."""

import gc
import os
import re
import signal
from importlib import import_module
from pathlib import Path

import pytest
from hypothesis import settings

# Before numpy is imported. Its threads would wait for one another by counting: on two cores, which two workers have
# busy, the modes of a bell took 4.4 s of processor time in place of 1.8 s.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as a shell leaves it for what it runs beside
    signal.signal(signal.SIGINT, signal.default_int_handler)

settings.register_profile("unhurried", deadline=None)
settings.load_profile("unhurried")


def pytest_collection(session):
    """Every second worker imports what tests import from their end on: each compiles half, and loads the other's half.

    Else all would compile the same kernels in the same order: one compiles, and the others wait for it.
    """
    if int(os.environ.get("PYTEST_XDIST_WORKER", "gw0")[2:]) % 2:
        asked = [Path(session.config.rootpath, one.partition("::")[0]) for one in session.config.args]
        files = (path for one in asked for path in (sorted(one.glob("test_*.py")) if one.is_dir() else [one]))
        texts = "\n".join(path.read_text(encoding="utf-8") for path in files if path.is_file())
        for name in dict.fromkeys(reversed(re.findall(r"^from ((?:sceneql|renderers)\.\S+) import ", texts, re.M))):
            import_module(name)


def pytest_collection_modifyitems(items):
    """The long tests come first, so that at the end no core works on one alone."""
    items.sort(key=lambda item: item.get_closest_marker("long") is None)


def pytest_collection_finish():
    """What was collected stays to the end, and is not looked over each time that Python looks for garbage."""
    gc.freeze()


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(item, nextitem):
    """What a file leaves behind stays, and is not looked over either.

    Each film that is closed has all looked over: late in the suite that took two seconds a film.
    """
    if nextitem is None or nextitem.path != item.path:
        gc.collect()
        gc.freeze()
