"""The one door to the exact engine: numba, which it needs, is loaded only by who uses it."""

import importlib

from tol3d.gearing.engines.gaps import ReadingEngine
from tol3d.gearing.model import Model

EXACT = "tol3d.gearing.engines.exact"


def exact_engine(model: Model) -> ReadingEngine:
    """The exact engine of a model."""
    engine: ReadingEngine = importlib.import_module(EXACT).ExactEngine(model)
    return engine


def exact_is_compiled(model: Model) -> bool:
    """Whether the exact engine's kernels for a model were compiled on this machine before."""
    return bool(importlib.import_module(EXACT).ExactEngine(model).kept)
