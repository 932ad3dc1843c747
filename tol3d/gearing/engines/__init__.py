"""Engines measure the gaps between the flanks of each candidate tooth pair of a Build."""

from tol3d.gearing.engines.gaps import Engine, Gaps, MeshReading, ReadingEngine
from tol3d.gearing.engines.status import INTERFERES, NO_CONTACT, OK, OUT_OF_RANGE, STATUS_TEXT

__all__ = [
    "INTERFERES",
    "NO_CONTACT",
    "OK",
    "OUT_OF_RANGE",
    "STATUS_TEXT",
    "Engine",
    "Gaps",
    "MeshReading",
    "ReadingEngine",
]
