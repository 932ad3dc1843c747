"""Samplers of uniforms: each gives any trials of any stream, alone, as pure functions of its key."""

from tol3d.statistics.samplers.latin_hypercube import LatinHypercube
from tol3d.statistics.samplers.monte_carlo import MonteCarlo
from tol3d.statistics.samplers.sobol import Sobol
from tol3d.statistics.samplers.stream import Sampler, Stream

__all__ = ["LatinHypercube", "MonteCarlo", "Sampler", "Sobol", "Stream"]
