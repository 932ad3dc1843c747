"""Contributors with two components, read from the columns of trials."""

from collections.abc import Mapping

import numpy as np


def vector(columns: Mapping[str, np.ndarray], *names: str) -> np.ndarray:
    """The sum of some contributors with components x and y, (n, 2) [um]."""
    each = [np.stack([columns[f"{name}.{axis} [um]"] for axis in "xy"], axis=1) for name in names]
    return np.asarray(np.sum(each, axis=0))
