"""How much is tried: SCENEQL_LONG=1, which `make test-long` sets, asks for the long version of each law."""

import os

LONG = "SCENEQL_LONG" in os.environ


def examples(count):
    """Examples of a law that is tried on so many in the long run: a third of them in the others."""
    return count if LONG else count // 3
