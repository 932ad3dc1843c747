"""Questions about a scene that take several studies, each run as it stands: what to change so that a wish holds."""

from tol3d.analyses.shim import ShimPlan, ShimQuestion, shim_plan
from tol3d.analyses.shim_choice import Shimmed
from tol3d.analyses.stock import Pieces, Step, Stock, length_of, stock_of

__all__ = ["Pieces", "ShimPlan", "ShimQuestion", "Shimmed", "Step", "Stock", "length_of", "shim_plan", "stock_of"]
