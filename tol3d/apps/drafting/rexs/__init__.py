"""Scenes drafted from REXS files, in which gear programs exchange gearboxes.

`container.py` finds the text in a file, `xml_text.py` and `json_text.py` read it as a `document.py`, `reading.py` makes
the `gearbox.py` of that, `kinematics.py` finds what drives what, and `scene.py` writes the scene. Facts of the format:
rexs.info, database models 1.0 to 2.0.
"""

from tol3d.apps.drafting.rexs.container import is_rexs
from tol3d.apps.drafting.rexs.scene import gearbox_scene_from

__all__ = ["gearbox_scene_from", "is_rexs"]
