"""Gears in mesh and the trains that they make, as a mechanism."""

from types import ModuleType
from typing import Any, Final

from tol3d.gearing import grammar
from tol3d.gearing.grammar import tolerances
from tol3d.gearing.grammar.checks import (
    bearings_off_shafts,
    carried_again,
    fits_of_other_distances,
    forces_of_helices,
    forms_of_two_shapes,
    general_distances,
    helices_elsewhere,
    implausible_angles,
    implausible_displacements,
    implausible_faces,
    implausible_shafts,
    readings_of_helices,
    second_axial_plays,
    shafts_thicker_than_hubs,
    steep_helices,
    unloaded_bearings,
)
from tol3d.gearing.grammar.measures import GearStudyOptions
from tol3d.gearing.grammar.published import PublishedTrains
from tol3d.scene.bases import MeasureEntry, MoveSpec, PartSpec, ToleranceEntry
from tol3d.scene.entry import Entry, kind_of
from tol3d.scene.grammar import specs_in
from tol3d.scene.temperature import TemperatureSpec
from tol3d.study.system.mechanism import Mechanism


def _kinds(base: type[Entry], place: ModuleType = grammar) -> tuple[type[Any], ...]:
    """The kinds of a section that the files of a folder define, by their words: a new file may bring some."""
    found = (spec for spec in specs_in(place) if issubclass(spec, base))
    return tuple(sorted(found, key=lambda spec: str(kind_of(spec))))


SINGLE: Final = "write pitch_deviation with limits: {single: …, cumulative: …} or {iso_class: …}"
RUN_OUT: Final = "write tooth_run_out: the run-out of teeth; run_out is of a shaft"
COMPOSITE: Final = "write tooth_run_out of F_i'' - f_i'', and beside it tooth_to_tooth with limits: {size: f_i''}"
DISTANCE: Final = "write centre_distance, with {din_3964: js7}"
THICKNESS: Final = "write tooth_thickness, with {din_3967: cd25} or its allowances"
SPAN, PINS = (f"write tooth_thickness with measured: {{{word}: …}}" for word in ("span", "pins"))
BACKLASH: Final = "write normal_backlash, circumferential_backlash, angular_backlash or, of a train, lost_motion"
ANY_GEAR: Final = "write spur_gear, helical_gear, bevel_gear or, of a ring, internal_gear"
NO_HELIX: Final = "spiral, hypoid and worm gears are not supported: docs/limits.md"
HELIX_SIGN: Final = "write helix_angle, and hand: right or left"
HELICAL: Final = "gears of kind helical_gear or internal_gear have it; teeth of spur and bevel gears are straight"

OTHER_KINDS: Final = (
    *((word, RUN_OUT) for word in ("F_r", "Fr", "gear_run_out", "radial_run_out")),
    *((word, COMPOSITE) for word in ("F_i''", "F_i″", "Fi''", "radial_composite", "radial_composite_deviation")),
    *((word, "write tooth_to_tooth with limits: {size: …}") for word in ("f_i''", "f_i″", "fi''")),
    *((word, THICKNESS) for word in ("E_sn", "E_s", "A_s", "A_sn", "A_sne")),
    *((word, DISTANCE) for word in ("f_a", "A_a", "centre_distance_class")),
    *((word, SPAN) for word in ("W_k", "base_tangent_length", "span")),
    *((word, PINS) for word in ("M_dK", "over_pins", "over_balls")),
    *((word, SINGLE) for word in ("f_p", "f_pt", "F_p")),
    ("f_Ha", "write profile_slope"),
    ("f_Hb", "write helix_slope"),
    ("f_fa", "write profile_form"),
    ("f_sigma_delta", "write axis_in_plane"),
    ("f_sigma_beta", "write axis_out_of_plane"),
    *((word, NO_HELIX) for word in ("worm", "worm_gear", "hypoid_gear", "spiral_bevel_gear")),
    *((word, ANY_GEAR) for word in ("gear", "pinion", "cylindrical_gear")),
    *((word, BACKLASH) for word in ("backlash", "slop", "gear_play", "free_play")),
    *((word, "write mesh, or bevel_mesh") for word in ("gear_pair", "gear_mesh", "gears", "meshing")),
    *(
        (word, "write the gears as parts, and moves of kinds mesh and train")
        for word in ("gearbox", "gear_train", "transmission")
    ),
    *((word, "write uniform") for word in ("rectangular", "rectangle", "flat", "equal")),
    *((word, "write normal") for word in ("gauss", "gaussian")),
)
OTHER_KEYS: Final = (
    ("normal_module", "write module: of a helical gear it is the normal module"),
    ("transverse_module", "write module: the normal one, m_t cos(helix_angle)"),
    *((word, HELIX_SIGN) for word in ("helix", "helix_direction", "beta", "spiral_angle", "lead")),
    *((word, HELICAL) for word in ("helix_angle", "hand")),
)

GEARING: Final = Mechanism(
    name="gearing",
    parts=_kinds(PartSpec),
    tolerances=(*_kinds(ToleranceEntry, tolerances), TemperatureSpec),
    moves=_kinds(MoveSpec),
    measures=_kinds(MeasureEntry),
    checks=(
        carried_again,
        forms_of_two_shapes,
        helices_elsewhere,
        readings_of_helices,
        forces_of_helices,
        second_axial_plays,
        unloaded_bearings,
    ),
    warnings=(
        implausible_displacements,
        implausible_faces,
        implausible_shafts,
        implausible_angles,
        fits_of_other_distances,
        bearings_off_shafts,
        shafts_thicker_than_hubs,
        steep_helices,
    ),
    general=(general_distances,),
    other_kinds=OTHER_KINDS,
    other_keys=OTHER_KEYS,
    options=GearStudyOptions,
    published=PublishedTrains,
    engines=("exact", "fcl"),
    witness="fcl",
    system="tol3d.gearing.system:gear_system",
    summary="tol3d.gearing.summary.types:SUMMARY_KINDS",
    presenter="tol3d.gearing.presenting",
    starters="tol3d.gearing:starters",
    requires=("python-fcl", "cadquery"),
)
