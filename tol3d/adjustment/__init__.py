"""Adjustments of gears that are made: shims of a thickness, a correction of a motor, each found by several studies."""

from tol3d.adjustment.shim import ShimPlan, ShimQuestion, shim_plan
from tol3d.adjustment.shim_choice import Shimmed
from tol3d.adjustment.stock import Pieces, Step, Stock, length_of, stock_of

__all__ = ["Pieces", "ShimPlan", "ShimQuestion", "Shimmed", "Step", "Stock", "length_of", "shim_plan", "stock_of"]
