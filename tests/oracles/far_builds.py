"""Builds far from nominal: effects of every kind at once on a spur pair and two bevel pairs."""

import math
from functools import cache

import numpy as np

from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Unit
from tol3d.gearing.model import (
    AxesOffset,
    AxisOffset,
    AxisTilt,
    Contributor,
    Effect,
    GearPart,
    Mesh,
    Model,
    Planar,
    Scalar,
    Temperature,
    ToothThickness,
    TurningOffset,
)
from tol3d.gearing.model.model import Housing
from tol3d.gears import BevelGear, BevelPair, SpurGear, SpurPair, pitch_angles
from tol3d.gears.flank import Flank
from tol3d.statistics.distributions import Distribution, Uniform
from tol3d.study.system.trials import Trials

ALPHA = math.radians(20.0)
LAW = Uniform(-1.0, 1.0)  # deviations are stated, none is drawn
SPREAD = {"um": 0.012, "mrad": 0.5e-3, "K": 20.0}  # mm, rad, K of the builds far from nominal

Acting = tuple[Effect, Unit, bool]
"""An effect with its unit, and whether the deviation is planar."""


def effect_of_every_kind() -> list[Acting]:
    """Effects of both gears with their unit, and whether the deviation is planar."""
    effects: list[Acting] = []
    for gear in ("pinion", "wheel"):
        effects += [
            (ToothThickness(gear, turn=0.02), "um", False),
            (ToothThickness(gear, turn=0.0, offset=0.47), "um", False),
            (TurningOffset(gear), "um", True),
            (AxisOffset(gear, factor=0.5), "um", True),
            (AxisOffset(gear, (0.6, 0.0, 0.8), 1.3), "um", False),
            (AxisTilt(gear, (1.0, 0.0, 0.0)), "mrad", False),
            (AxisTilt(gear, (0.0, -1.0, 0.0), 1 / 20, 17.0), "um", False),
            (AxisTilt(gear, (0.6, 0.8, 0.0), 1.0, -9.0), "mrad", False),
        ]
    one_by_one: list[Acting] = [
        (AxesOffset("wheel", "mesh"), "um", False),
        (Temperature(("pinion",)), "K", False),
        (Temperature(("wheel", "housing")), "K", False),
        (Temperature(("pinion", "housing", "wheel")), "K", False),
    ]
    return effects + one_by_one


def contributors(effects: list[Acting], law: Distribution = LAW) -> tuple[Contributor, ...]:
    return tuple(
        Contributor(f"c{k}", "test", effect, Planar(law, None) if planar else Scalar(law), unit)
        for k, (effect, unit, planar) in enumerate(effects)
    )


def pair_of(name: str) -> SpurPair | BevelPair:
    if name == "spur":
        pinion = SpurGear(18, 2.0, ALPHA, 10.0, profile_shift=0.2)
        return SpurPair(pinion, SpurGear(25, 2.0, ALPHA, 8.0, profile_shift=0.1), 43.59)
    teeth, module, faces, shift = {
        "bevel 17/43": ((17, 43), 2.0, (12.0, 11.0), 0.3),
        "bevel 31/31": ((31, 31), 3.5, (9.0, 9.0), 0.0),
    }[name]
    angles = pitch_angles(*teeth, math.pi / 2)
    first, second = (
        BevelGear(z, module, ALPHA, face, angle, profile_shift=x)
        for z, face, angle, x in zip(teeth, faces, angles, (shift, -shift), strict=True)
    )
    return BevelPair(first, second, math.pi / 2)


PAIRS = ("spur", "bevel 17/43", "bevel 31/31")


def model_of(pair: SpurPair | BevelPair, flank: Flank, acting: tuple[Contributor, ...]) -> Model:
    mesh = Mesh("mesh", "pinion", "wheel", pair, flank, "housing")
    gears = (GearPart("pinion", pair.pinion, 11e-6), GearPart("wheel", pair.wheel, 17e-6))
    return Model("posed", gears, (Housing("housing", 23e-6),), acting, (mesh,), ())


@cache
def far_model(name: str, flank: Flank) -> tuple[Model, ExactEngine]:
    model = model_of(pair_of(name), flank, contributors(effect_of_every_kind()))
    return model, ExactEngine(model)


def far_block(model: Model, count: int, seed: int) -> Trials:
    """Everything off at once: tilts of half a mrad, shifts of a dozen um, warm and cold gears, drivers anywhere."""
    rng = np.random.default_rng(seed)
    columns = []
    for contributor in model.contributors:
        low, high = -SPREAD[contributor.unit], SPREAD[contributor.unit]
        if isinstance(contributor.effect, ToothThickness) and contributor.effect.turn:
            radius = model.meshes[0].gear(contributor.effect.part).section_arm
            low, high = -2.6 / radius, -2.4 / radius  # of 0.02 rad/mm: 50 um of each flank leave room for all the rest
        columns.append(rng.uniform(low, high, (count, len(contributor.draw.components))))
    return Trials(np.concatenate(columns, axis=1), {"mesh": rng.uniform(0.0, 50.0, count)})
