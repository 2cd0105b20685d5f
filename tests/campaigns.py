"""How much is tried: SCENEQL_LONG=1, which `make test-long` sets, asks for the long version of each law."""

import os

LONG = "SCENEQL_LONG" in os.environ
