"""The plain numbers of tol3d's gears, as the oracles want them."""

import numpy as np

from oracles.bevel_brute_force import BevelNumbers
from oracles.involute_gear import InvoluteGear
from tol3d.gears import BevelGear, Gear, SpurGear


def plain_spur(gear: Gear, thickness: np.ndarray | float = 0.0, growth: float = 1.0) -> InvoluteGear:
    """A spur gear, grown, with thickness deviations (n,) [mm] or one."""
    assert isinstance(gear, SpurGear)
    deviation = np.reshape(thickness, (-1, 1, 1, 1)) if np.ndim(thickness) else thickness
    return InvoluteGear(
        gear.teeth, gear.module, gear.pressure_angle, gear.face_width, gear.profile_shift, gear.addendum, deviation
    ).grown(growth)


def plain_bevel(gear: Gear, turned: float = 0.0, offset: float = 0.0) -> BevelNumbers:
    """A bevel gear, its flanks turned about the axis [rad] and moved along their normals [mm]."""
    assert isinstance(gear, BevelGear)
    return BevelNumbers(
        gear.teeth,
        gear.module,
        gear.pressure_angle,
        gear.pitch_angle,
        (gear.inner_cone_distance, gear.outer_cone_distance),
        gear.profile_shift,
        gear.addendum,
        gear.dedendum,
        turned,
        offset,
    )
