"""Off-screen OpenGL by pyrender."""

from __future__ import annotations

import atexit
import os
import sys
import warnings
from ctypes.util import find_library
from functools import cache
from types import ModuleType
from typing import Any

HELP = "on Debian: apt-get install libegl1 libopengl0 libgl1-mesa-dri; or draw by `trace`, which needs nothing"


@cache
def library() -> Any:
    """Module pyrender, ready to draw off-screen. Raises ValueError if it or OpenGL is missing."""
    if sys.platform == "linux" and "PYOPENGL_PLATFORM" not in os.environ:
        found = next((name for name, file in (("egl", "EGL"), ("osmesa", "OSMesa")) if find_library(file)), None)
        if found is None:
            raise ValueError(f"raster needs a library of OpenGL that draws without a screen ({HELP})")
        os.environ["PYOPENGL_PLATFORM"] = found  # read when OpenGL is first imported
    viewer = ModuleType("pyrender.viewer")
    viewer.__dict__["Viewer"] = None
    sys.modules.setdefault("pyrender.viewer", viewer)  # the real module opens a screen when imported
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import pyrender
    except ModuleNotFoundError as error:
        raise ValueError(f'raster needs {error.name}: pip install "sceneql[raster]"') from error
    except Exception as error:  # PyOpenGL raises AttributeError and others where a library lacks something
        raise ValueError(f"OpenGL cannot be used: {error} ({HELP})") from error
    return pyrender


def canvas(width: int, height: int) -> Any:
    """Canvas for pictures of a size [pixels]. Raises ValueError if OpenGL cannot create one."""
    made = _context()
    made.viewport_width, made.viewport_height = width, height
    return made


@cache
def _context() -> Any:
    """Single OpenGL context, never closed, because closing one would close all. Raises ValueError."""
    gl = library()
    try:
        made = gl.OffscreenRenderer(16, 16)
    except Exception as error:  # OpenGL raises errors of many kinds
        raise ValueError(f"OpenGL draws nothing here: {error} ({HELP})") from error
    atexit.register(made.delete)
    return made
