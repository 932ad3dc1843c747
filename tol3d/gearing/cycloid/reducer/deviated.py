"""Effects of contributors on an RV reducer: deviations of its cycloid stage, and of the gears before it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from typing_extensions import override

from tol3d.gearing.cycloid.model.stage import Deviated
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gearing.reducers.deviations import Acts, Along, Deviations
from tol3d.numerics.arrays import Array
from tol3d.numerics.plane import evenly, turned


@dataclass(frozen=True)
class Reach:
    """Deviations that an effect reaches.

    Args:
        array: their name.
        each: words for the parts along their axes that each have a component; "" where all of an axis share one.
        planar: True for displacements, or tilts, in a direction.
        part: of displacements outwards (0) or counter-clockwise (1) alone; None: all.
    """

    array: str
    each: tuple[str, ...] = ()
    planar: bool = False
    part: int | None = None


RING: Final = "pin ring"
PINS: Final = "carrier pins"
EFFECTS: Final[Mapping[str, Reach]] = {
    "pin circle": Reach("pins", ("",), part=0),
    RING: Reach("pins", planar=True),  # of all pins, turned to each
    "pin outwards": Reach("pins", ("pin",), part=0),
    "pin round": Reach("pins", ("pin",), part=1),
    "pin place": Reach("pins", ("pin",), planar=True),
    "pin radius": Reach("pin_radii", ("pin",)),
    "lobe pitch": Reach("lobe_pitch", ("disc", "lobe")),
    "lobe profile": Reach("lobe_profile", ("disc", "lobe")),
    "disc offset": Reach("disc_offsets", ("disc",), planar=True),
    "disc hole": Reach("disc_holes", ("disc", "hole"), planar=True),
    "disc tilt": Reach("disc_tilts", ("disc",), planar=True),
    "disc play": Reach("disc_play", ("disc", "hole")),
    "carrier play": Reach("carrier_play", ("hole",)),
    "crank throw": Reach("crank_errors", ("crank", "disc"), planar=True),
    "crank throw of a disc": Reach("crank_errors", ("", "disc"), planar=True),
    "crank phase": Reach("crank_phases", ("crank",)),
    "carrier hole": Reach("carrier_holes", ("hole",), planar=True),
    "carrier circle": Reach("carrier_holes", ("",), planar=True),
    PINS: Reach("carrier_holes", planar=True),  # of each outwards and counter-clockwise
    "carrier offset": Reach("carrier_offsets", planar=True),
    "sun thickness": Reach("sun_thickness"),
    "planet thickness": Reach("planet_thickness", ("planet",)),
    "sun offset": Reach("sun_offset", planar=True),
    "planet offset": Reach("planet_offset", ("planet",), planar=True),
}
"""Effects of contributors, by their words."""


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
    def nothing(cls, model: RVSet, trials: int) -> "RVDeviated":
        """No deviations."""
        return cls(
            Deviated.nothing(trials, model.profile.pins, model.discs, model.cranks),
            np.zeros(trials),
            np.zeros((trials, model.cranks)),
            np.zeros((trials, 2)),
            np.zeros((trials, model.cranks, 2)),
            np.zeros((trials, model.discs, 2)),
            np.zeros((trials, model.discs, model.cranks)),
            np.zeros((trials, model.cranks)),
        )

    @override
    def reached(self, model: RVSet, acts: Acts) -> tuple[Array, Along]:
        reach = EFFECTS[acts.effect]
        array: Array = getattr(self if hasattr(self, reach.array) else self.stage, reach.array)
        if acts.effect == RING:
            return array, _ring_moved(model.profile.pins)
        if acts.effect == PINS:
            azimuths = model.azimuths / (2 * np.pi)
            return array, lambda components: turned(components.reshape(len(components), model.cranks, 2), azimuths)
        into = array if reach.part is None else array[..., reach.part]
        sizes = [size if word else 1 for size, word in zip(into.shape[1:], reach.each, strict=False)]
        return into, lambda components: components.reshape(len(components), *sizes, *(2,) * reach.planar)


def _ring_moved(pins: int) -> Along:
    """A displacement x, y of all pins, outwards and counter-clockwise at each."""
    azimuths = evenly(pins)
    cos, sin = np.cos(azimuths), np.sin(azimuths)

    def moved(components: Array) -> Array:
        x, y = components[:, :1], components[:, 1:]
        return np.stack([cos * x + sin * y, cos * y - sin * x], axis=-1)

    return moved
