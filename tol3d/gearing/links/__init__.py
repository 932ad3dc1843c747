"""Links of shafts that are no gear meshes: their interface, and the bundled kinds."""

from tol3d.gearing.links.reducer import Reducer
from tol3d.gearing.links.stated_link import FreeTurn, LinkSum, LinkTrials, Moved, StatedLink, pin_name

__all__ = ["FreeTurn", "LinkSum", "LinkTrials", "Moved", "Reducer", "StatedLink", "pin_name"]
