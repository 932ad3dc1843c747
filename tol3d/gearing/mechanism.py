"""Gears in mesh and the trains that they make, as a mechanism."""

from typing import Final

from tol3d.gearing.grammar import measures, moves, parts, tolerances
from tol3d.gearing.grammar.checks import (
    bearings_off_shafts,
    carried_again,
    forms_of_two_shapes,
    implausible_displacements,
    implausible_faces,
    shafts_thicker_than_hubs,
)
from tol3d.gearing.grammar.published import PublishedTrains
from tol3d.gearing.grammar.study import GearStudyOptions
from tol3d.scene.grammar import specs_in
from tol3d.scene.temperature import TemperatureSpec
from tol3d.system.mechanism import Mechanism

GEARING: Final = Mechanism(
    name="gearing",
    parts=specs_in(parts),
    tolerances=(*specs_in(tolerances), TemperatureSpec),
    moves=specs_in(moves),
    measures=specs_in(measures),
    checks=(carried_again, forms_of_two_shapes),
    warnings=(implausible_displacements, implausible_faces, bearings_off_shafts, shafts_thicker_than_hubs),
    options=GearStudyOptions,
    published=PublishedTrains,
    engines=("exact", "fcl"),
    witness="fcl",
    system="tol3d.gearing.system:gear_system",
    summary="tol3d.gearing.summary_types:SUMMARY_KINDS",
    presenter="tol3d.gearing.presenting",
    requires=("python-fcl", "cadquery"),
)
