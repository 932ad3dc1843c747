"""From what a scene says to the assembly that it means.

features      nominal shapes and frames
datums        datum frames, each once
bonus         the size that widens a zone
boundaries    the gauges of datums at their maximum material boundary
contributors  how tolerances are drawn, and what each moves
projected     axes beyond their ends
zones         the zone that is left to a feature, and its law
moves         pairs, normals, locators
measures      what is read
warming       parts that are warmer grow
assembly      all of it together
"""

from tol3d.assembly.from_scene.assembly import Meant, meant, understood
from tol3d.assembly.from_scene.setting import Understood

__all__ = ["Meant", "Understood", "meant", "understood"]
