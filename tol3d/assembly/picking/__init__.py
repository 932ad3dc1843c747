"""Features that a scene picks from the solids of its parts: their numbers, looked up once when the scene is read.

settled        a scene with all numbers, and what was found; stated numbers are checked against their faces
kept_picks     what was found, as a file that runs keep
step_picks     features that are selected on parts from STEP files
"""

from tol3d.assembly.picking.settled import settle

__all__ = ["settle"]
