"""Lazy import of compiled statistics: numba, which they need, is loaded only where it compiles trials too."""

import importlib
from typing import Any

from tol3d.statistics.independent_sums import CrossProducts
from tol3d.statistics.variance_shares import Products


def quick_products() -> Products:
    """Sums of products, compiled."""
    products: Products = _compiled().quick_products
    return products


def cross_products() -> CrossProducts:
    """Sums of products of features and targets, compiled."""
    products: CrossProducts = _compiled().cross_products
    return products


def _compiled() -> Any:
    return importlib.import_module("tol3d.statistics.quick_products")
