"""Cylindrical gears of the parts of a scene, without what other entries make of them."""

from tol3d.gearing.grammar.parts import HelicalGearSpec, InternalGearSpec, SpurGearSpec, helix_of
from tol3d.gears import InternalGear, SpurGear

CylindricalSpec = SpurGearSpec | HelicalGearSpec | InternalGearSpec


def cylindrical_gear_of(spec: CylindricalSpec) -> SpurGear | InternalGear:
    """The nominal gear of a part.

    Raises:
        GeometryError: it cannot be made.
    """
    return _internal_gear(spec) if isinstance(spec, InternalGearSpec) else _spur_gear(spec)


def _spur_gear(spec: SpurGearSpec | HelicalGearSpec) -> SpurGear:
    angle, hand = helix_of(spec)
    return SpurGear(
        teeth=spec.teeth,
        module=spec.module.internal,
        pressure_angle=spec.pressure_angle.internal,
        face_width=spec.face_width.internal,
        profile_shift=spec.profile_shift,
        addendum=spec.addendum,
        dedendum=spec.dedendum,
        root_fillet=None if spec.root_fillet is None else spec.root_fillet.internal,
        bore=0.0 if spec.bore is None else spec.bore.internal,
        helix_angle=angle,
        hand=hand,
    )


def _internal_gear(spec: InternalGearSpec) -> InternalGear:
    angle, hand = helix_of(spec)
    return InternalGear(
        teeth=spec.teeth,
        module=spec.module.internal,
        pressure_angle=spec.pressure_angle.internal,
        face_width=spec.face_width.internal,
        profile_shift=spec.profile_shift,
        addendum=spec.addendum,
        dedendum=spec.dedendum,
        root_fillet=None if spec.root_fillet is None else spec.root_fillet.internal,
        outer_diameter=None if spec.outer_diameter is None else spec.outer_diameter.internal,
        helix_angle=angle,
        hand=hand,
    )
