"""RV reducers as a mechanism: cycloid discs on crankshafts among pins, and the spur gears that drive them."""

from typing import Final

from tol3d.gearing.cycloid.grammar import measures, moves, parts, tolerances
from tol3d.gearing.cycloid.grammar.published import PublishedCycloidStages
from tol3d.gearing.cycloid.grammar.tolerances import implausible_discs, implausible_grinding, implausible_pins
from tol3d.scene.grammar import specs_in
from tol3d.study.system.mechanism import Mechanism

CYCLOID: Final = Mechanism(
    name="cycloid",
    parts=specs_in(parts),
    tolerances=specs_in(tolerances),
    moves=specs_in(moves),
    measures=specs_in(measures),
    warnings=(implausible_grinding, implausible_pins, implausible_discs),
    published=PublishedCycloidStages,
    includes=("gearing",),
    extends=("gearing",),
    engines=("exact",),
    witness="fcl",
    system="tol3d.gearing.cycloid.from_scene:rv_system",
    links="tol3d.gearing.cycloid.rv_link:reducers_as_links",
    summary="tol3d.gearing.cycloid.summary_types:SUMMARY_KINDS",
    presenter="tol3d.gearing.cycloid.presenting",
    starters="tol3d.gearing.cycloid:starters",
    requires=("python-fcl", "cadquery"),
)
"""The mechanism of RV reducers; it extends that of gears."""
