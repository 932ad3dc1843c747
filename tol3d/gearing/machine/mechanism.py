"""Machines, as a mechanism: moves that join the kinds of gears with those of assemblies, at bores and at joints."""

from typing import Final

from tol3d.gearing.machine.grammar.bores import CarrierPinsSpec, ShaftInBoresSpec
from tol3d.gearing.machine.grammar.checks import (
    joints_named_twice,
    laid_too_early,
    laid_twice,
    read_over_paths,
    shafts_thicker_than_bores,
    unfit_worst_errors,
)
from tol3d.gearing.machine.grammar.open_chain import OpenChainSpec, WorstPositionErrorSpec
from tol3d.study.system.mechanism import Mechanism

SERIAL: Final = ("serial_robot", "robot", "robot_arm", "serial_chain", "kinematic_chain", "manipulator", "chain")

MACHINE: Final = Mechanism(
    name="machine",
    moves=(CarrierPinsSpec, OpenChainSpec, ShaftInBoresSpec),
    measures=(WorstPositionErrorSpec,),
    checks=(laid_twice, read_over_paths, laid_too_early, joints_named_twice, unfit_worst_errors),
    warnings=(shafts_thicker_than_bores,),
    other_kinds=tuple((word, "write open_chain, with its joints") for word in SERIAL),
    includes=("gearing", "assembly"),
    engines=("exact", "fcl"),
    system="tol3d.gearing.machine.from_scene:machine_system",
    summary="tol3d.gearing.machine.summary_types:SUMMARY_KINDS",
    presenter="tol3d.gearing.machine.presenting",
    starters="tol3d.gearing.machine:starters",
    requires=("python-fcl", "cadquery"),
)
