"""Seed and contributors to deviations: every draw is keyed, so a trial can be replayed alone.

A uniform depends on (seed, name, component, trial index) and on nothing else: not on the number of
trials, on blocks or workers, nor on the other contributors.
"""

import hashlib
import math
import unicodedata

import numpy as np
from numpy.typing import NDArray

from tol3d.model import Mesh, Model, Planar, Positions, TurningOffset

Array = NDArray[np.float64]

WORDS_PER_COUNTER = 4  # Philox4x64 makes four 64-bit words for each counter value; a trial uses the first
DRAW_BITS = 52  # k + 1/2 of a 53-bit k would not be a double, and the largest k would round to u = 1


def stream_key(seed: int, name: str, component: str) -> int:
    """Philox key of one stream: the first 128 bits of SHA-256 over seed, NFC name and component."""
    text = "\0".join((str(seed), unicodedata.normalize("NFC", name), component))
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:16], "little")


def uniforms(seed: int, name: str, component: str, first: int, count: int) -> Array:
    """Uniforms of trials first ... first + count - 1, shape (count,), inside (0, 1).

    Counter value i serves trial i: u = (k + 1/2) 2^-52, k the upper 52 bits of its first word.
    Source of the generator: Salmon et al., Parallel random numbers: as easy as 1, 2, 3 (SC 2011).
    """
    generator = np.random.Philox(key=stream_key(seed, name, component), counter=first)
    words = np.asarray(generator.random_raw(WORDS_PER_COUNTER * count)[::WORDS_PER_COUNTER], dtype=np.uint64)
    return ((words >> np.uint64(64 - DRAW_BITS)).astype(np.float64) + 0.5) * 2.0**-DRAW_BITS


def deviations(model: Model, seed: int, first: int, count: int) -> Array:
    """Deviations of trials first ... first + count - 1: (count, components) [mm, rad or K].

    Columns follow `model.component_slices`.
    """
    rows = np.empty((count, model.component_count))
    for contributor in model.contributors:
        draws = np.stack(
            [uniforms(seed, contributor.name, str(k), first, count) for k in range(contributor.draw.uniforms)], axis=1
        )
        rows[:, model.component_slices[contributor.name]] = contributor.draw.deviations(draws)
    return rows


def mean_deviations(model: Model, positions: Positions) -> Array:
    """Every contributor at its mean, shape (1, components).

    A random direction averages to zero, and so does an offset that turns with its gear at random positions.
    """
    row = np.zeros((1, model.component_count))
    for contributor in model.contributors:
        columns = model.component_slices[contributor.name]
        mean = contributor.distribution.mean
        if not isinstance(contributor.draw, Planar):
            row[:, columns] = mean
        elif contributor.draw.direction is not None and not (
            positions.over == "random" and isinstance(contributor.effect, TurningOffset)
        ):
            angle = contributor.draw.direction
            row[:, columns] = (mean * math.cos(angle), mean * math.sin(angle))
    return row


def random_driver_angle(mesh: Mesh, seed: int, first: int, count: int) -> Array:
    """Driver position of each trial [rad], uniform over the long period of the mesh, shape (count,)."""
    period = 2 * math.pi * mesh.pair.long_period_turns
    return period * uniforms(seed, mesh.name, "driver position", first, count)
