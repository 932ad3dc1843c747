"""Gears in a machined housing, as a mechanism: one move that joins the kinds of gears with those of assemblies."""

from typing import Final

from tol3d.gearbox.grammar.checks import laid_too_early, laid_twice, shafts_thicker_than_bores
from tol3d.gearbox.grammar.shaft_in_bores import ShaftInBoresSpec
from tol3d.system.mechanism import Mechanism

GEARBOX: Final = Mechanism(
    name="gearbox",
    moves=(ShaftInBoresSpec,),
    checks=(laid_twice, laid_too_early),
    warnings=(shafts_thicker_than_bores,),
    includes=("gearing", "assembly"),
    engines=("exact", "fcl"),
    system="tol3d.gearbox.from_scene:gearbox_system",
    presenter="tol3d.gearbox.presenting",
    requires=("python-fcl", "cadquery"),
)
