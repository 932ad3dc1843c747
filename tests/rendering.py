"""Requirements of tests of pictures in 3D."""

import ctypes.util
import os
import sys

import pytest

renders = pytest.mark.skipif(
    sys.platform == "linux"
    and not os.environ.get("DISPLAY")
    and not (ctypes.util.find_library("EGL") or ctypes.util.find_library("OSMesa")),
    reason="no display, no libEGL, no libOSMesa",
)
