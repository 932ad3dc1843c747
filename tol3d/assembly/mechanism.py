"""General assemblies as a mechanism: parts with drawings, moves, measures."""

from typing import Final

from tol3d.assembly.grammar import measures, moves, parts, tolerances
from tol3d.assembly.grammar.boundary_checks import unfit_boundaries, unfit_modifiers
from tol3d.assembly.grammar.checks import (
    differences_of_two_poses,
    general_sizes,
    unknown_features,
    unknown_poses,
    unplaced_bodies,
)
from tol3d.assembly.grammar.contact_checks import idle_over_play, idle_rocking, unfit_moves, unfit_pairs
from tol3d.assembly.grammar.drawing_checks import (
    contradicting_tolerances,
    features_far_off,
    fits_of_other_sizes,
    forms_beyond_orientations,
    implausible_leans,
    implausible_sizes,
)
from tol3d.assembly.grammar.measure_checks import (
    missing_solids,
    mixed_dimensions,
    seen_by_nothing,
    unfit_holes,
    unfit_patterns,
    unfit_points,
)
from tol3d.assembly.grammar.orientation_checks import unfit_orientations
from tol3d.scene.grammar import specs_in
from tol3d.scene.temperature import TemperatureSpec
from tol3d.study.system.mechanism import Mechanism

OTHER_KINDS: Final = (
    ("concentricity", "it left ASME Y14.5 in 2018: write coaxiality, of the axis, as in ISO 1101"),
    ("composite_position", "write position, with a lower_segment"),
    ("composite_profile", "write profile, with a lower_segment"),
    ("face_run_out", "write axial_run_out"),
    ("surface_profile", "write profile"),
    ("profile_of_a_surface", "write profile"),
    ("true_position", "write position"),
    ("positional_tolerance", "write position"),
    ("squareness", "write perpendicularity"),
    ("concentric", "write coaxiality, of the axis, as in ISO 1101"),
    ("runout", "write circular_run_out, total_run_out or, of a face, axial_run_out"),
    ("run_out_tolerance", "write circular_run_out or total_run_out"),
    ("linear_dimension", "write plus_minus for where a feature lies, size for a diameter or a width"),
    ("bilateral", "write plus_minus for where a feature lies, size for a diameter or a width"),
    ("circularity", "write roundness"),
    ("dimension", "write plus_minus for where a feature lies, size for a diameter or a width"),
    ("diameter", "write size, or inspected_size of a measure"),
    ("width", "write size, or inspected_size of a measure"),
    ("taper", "write cone, with its `diameters` at both ends"),
    ("countersink", "write cone, with its `diameters` at both ends and hole: true"),
    ("line", "write axis"),
    *((word, "write three_two_one") for word in ("3-2-1", "3_2_1", "321", "three_two_one_locators", "locators")),
    *((word, "write six_plane") for word in ("six_point", "6_point", "6-point", "6_plane")),
    ("fixed", "write fix, or constant of a distribution"),
    *((word, "write fix") for word in ("ground", "grounded")),
    *((word, "write mate, with such a relation in its relations") for word in ("coincident", "flush_mate", "tangent")),
    *(
        (word, "write pattern, with a bolt in its pairs, or weld")
        for word in ("bolt", "bolts", "screw_joint", "fasten")
    ),
    *((word, "write pin_and_hole") for word in ("pin_hole", "pin_in_hole", "peg_in_hole", "insert")),
    ("statistical", "statistical tolerances (ST) are not supported: name the law of the process"),
)
OTHER_KEYS: Final = (
    ("composite", "write lower_segment: {zone: …, datums: …}"),
    ("tangent_plane", "leave it out: an orientation is of the plane in contact, and form takes nothing of it"),
    ("tangent", "leave it out: an orientation is of the plane in contact, and form takes nothing of it"),
    ("translation", "datums that may shift (a triangle) are not supported: leave the datum out, or name it with `mmb`"),
    ("freedoms", "customised datum freedoms are not supported: each datum takes what earlier ones leave"),
    ("statistical", "statistical tolerances (ST) are not supported: name the law of the process"),
    ("st", "statistical tolerances (ST) are not supported: name the law of the process"),
    ("non_uniform", "non-uniform profiles are not supported: `outward` makes one unequal"),
    ("rule_1", "write standard: asme; of single sizes, or for the envelope requirement of ISO, envelope: true"),
)

ASSEMBLY: Final = Mechanism(
    name="assembly",
    parts=specs_in(parts),
    tolerances=(*specs_in(tolerances), TemperatureSpec),
    moves=specs_in(moves),
    measures=specs_in(measures),
    checks=(
        unknown_features,
        unplaced_bodies,
        unknown_poses,
        differences_of_two_poses,
        contradicting_tolerances,
        unfit_orientations,
        unfit_modifiers,
        unfit_boundaries,
        mixed_dimensions,
        missing_solids,
        seen_by_nothing,
        unfit_points,
        idle_rocking,
        unfit_holes,
        unfit_patterns,
        unfit_moves,
        idle_over_play,
        unfit_pairs,
    ),
    warnings=(
        implausible_sizes,
        implausible_leans,
        fits_of_other_sizes,
        features_far_off,
        forms_beyond_orientations,
    ),
    general=(general_sizes,),
    other_kinds=OTHER_KINDS,
    other_keys=OTHER_KEYS,
    engines=("exact",),
    witness="fcl",
    system="tol3d.assembly.posed:system_of",
    settle="tol3d.assembly.picking:settle",
    summary="tol3d.assembly.summary_types:SUMMARY_KINDS",
    presenter="tol3d.assembly.presenting",
    starters="tol3d.assembly:starters",
)
