"""Correlated contributors: a Gaussian copula, a matrix of correlations in the standard normals of their laws.

Each contributor keeps its own law: a uniform u of its stream is mapped to Φ⁻¹(u), the normals of a block are mixed by
the Cholesky factor of its matrix, and the result is mapped back by Φ. The first of a block is drawn as without it.

Source: Nataf 1962; Nelsen, An Introduction to Copulas (2006), 2.8.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import ndtr, ndtri

from tol3d.numerics.arrays import Array
from tol3d.study.system.normals import LEAST, MOST


@dataclass(frozen=True)
class Block:
    """Contributors that are correlated with each other, and with no others.

    Args:
        names: of the contributors, each drawn by one uniform.
        matrix: correlations of their normals (names, names), positive definite.
    """

    names: tuple[str, ...]
    matrix: tuple[tuple[float, ...], ...]

    @cached_property
    def correlation(self) -> Array:
        """The matrix as an array (names, names)."""
        return np.array(self.matrix)

    @cached_property
    def factor(self) -> Array:
        """Its lower Cholesky factor (names, names), which times independent normals gives correlated ones."""
        return np.asarray(np.linalg.cholesky(self.correlation))

    def mixed(self, normals: Sequence[Array]) -> list[Array]:
        """Correlated normals (n,) of each name from independent ones, without BLAS: its last bits depend on shapes."""
        return [
            sum((self.factor[i, k] * normals[k] for k in range(1, i + 1)), self.factor[i, 0] * normals[0])
            for i in range(len(self.names))
        ]

    def uniforms(self, uniforms: Sequence[Array]) -> list[Array]:
        """Correlated uniforms (n,) of each name from independent ones; the first is unchanged."""
        normals = self.mixed([ndtri(np.clip(uniform, LEAST, MOST)) for uniform in uniforms])
        return [uniforms[0], *(np.clip(ndtr(normal), LEAST, MOST) for normal in normals[1:])]


@dataclass(frozen=True)
class Copula:
    """Blocks of correlated contributors, without a contributor in two of them.

    Args:
        blocks: of the contributors; none if all are independent.
    """

    blocks: tuple[Block, ...] = ()

    def uniforms(self, independent: Mapping[str, Array]) -> Mapping[str, Array]:
        """Correlated uniforms (n,) by name, from independent ones of all contributors in blocks."""
        correlated: dict[str, Array] = {}
        for block in self.blocks:
            correlated |= dict(
                zip(block.names, block.uniforms([independent[name] for name in block.names]), strict=True)
            )
        return correlated

    @cached_property
    def names(self) -> frozenset[str]:
        """Names of all correlated contributors."""
        return frozenset(name for block in self.blocks for name in block.names)


INDEPENDENT = Copula()
"""No contributor is correlated with any other."""
