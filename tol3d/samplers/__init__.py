"""Samplers of uniforms: each gives any trials of any stream, alone, as pure functions of its key."""

from tol3d.samplers.latin_hypercube import LatinHypercube
from tol3d.samplers.monte_carlo import MonteCarlo
from tol3d.samplers.sobol import Sobol
from tol3d.samplers.stream import Sampler, Stream

__all__ = ["LatinHypercube", "MonteCarlo", "Sampler", "Sobol", "Stream"]
