"""An RV reducer as it is meant: a first stage of spur gears, cranks, cycloid discs among pins, a carrier.

The axis of the pin ring is z through the origin; pin j stands at the azimuth 2 pi j / Zp. With crank angle phi the
centre of disc d lies at a e^(i (phi + 2 pi d / discs)); discs and carrier, the output, have turned by -phi / Zc,
against the cranks. The input, the sun, turns with the carrier's sense,

    sun : carrier = 1 + (z2 / z1) Zp,   cranks : carrier = -Zc,

ring fixed, turns in space. Angles count counter-clockwise.
"""

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, Final

import numpy as np

from tol3d.gearing.cycloid.exact.contact import ContactStage
from tol3d.gearing.cycloid.first_order.linear import LinearStage
from tol3d.gearing.cycloid.model.profile import DiscProfile
from tol3d.gears import SpurGear, SpurPair
from tol3d.numerics.arrays import Array
from tol3d.numerics.kept import KnownRows, kept
from tol3d.numerics.plane import evenly

REST_COSTS: Final = 80  # times a first contact
MOST_FORCES: Final = 4096  # rests whose forces are kept, some 2 kB each


@dataclass(frozen=True)
class FirstStage:
    """A sun that drives a planet on every crankshaft, each with its teeth so on it that all mesh alike.

    Args:
        sun, planet: names of the gears.
        pair: sun as the pinion and a planet as the wheel, at the radius of the circle of crank axes.
    """

    sun: str
    planet: str
    pair: SpurPair

    @property
    def teeth(self) -> tuple[int, int]:
        """z1 of the sun and z2 of a planet."""
        return self.pair.pinion.teeth, self.pair.wheel.teeth

    def gear(self, name: str) -> SpurGear:
        """Sun or planet, nominal."""
        return self.pair.pinion if name == self.sun else self.pair.wheel


@dataclass(frozen=True)
class RVSet:
    """Nominal numbers of an RV reducer.

    Args:
        crank_circle: radius of the circle of crank axes [mm].
        window: pins work whose lever is more than this share of the pitch radius.
        first: its first stage; None where the cranks are the input.
        width: of the discs [mm]; None where it is not stated, and discs do not tilt.
        plays: whether bearings of cranks have play, so that a torque decides where discs and cranks lie.
        by_formula: whether a published column has its stage by the paper's formula, which is then shown beside.
    """

    name: str
    ring: str
    disc: str
    crankshaft: str
    carrier: str
    profile: DiscProfile
    discs: int
    cranks: int
    crank_circle: float
    window: float
    first: FirstStage | None = None
    width: float | None = None
    plays: bool = False
    by_formula: bool = False

    @kept
    def known_forces(self, sense: int) -> KnownRows[Any]:
        """Forces that its analytic method has found, at one position a trial: regressors read them again."""
        return KnownRows(MOST_FORCES)

    @property
    def input(self) -> str:
        """The part that is turned: the sun, or the crankshafts."""
        return self.crankshaft if self.first is None else self.first.sun

    @property
    def output(self) -> str:
        """The part that is driven."""
        return self.carrier

    @property
    def held(self) -> str:
        """The part that is fixed."""
        return self.ring

    @property
    def contacts(self) -> int:
        """Contacts to be found at a position, one way: of every pin of every disc."""
        return self.profile.pins * self.discs * (REST_COSTS if self.plays else 1)

    @property
    def pair(self) -> SpurPair:
        """Sun and planet of its first stage, which it must have."""
        assert self.first is not None
        return self.first.pair

    @property
    def gear_ratio(self) -> Fraction:
        """z2 / z1 of the first stage; 0 without one."""
        return Fraction(0) if self.first is None else Fraction(self.first.teeth[1], self.first.teeth[0])

    @property
    def ratio(self) -> Fraction:
        """Turns of the input a turn of the output, against the pin ring."""
        return Fraction(-self.profile.lobes) if self.first is None else 1 + self.gear_ratio * self.profile.pins

    @property
    def rolling(self) -> float:
        """Turns of the cranks in space per turn of the carrier while the input stands: planets roll on the sun."""
        return 0.0 if self.first is None else float(1 + 1 / self.gear_ratio)

    @property
    def crank_arm(self) -> float:
        """Turns of a crank that turn the carrier back once while the input stands, Zc + rho."""
        return self.profile.lobes + self.rolling

    @property
    def period(self) -> int:
        """Turns of the output until pins, lobes and teeth meet again as they did."""
        return (self.gear_ratio * self.profile.pins).denominator

    @cached_property
    def azimuths(self) -> Array:
        """Azimuths of the cranks on the carrier (cranks,) [rad]."""
        return evenly(self.cranks)

    def crank_angles(self, turns: Array) -> Array:
        """Crank angles phi [rad] at turns of the output."""
        return np.asarray(-2 * math.pi * self.profile.lobes * turns)

    @property
    def linear(self) -> LinearStage:
        """Its cycloid stage to first order."""
        return LinearStage.of(self)

    @property
    def contact(self) -> ContactStage:
        """Its cycloid stage in finite geometry."""
        return ContactStage.of(self)
