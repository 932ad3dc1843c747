"""Features in parts, and parts in clusters that are independent of each other."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Places = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Pattern:
    """Clusters of parts of the same sizes.

    Args:
        sizes: features of each part, in a cluster's order.
        parts: (clusters, parts of a cluster).
        columns: (clusters, features of a cluster).
        pairs: (clusters, features of a cluster, features of a cluster), places in `Clusters.pairs`.
    """

    sizes: tuple[int, ...]
    parts: Places
    columns: Places
    pairs: Places

    def within(self) -> Iterator[tuple[Places, slice]]:
        """Each part of all clusters (clusters,), and its features among those of its cluster."""
        start = 0
        for place, size in enumerate(self.sizes):
            yield self.parts[:, place], slice(start, start + size)
            start += size


@dataclass(frozen=True, eq=False)
class Clusters:
    """Features that are cut into parts, such as the regressors of contributors, and parts into clusters.

    Args:
        sizes: (parts,), features of each; they follow each other.
        together: (parts,), a number for each, the same of parts of one cluster.
    """

    sizes: Places
    together: Places

    @cached_property
    def starts(self) -> Places:
        """First feature of each part, and the number of all."""
        return np.concatenate([[0], np.cumsum(self.sizes)]).astype(np.intp)

    @property
    def features(self) -> int:
        """Number of features."""
        return int(self.starts[-1])

    @cached_property
    def patterns(self) -> tuple[Pattern, ...]:
        """All clusters, those of one pattern together."""
        order = np.argsort(self.together, kind="stable")
        cuts = np.flatnonzero(np.diff(self.together[order])) + 1
        members = np.diff(np.concatenate([[0], cuts, [len(order)]]))
        single = np.repeat(members == 1, members)
        alone, others = np.sort(order[single]), order[~single]
        alike: dict[tuple[int, ...], list[Places]] = {}
        for size in np.unique(self.sizes[alone]).tolist():
            alike[(size,)] = [*alone[self.sizes[alone] == size]]
        for cluster in np.split(others, np.cumsum(members[members > 1])[:-1]) if len(others) else ():
            alike.setdefault(tuple(self.sizes[cluster].tolist()), []).append(cluster)
        patterns, pairs = [], 0
        for sizes, clusters in alike.items():
            parts = np.array(clusters, dtype=np.intp).reshape(-1, len(sizes))
            own = [self.starts[parts[:, k], None] + np.arange(size) for k, size in enumerate(sizes)]
            columns = np.concatenate(own, axis=1)
            width = columns.shape[1]
            each = np.arange(width * width).reshape(width, width)
            patterns.append(
                Pattern(sizes, parts, columns, pairs + each + np.arange(len(parts))[:, None, None] * width * width)
            )
            pairs += len(parts) * width * width
        return tuple(patterns)

    @cached_property
    def pairs(self) -> tuple[Places, Places]:
        """Both features (pairs,) of all pairs within clusters, each in both orders."""
        firsts = [
            np.broadcast_to(pattern.columns[:, :, None], pattern.pairs.shape).ravel() for pattern in self.patterns
        ]
        seconds = [
            np.broadcast_to(pattern.columns[:, None, :], pattern.pairs.shape).ravel() for pattern in self.patterns
        ]
        none: Places = np.zeros(0, dtype=np.intp)
        return np.concatenate([none, *firsts]), np.concatenate([none, *seconds])

    @property
    def all(self) -> "Picked":
        """All of the parts."""
        return Picked(self, np.arange(self.features), np.arange(len(self.pairs[0])))

    def part(self, chosen: Places) -> "Picked":
        """Some of the parts (chosen,), in their order; the rest of a cluster stays together."""
        own = Clusters(self.sizes[chosen], self.together[chosen])
        rows = np.repeat(self.starts[chosen] - own.starts[:-1], own.sizes) + np.arange(own.features)
        wanted = rows[own.pairs[0]] * self.features + rows[own.pairs[1]]
        keys, order = self._sorted_pairs
        return Picked(own, rows, order[np.searchsorted(keys, wanted)])

    @cached_property
    def _sorted_pairs(self) -> tuple[Places, Places]:
        """Numbers of the pairs in their order, and where each pair is among them."""
        keys = self.pairs[0] * self.features + self.pairs[1]
        order = np.argsort(keys)
        return keys[order], order


@dataclass(frozen=True, eq=False)
class Picked:
    """Some parts of clusters.

    Args:
        clusters: of the features.
        rows: their features among those of all.
        pairs: their pairs among those of all.
    """

    clusters: Clusters
    rows: Places
    pairs: Places
