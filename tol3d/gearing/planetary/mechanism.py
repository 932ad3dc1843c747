"""Planetary sets, as a mechanism: planets between central gears, solved together."""

from typing import Final

from tol3d.gearing.planetary.grammar import measures, moves, parts, tolerances
from tol3d.gearing.planetary.grammar.published import PublishedPlanetarySets
from tol3d.scene.grammar import specs_in
from tol3d.study.system.mechanism import Mechanism

PLANETARY: Final = Mechanism(
    name="planetary",
    parts=specs_in(parts),
    tolerances=specs_in(tolerances),
    moves=specs_in(moves),
    measures=specs_in(measures),
    warnings=(parts.implausible_springs,),
    published=PublishedPlanetarySets,
    includes=("gearing",),
    extends=("gearing",),
    engines=("exact", "fcl"),
    witness="fcl",
    system="tol3d.gearing.planetary.from_scene:planetary_system",
    links="tol3d.gearing.planetary.set_link:sets_as_links",
    summary="tol3d.gearing.planetary.summary_types:SUMMARY_KINDS",
    presenter="tol3d.gearing.planetary.presenting",
    starters="tol3d.gearing.planetary:starters",
    requires=("python-fcl", "cadquery"),
)
