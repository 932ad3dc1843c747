"""Gears and pairs side by side, a row for each of their numbers: in meshes of trains, and in reducers."""

import math
from collections.abc import Iterable, Mapping
from typing import Any, Final

from tol3d.gearing.model import Mesh
from tol3d.gears import (
    RIGHT,
    RIGHT_HAND,
    BevelGear,
    BevelPair,
    Gear,
    InternalGear,
    InternalPair,
    SpurGear,
    SpurPair,
)
from tol3d.report.declared import side_by_side
from tol3d.report.number import NOTHING, degrees_text
from tol3d.report.page import PageItem, titled
from tol3d.study.runs.summary.shows import Computed, RowOf, Shows
from tol3d.units import angle_text


class GearColumn(RowOf[Any]):
    """A gear as it is shown beside others; lengths in mm."""

    teeth = Computed(Shows("teeth z", "d"), lambda own: own.of.teeth)
    module = Computed(Shows("module m [mm]", "g"), lambda own: own.of.module)
    pressure_angle = Computed(Shows("pressure angle α [°]", "degrees"), lambda own: own.of.pressure_angle)
    face_width = Computed(Shows("face width b [mm]", "g"), lambda own: own.of.face_width)
    profile_shift = Computed(Shows("profile shift x", "g"), lambda own: own.of.profile_shift)
    heights = Computed(Shows("addendum, dedendum [m]"), lambda own: f"{own.of.addendum:g}, {own.of.dedendum:g}")


class CylindricalColumn(GearColumn):
    """A spur gear, or what it shares with a ring."""

    reference_diameter = Computed(Shows("reference diameter d [mm]", ".4f"), lambda own: own.of.reference_diameter)
    tip_diameter = Computed(Shows("tip diameter d_a [mm]", ".4f"), lambda own: own.of.tip_diameter)
    base_diameter = Computed(Shows("base diameter d_b [mm]", ".4f"), lambda own: own.of.base_diameter)
    root_diameter = Computed(Shows("root diameter d_f [mm]", ".4f"), lambda own: own.of.root_diameter)
    form_diameter = Computed(Shows("involute from diameter [mm]", ".4f"), lambda own: 2 * own.of.form_radius)
    fillet = Computed(Shows("root fillet [mm]", ".4f"), lambda own: own.of.fillet_radius)
    thickness = Computed(Shows("tooth thickness s [mm]", ".4f"), lambda own: own.of.tooth_thickness)
    tip_thickness = Computed(Shows("thickness at the tip s_a [mm]", ".4f"), lambda own: own.of.tip_thickness)


class SpurColumn(CylindricalColumn):
    """An external gear."""

    bore = Computed(Shows("bore [mm]", "g"), lambda own: own.of.bore or None)


class ScrewColumn(CylindricalColumn):
    """A gear with screw teeth, or what it shares with a ring."""

    module = Computed(Shows("normal module m_n [mm]", "g"), lambda own: own.of.module)
    pressure_angle = Computed(Shows("normal pressure angle α_n [°]", "degrees"), lambda own: own.of.pressure_angle)
    helix = Computed(
        Shows("helix angle β [°], hand"),
        lambda own: f"{degrees_text(own.of.helix_angle)}, {'right' if own.of.hand == RIGHT_HAND else 'left'}",
    )
    transverse_angle = Computed(
        Shows("transverse pressure angle α_t [°]", "degrees"), lambda own: own.of.transverse_pressure_angle
    )
    thickness = Computed(Shows("normal tooth thickness s_n [mm]", ".4f"), lambda own: own.of.tooth_thickness)
    tip_thickness = Computed(
        Shows("normal thickness at the tip s_na [mm]", ".4f"), lambda own: own.of.normal_tip_thickness
    )


class HelicalColumn(ScrewColumn, SpurColumn):
    """An external gear with screw teeth."""


class RingColumn(CylindricalColumn):
    """A gear with internal teeth."""

    teeth = Computed(Shows("teeth z", "d"), lambda own: f"{own.of.teeth}, inside")
    outer_diameter = Computed(Shows("outer diameter [mm]", ".4f"), lambda own: own.of.rim_diameter)


class HelicalRingColumn(ScrewColumn, RingColumn):
    """A gear with internal screw teeth."""


class BevelColumn(GearColumn):
    """A bevel gear."""

    cones = Computed(
        Shows("{key} angle", ".4f", "°"),
        lambda own: {word: getattr(own.of, f"{word}_angle") for word in ("pitch", "tip", "base", "root")},
    )
    cone_distances = Computed(
        Shows("cone distance, outer, mean, inner [mm]"),
        lambda own: ", ".join(f"{getattr(own.of, f'{word}_cone_distance'):.4f}" for word in ("outer", "mean", "inner")),
    )
    outer_diameter_d_e = Computed(
        Shows("reference diameter, outer d_e [mm]", ".4f"), lambda own: own.of.reference_diameter
    )
    mean_diameter = Computed(Shows("reference diameter, mean d_m [mm]", ".4f"), lambda own: 2 * own.of.mean_radius)
    outer_tip_diameter = Computed(Shows("tip diameter, outer d_ae [mm]", ".4f"), lambda own: own.of.tip_diameter)
    outer_thickness = Computed(Shows("tooth thickness, outer s [mm]", ".4f"), lambda own: own.of.tooth_thickness)
    mean_thickness = Computed(Shows("tooth thickness, mean s_m [mm]", ".4f"), lambda own: own.of.mean_tooth_thickness)
    outer_tip_thickness = Computed(Shows("thickness at the tip, outer [mm]", ".4f"), lambda own: own.of.tip_thickness)
    bore = Computed(Shows("bore [mm]", "g"), lambda own: own.of.bore or None)


class MeshColumn(RowOf[Any]):
    """A mesh as it is shown beside others, with what the nominal pair gives."""

    gears = Computed(Shows("driver → driven"), lambda own: f"{own.of.driver} → {own.of.driven}")
    flank = Computed(Shows("driver's working flank"), lambda own: "right" if own.of.working_flank == RIGHT else "left")
    housing = Computed(Shows("housing"), lambda own: own.of.housing or NOTHING)


class PairColumn(RowOf[Any]):
    """A nominal pair of gears on parallel axes, of a mesh."""

    centre_distance = Computed(Shows("centre distance a [mm]", ".4f"), lambda own: own.of.pair.centre_distance)
    tight_at = Computed(Shows("without backlash at [mm]", ".4f"), lambda own: own.of.pair.zero_backlash_centre_distance)
    working_angle = Computed(
        Shows("working pressure angle α_w [°]", "degrees"), lambda own: own.of.pair.working_pressure_angle
    )
    contact_ratio = Computed(Shows("contact ratio ε_α", ".4f"), lambda own: own.of.pair.contact_ratio)
    normal = Computed(Shows("nominal normal backlash", "um", "µm"), lambda own: own.of.pair.normal_backlash)
    circumferential = Computed(
        Shows("nominal circumferential", "um", "µm"), lambda own: own.of.pair.circumferential_backlash
    )
    radial = Computed(Shows("nominal radial", "um", "µm"), lambda own: own.of.pair.radial_backlash)


class HelicalPairColumn(PairColumn):
    """A nominal pair of helical gears."""

    working_angle = Computed(
        Shows("working pressure angle, transverse α_wt [°]", "degrees"),
        lambda own: own.of.pair.working_pressure_angle,
    )
    overlap = Computed(Shows("overlap ratio ε_β", ".4f"), lambda own: own.of.pair.overlap_ratio)
    total = Computed(Shows("total contact ratio ε_γ", ".4f"), lambda own: own.of.pair.total_contact_ratio)
    axial_pitch = Computed(Shows("axial pitch p_x [mm]"), lambda own: _axial_pitch(own.of.pair))


def _axial_pitch(pair: SpurPair | InternalPair) -> str:
    """The axial pitch, and that the common face is narrower where it is."""
    pitch = math.pi * pair.pinion.module / math.sin(pair.pinion.helix_angle)
    return f"{pitch:.4f}" + (", wider than the common face" if pair.overlap_ratio < 1.0 else "")


class DrivenColumn(RowOf[Any]):
    """Turns of a driver and of what it drives."""

    period = Computed(
        Shows("same teeth meet after [turns]", "d", behind="contact_ratio"), lambda own: own.of.pair.long_period_turns
    )
    angular = Computed(
        Shows("nominal angular, driver / driven", behind="radial"),
        lambda own: " / ".join(map(angle_text, own.of.pair.angular_backlash)),
    )


class ParallelColumn(DrivenColumn, PairColumn, MeshColumn):
    """A mesh of gears on parallel axes."""


class HelicalMeshColumn(DrivenColumn, HelicalPairColumn, MeshColumn):
    """A mesh of helical gears."""


class BevelMeshColumn(MeshColumn):
    """A mesh of bevel gears."""

    shaft_angle = Computed(Shows("shaft angle Σ [°]", "degrees"), lambda own: own.of.pair.shaft_angle)
    cone_distance = Computed(Shows("mean cone distance R_m [mm]", ".4f"), lambda own: own.of.pair.mean_cone_distance)
    contact_ratio = Computed(Shows("contact ratio ε_α", ".4f"), lambda own: own.of.pair.contact_ratio)
    period = Computed(Shows("same teeth meet after [turns]", "d"), lambda own: own.of.pair.long_period_turns)
    normal = Computed(Shows("nominal normal backlash", "um", "µm"), lambda own: own.of.pair.normal_backlash)


GEAR_COLUMNS: Final[Mapping[type[Any], type[GearColumn]]] = {
    SpurGear: SpurColumn,
    InternalGear: RingColumn,
    BevelGear: BevelColumn,
}
MESH_COLUMNS: Final[Mapping[type[Any], type[MeshColumn]]] = {
    SpurPair: ParallelColumn,
    InternalPair: ParallelColumn,
    BevelPair: BevelMeshColumn,
}
"""Each kind of gear and of pair has its own rows."""


def gear_column(gear: Gear) -> GearColumn:
    """Rows of a gear."""
    if isinstance(gear, SpurGear | InternalGear) and gear.helix_angle > 0.0:
        return (HelicalColumn if isinstance(gear, SpurGear) else HelicalRingColumn)(gear)
    return GEAR_COLUMNS[type(gear)](gear)


def mesh_column(mesh: Mesh) -> MeshColumn:
    """Rows of a mesh."""
    return (HelicalMeshColumn if _is_helical(mesh) else MESH_COLUMNS[type(mesh.pair)])(mesh)


def _is_helical(mesh: Mesh) -> bool:
    return isinstance(mesh.pair, SpurPair | InternalPair) and mesh.pair.pinion.helix_angle > 0.0


def gear_blocks(gears: Mapping[str, Gear]) -> list[PageItem]:
    """Gears of a reducer side by side, lengths in mm."""
    return titled("gears", side_by_side("", [(name, gear_column(gear)) for name, gear in gears.items()]))


def pair_blocks(meshes: Iterable[Mesh]) -> list[PageItem]:
    """Numbers of the nominal pairs of a reducer."""
    columns = [(mesh.name, (HelicalPairColumn if _is_helical(mesh) else PairColumn)(mesh)) for mesh in meshes]
    return titled("meshes, nominal", side_by_side("", columns))
