"""Random internal pairs and their outlines for the oracles."""

import math

import numpy as np
from oracles.ring_overlap import Outline

from tol3d.errors import GeometryError
from tol3d.gears import InternalGear, InternalPair, SpurGear


def outline(gear: SpurGear | InternalGear) -> Outline:
    nominal = gear.module * (math.pi / 2 + 2 * gear.profile_shift * math.tan(gear.pressure_angle))
    return Outline(
        teeth=gear.teeth,
        module=gear.module,
        alpha=gear.pressure_angle,
        thickness=nominal + gear.tooth_thickness_deviation,
        tip=gear.tip_radius,
        root=gear.root_radius,
        fillet=gear.fillet_radius,
        inside=isinstance(gear, InternalGear),
    )


def random_pair(rng: np.random.Generator) -> InternalPair | None:
    """One that can be made, with a backlash of at most 20 um; half of them with some interference."""
    alpha, teeth = math.radians(rng.uniform(18, 30)), int(rng.integers(14, 45))
    fillets = (None if rng.random() < 0.5 else rng.uniform(0.05, 0.3) for _ in range(2))
    try:
        inner = SpurGear(
            teeth,
            1.0,
            alpha,
            5.0,
            profile_shift=rng.uniform(-0.2, 0.7),
            addendum=rng.uniform(0.6, 1.25),
            dedendum=rng.uniform(1.0, 1.4),
            root_fillet=next(fillets),
        )
        ring = InternalGear(
            teeth + int(rng.choice([2, 3, 4, 5, 6, 8, 10, 14, 25, 50])),
            1.0,
            alpha,
            5.0,
            profile_shift=rng.uniform(-1.6, 0.3),
            addendum=rng.uniform(0.6, 1.0),
            dedendum=rng.uniform(1.0, 1.4),
            root_fillet=next(fillets),
        )
        touching = InternalPair(inner, ring, 1.0001 * (ring.base_radius - inner.base_radius))
        distance = touching.zero_backlash_centre_distance - rng.uniform(0.0, 0.03)
        return None if math.isnan(distance) else InternalPair(inner, ring, distance)
    except GeometryError:
        return None
