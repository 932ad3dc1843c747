"""The one door to the exact engine: numba, which it needs, is loaded only by who uses it."""

import importlib

from tol3d.engines.gaps import ReadingEngine
from tol3d.model import Model


def exact_engine(model: Model) -> ReadingEngine:
    """The exact engine of a model."""
    engine: ReadingEngine = importlib.import_module("tol3d.engines.exact").ExactEngine(model)
    return engine
