"""Lazy import of compiled statistics: numba, which they need, is loaded only where it compiles trials too."""

import importlib
from typing import cast

from tol3d.statistics.estimates import independent_sums, variance_shares


def quick_products() -> variance_shares.Products:
    """Sums of products of all pairs of rows, compiled."""
    products: variance_shares.Products = importlib.import_module(
        "tol3d.statistics.estimates.quick_products"
    ).quick_products
    return products


def sparse_products() -> independent_sums.Products:
    """Sums of products of some pairs of rows, compiled."""
    return cast(independent_sums.Products, importlib.import_module("tol3d.statistics.estimates.quick_products"))
