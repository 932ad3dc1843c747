"""From what a scene says to the assembly that it means.

datums          datum frames, each once
contributors    how tolerances are drawn, and what each moves
zones, laws     the zone that is left to a feature, and its draw
segments        composite tolerances: patterns within patterns
thermal_growth  parts that are warmer grow
boundaries      the gauges of datums at their material boundaries
effects         all contributors with what they change
features        nominal shapes and frames, with what moves them
contact_points  points of planes at which moves lay parts
setting         what a move of a scene is made in
moves, play     pairs, normals, locators; engagements and their draws
measures        what is read
idle            tolerances that act on nothing
assembly        all of it together
"""

from tol3d.assembly.from_scene.assembly import Meant, meant, understood
from tol3d.assembly.from_scene.setting import Understood

__all__ = ["Meant", "Understood", "meant", "understood"]
