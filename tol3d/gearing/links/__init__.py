"""Links of shafts that are no gear meshes: what a train asks of one, and the kinds that tol3d brings along."""

from tol3d.gearing.links.reducer import Reducer
from tol3d.gearing.links.stated_link import FreeTurn, LinkSum, LinkTrials, Moved, StatedLink, pin_name

__all__ = ["FreeTurn", "LinkSum", "LinkTrials", "Moved", "Reducer", "StatedLink", "pin_name"]
