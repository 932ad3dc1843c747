"""Lazy import of compiled draws: numba, which they need, is loaded only where it compiles trials too."""

import importlib

from tol3d.statistics.samplers.stream import Sampler


def quick_monte_carlo(seed: int) -> Sampler:
    """MonteCarlo, compiled: the same bits."""
    sampler: Sampler = importlib.import_module("tol3d.statistics.samplers.quick_uniforms").QuickMonteCarlo(seed)
    return sampler
