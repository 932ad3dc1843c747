"""Types of arrays, and products whose bits do not depend on the number of trials."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Places = NDArray[np.int64]


def times(rows: Array, columns: Array) -> Array:
    """Product (…, n) of rows (…, f) and columns (f, n) of trials, the addends in the order of f.

    numpy's own products and `einsum` add one trial alone in another order than many, and leave other last bits.
    """
    found = np.zeros((*rows.shape[:-1], columns.shape[1]))
    for k, column in enumerate(columns):
        found += rows[..., k, None] * column
    return found
