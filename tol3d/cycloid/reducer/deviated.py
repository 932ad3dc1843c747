"""Effects of contributors on an RV reducer: deviations of its cycloid stage, and of the gears before it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from tol3d.cycloid.model.stage import Deviated
from tol3d.cycloid.reducer.rv_set import RVSet
from tol3d.gears.tooth_measures import ToothMeasure
from tol3d.numerics.arrays import Array
from tol3d.numerics.plane import evenly
from tol3d.numerics.trial_arrays import TrialArrays

Effect = Literal[
    "pin circle", "pin ring", "pin outwards", "pin round", "pin place", "pin radius", "lobe pitch", "lobe profile",
    "disc offset", "disc hole", "disc tilt", "disc play", "carrier play", "crank throw", "crank throw of a disc",
    "crank phase", "carrier hole", "carrier circle", "carrier offset", "sun thickness", "planet thickness",
    "sun offset", "planet offset",
]  # fmt: skip
Along = Callable[[Array], Array]


@dataclass(frozen=True)
class Acts:
    """Effect of a contributor on the reducer, and its factor.

    Args:
        factor: multiplier of the deviation, such as 1/cos(alpha) for a thickness along the normals.
        over: how teeth are measured, where the scene says so.
    """

    effect: Effect
    factor: float = 1.0
    over: ToothMeasure | None = None


@dataclass(frozen=True)
class RVDeviated(TrialArrays):
    """Deviations of an RV reducer (trials, ...), or derivatives by each deviation.

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

    def add(self, acts: Acts, components: Array) -> None:
        """Add the effect of a contributor.

        Args:
            components: of the contributor (trials, components) [mm or rad].
        """
        into, along = self._reached(acts.effect)
        into += acts.factor * along(components)

    def term(self, acts: Acts, components: Array) -> Array:
        """Change due to a contributor (trials,), where this is the change per deviation.

        Args: as of `add`.
        """
        rates, along = self._reached(acts.effect)
        return np.asarray(acts.factor * (rates * along(components)).reshape(len(rates), -1).sum(axis=1))

    def _reached(self, effect: Effect) -> tuple[Array, Along]:
        """The array that an effect reaches, and the part of it that a contributor's components are."""
        stage = self.stage
        reached: dict[Effect, tuple[Array, Along]] = {
            "pin circle": (stage.pins[..., 0], _alike),
            "pin ring": (stage.pins, _ring_moved(stage.pins.shape[1])),
            "pin outwards": (stage.pins[..., 0], _shaped(stage.pins[0, :, 0])),
            "pin round": (stage.pins[..., 1], _shaped(stage.pins[0, :, 1])),
            "pin place": (stage.pins, _shaped(stage.pins[0])),
            "pin radius": (stage.pin_radii, _shaped(stage.pin_radii[0])),
            "lobe pitch": (stage.lobe_pitch, _shaped(stage.lobe_pitch[0])),
            "lobe profile": (stage.lobe_profile, _shaped(stage.lobe_profile[0])),
            "disc offset": (stage.disc_offsets, _shaped(stage.disc_offsets[0])),
            "disc hole": (stage.disc_holes, _shaped(stage.disc_holes[0])),
            "disc tilt": (self.disc_tilts, _shaped(self.disc_tilts[0])),
            "disc play": (self.disc_play, _shaped(self.disc_play[0])),
            "carrier play": (self.carrier_play, _shaped(self.carrier_play[0])),
            "crank throw": (stage.crank_errors, _shaped(stage.crank_errors[0])),
            "crank throw of a disc": (stage.crank_errors, _shaped(stage.crank_errors[0, :1])),
            "crank phase": (stage.crank_phases, _shaped(stage.crank_phases[0])),
            "carrier hole": (stage.carrier_holes, _shaped(stage.carrier_holes[0])),
            "carrier circle": (stage.carrier_holes, _shaped(stage.carrier_holes[0, :1])),
            "carrier offset": (stage.carrier_offsets, _shaped(stage.carrier_offsets[0])),
            "sun thickness": (self.sun_thickness, lambda own: own[:, 0]),
            "planet thickness": (self.planet_thickness, _shaped(self.planet_thickness[0])),
            "sun offset": (self.sun_offset, _shaped(self.sun_offset[0])),
            "planet offset": (self.planet_offset, _shaped(self.planet_offset[0])),
        }
        return reached[effect]


def _alike(components: Array) -> Array:
    """One deviation (trials, 1) of all."""
    return components


def _shaped(like: Array) -> Along:
    """Components one after the other, in the form of an array of one trial."""
    return lambda components: components.reshape(len(components), *like.shape)


def _ring_moved(pins: int) -> Along:
    """A displacement x, y of all pins, outwards and counter-clockwise at each."""
    azimuths = evenly(pins)
    cos, sin = np.cos(azimuths), np.sin(azimuths)

    def moved(components: Array) -> Array:
        x, y = components[:, :1], components[:, 1:]
        return np.stack([cos * x + sin * y, cos * y - sin * x], axis=-1)

    return moved
