"""Lazy imports of the engines: numba and FCL are loaded only where they are used."""

import importlib
from collections.abc import Mapping

from tol3d.gearing.engines.gaps import Engine, ReadingEngine
from tol3d.gearing.model import Model
from tol3d.solids import FlankStrips

EXACT = "tol3d.gearing.engines.exact"
FCL = "tol3d.gearing.engines.fcl"


def exact_engine(model: Model) -> ReadingEngine:
    """The exact engine of a model."""
    engine: ReadingEngine = importlib.import_module(EXACT).ExactEngine(model)
    return engine


def exact_is_compiled(model: Model) -> bool:
    """Whether the exact engine's kernels for a model were compiled on this machine before."""
    return bool(importlib.import_module(EXACT).ExactEngine(model).kept)


def fcl_engine(model: Model, strips: Mapping[str, FlankStrips]) -> Engine:
    """FCL on the measuring strips of every gear, by its name."""
    engine: Engine = importlib.import_module(FCL).FclEngine(model, strips)
    return engine
