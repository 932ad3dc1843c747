"""Engines measure the gaps between the flanks of each candidate tooth pair of a Build."""

from tol3d.gearing.engines.gaps import (
    INTERFERES,
    NO_CONTACT,
    OK,
    OUT_OF_RANGE,
    STATUS_TEXT,
    Engine,
    Gaps,
    MeshReading,
    ReadingEngine,
)

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
