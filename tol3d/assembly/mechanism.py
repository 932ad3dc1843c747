"""General assemblies as a mechanism: parts with drawings, moves, measures."""

from typing import Final

from tol3d.assembly.grammar import measures, moves, parts, tolerances
from tol3d.assembly.grammar.boundary_checks import unfit_boundaries
from tol3d.assembly.grammar.checks import unknown_features, unplaced_bodies
from tol3d.assembly.grammar.contact_checks import round_contacts
from tol3d.assembly.grammar.drawing_checks import contradicting_tolerances
from tol3d.assembly.grammar.measure_checks import (
    missing_solids,
    mixed_dimensions,
    unfit_holes,
    unfit_patterns,
    unfit_points,
)
from tol3d.assembly.grammar.modifier_checks import unfit_modifiers
from tol3d.assembly.grammar.orientation_checks import unfit_orientations
from tol3d.assembly.grammar.play_checks import idle_over_play, unfit_engagements
from tol3d.assembly.grammar.rest_checks import idle_rocking
from tol3d.assembly.grammar.surface_checks import unfit_pairs
from tol3d.scene.grammar import specs_in
from tol3d.scene.temperature import TemperatureSpec
from tol3d.system.mechanism import Mechanism

ASSEMBLY: Final = Mechanism(
    name="assembly",
    parts=specs_in(parts),
    tolerances=(*specs_in(tolerances), TemperatureSpec),
    moves=specs_in(moves),
    measures=specs_in(measures),
    checks=(
        unknown_features,
        unplaced_bodies,
        contradicting_tolerances,
        unfit_orientations,
        unfit_modifiers,
        unfit_boundaries,
        mixed_dimensions,
        missing_solids,
        unfit_points,
        idle_rocking,
        unfit_holes,
        unfit_patterns,
        unfit_engagements,
        idle_over_play,
        unfit_pairs,
        round_contacts,
    ),
    engines=("exact",),
    witness="fcl",
    system="tol3d.assembly.system:assembly_system",
    settle="tol3d.assembly.picking:settle",
    summary="tol3d.assembly.summary_types:SUMMARY_KINDS",
    presenter="tol3d.assembly.presenting",
)
