"""Effects of contributors on an RV reducer: deviations of its cycloid stage, and of the gears before it."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from tol3d.cycloid.model.stage import Deviated
from tol3d.cycloid.reducer.rv_set import RVSet
from tol3d.numerics.arrays import Array
from tol3d.numerics.plane import evenly
from tol3d.reducers.deviations import Acts, Along, Deviations, shaped

Effect = Literal[
    "pin circle", "pin ring", "pin outwards", "pin round", "pin place", "pin radius", "lobe pitch", "lobe profile",
    "disc offset", "disc hole", "disc tilt", "disc play", "carrier play", "crank throw", "crank throw of a disc",
    "crank phase", "carrier hole", "carrier circle", "carrier offset", "sun thickness", "planet thickness",
    "sun offset", "planet offset",
]  # fmt: skip


@dataclass(frozen=True)
class RVDeviated(Deviations):
    """Deviations of an RV reducer; see Deviations.

    Args:
        stage: of pins, discs, cranks and carrier.
        sun_thickness: arc at the reference circle (trials,) [mm], positive is thicker.
        planet_thickness: the same of each crank's planet (trials, cranks).
        sun_offset: of the teeth's centre from the axis, in the gear's frame (trials, 2) [mm].
        planet_offset: the same of planets, from their cranks' axes (trials, cranks, 2).
        disc_tilts: of discs about x and y of their own frame, through mid-face (trials, discs, 2) [rad].
        disc_play: diametral clearance of each crank's bearing in each disc (trials, discs, cranks) [mm].
        carrier_play: the same in the carrier (trials, cranks).
    """

    stage: Deviated
    sun_thickness: Array
    planet_thickness: Array
    sun_offset: Array
    planet_offset: Array
    disc_tilts: Array
    disc_play: Array
    carrier_play: Array

    @classmethod
    def nothing(cls, own: RVSet, trials: int) -> "RVDeviated":
        """No deviations."""
        return cls(
            Deviated.nothing(trials, own.profile.pins, own.discs, own.cranks),
            np.zeros(trials),
            np.zeros((trials, own.cranks)),
            np.zeros((trials, 2)),
            np.zeros((trials, own.cranks, 2)),
            np.zeros((trials, own.discs, 2)),
            np.zeros((trials, own.discs, own.cranks)),
            np.zeros((trials, own.cranks)),
        )

    def reached(self, own: RVSet, acts: Acts) -> tuple[Array, Along]:
        """See Deviations."""
        stage = self.stage
        reached: dict[str, tuple[Array, Along]] = {
            "pin circle": (stage.pins[..., 0], _alike),
            "pin ring": (stage.pins, _ring_moved(own.profile.pins)),
            "pin outwards": (stage.pins[..., 0], shaped(stage.pins[..., 0])),
            "pin round": (stage.pins[..., 1], shaped(stage.pins[..., 1])),
            "pin place": (stage.pins, shaped(stage.pins)),
            "pin radius": (stage.pin_radii, shaped(stage.pin_radii)),
            "lobe pitch": (stage.lobe_pitch, shaped(stage.lobe_pitch)),
            "lobe profile": (stage.lobe_profile, shaped(stage.lobe_profile)),
            "disc offset": (stage.disc_offsets, shaped(stage.disc_offsets)),
            "disc hole": (stage.disc_holes, shaped(stage.disc_holes)),
            "disc tilt": (self.disc_tilts, shaped(self.disc_tilts)),
            "disc play": (self.disc_play, shaped(self.disc_play)),
            "carrier play": (self.carrier_play, shaped(self.carrier_play)),
            "crank throw": (stage.crank_errors, shaped(stage.crank_errors)),
            "crank throw of a disc": (stage.crank_errors, shaped(stage.crank_errors[:, :1])),
            "crank phase": (stage.crank_phases, shaped(stage.crank_phases)),
            "carrier hole": (stage.carrier_holes, shaped(stage.carrier_holes)),
            "carrier circle": (stage.carrier_holes, shaped(stage.carrier_holes[:, :1])),
            "carrier offset": (stage.carrier_offsets, shaped(stage.carrier_offsets)),
            "sun thickness": (self.sun_thickness, lambda own: own[:, 0]),
            "planet thickness": (self.planet_thickness, shaped(self.planet_thickness)),
            "sun offset": (self.sun_offset, shaped(self.sun_offset)),
            "planet offset": (self.planet_offset, shaped(self.planet_offset)),
        }
        return reached[acts.effect]


def _alike(components: Array) -> Array:
    """One deviation (trials, 1) of all."""
    return components


def _ring_moved(pins: int) -> Along:
    """A displacement x, y of all pins, outwards and counter-clockwise at each."""
    azimuths = evenly(pins)
    cos, sin = np.cos(azimuths), np.sin(azimuths)

    def moved(components: Array) -> Array:
        x, y = components[:, :1], components[:, 1:]
        return np.stack([cos * x + sin * y, cos * y - sin * x], axis=-1)

    return moved
