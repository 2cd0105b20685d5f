"""What holds for all tests: none of them fails for taking long, since machines differ and may be busy."""

import gc
import os
import signal

import pytest
from hypothesis import settings

# Before numpy is imported. Its threads would wait for one another by counting: on two cores, which two workers have
# busy, the modes of a bell took 4.4 s of processor time in place of 1.8 s.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as a shell leaves it for what it runs beside
    signal.signal(signal.SIGINT, signal.default_int_handler)

settings.register_profile("unhurried", deadline=None)
settings.load_profile("unhurried")


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
