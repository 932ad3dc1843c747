"""Adjustments of gears that are made: shims of a thickness, a correction of a motor, each found by several studies."""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.apps.adjustment.answers import find_shims
    from tol3d.apps.adjustment.shim import ShimPlan, ShimQuestion, shim_plan
    from tol3d.apps.adjustment.shim_choice import Shimmed
    from tol3d.apps.adjustment.stock import Pieces, Step, Stock, length_of, stock_of

_HOMES = {
    "Pieces": "tol3d.apps.adjustment.stock",
    "ShimPlan": "tol3d.apps.adjustment.shim",
    "ShimQuestion": "tol3d.apps.adjustment.shim",
    "Shimmed": "tol3d.apps.adjustment.shim_choice",
    "Step": "tol3d.apps.adjustment.stock",
    "Stock": "tol3d.apps.adjustment.stock",
    "find_shims": "tol3d.apps.adjustment.answers",
    "length_of": "tol3d.apps.adjustment.stock",
    "shim_plan": "tol3d.apps.adjustment.shim",
    "stock_of": "tol3d.apps.adjustment.stock",
}

__all__ = [
    "Pieces",
    "ShimPlan",
    "ShimQuestion",
    "Shimmed",
    "Step",
    "Stock",
    "find_shims",
    "length_of",
    "shim_plan",
    "stock_of",
]

__getattr__, __dir__ = lazy_names(__name__, _HOMES)
