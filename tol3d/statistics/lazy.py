"""Lazy import of compiled statistics: numba, which they need, is loaded only where it compiles trials too."""

import importlib

from tol3d.statistics.variance_shares import Products


def quick_products() -> Products:
    """Sums of products, compiled."""
    products: Products = importlib.import_module("tol3d.statistics.quick_products").quick_products
    return products
