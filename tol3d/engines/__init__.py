"""Engines answer one question: how far apart are the flanks of each candidate tooth pair of a Build."""

from tol3d.engines.gaps import Engine, Gaps

__all__ = ["Engine", "Gaps"]
