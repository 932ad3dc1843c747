"""Where the parts of a cycloid stage stand: nominally, and in a trial as its first contact leaves them."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tol3d.cycloid.contact import ContactStage
from tol3d.cycloid.contact_kinematics import CARRIER_TURN, CENTRE, CRANK_TURN, HOLES, THROW, throws
from tol3d.cycloid.deviated import Deviated

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Place:
    """Of a part in the plane.

    Args:
        at: of its axis, x + i y [mm].
        turned: counter-clockwise [rad].
    """

    at: complex
    turned: float


@dataclass(frozen=True)
class StagePlaces:
    """One trial of a cycloid stage with its cranks at an angle and its carrier turned.

    Args:
        stage: the stage.
        deviated: of that trial alone.
        phi: crank angle [rad].
        turn: of the carrier beyond -phi / Zc [rad], as `ContactStage.touches` finds it; 0 for the nominal place.
    """

    stage: ContactStage
    deviated: Deviated
    phi: float
    turn: float = 0.0

    @classmethod
    def nominal(cls, stage: ContactStage, phi: float) -> "StagePlaces":
        """Nothing deviates."""
        return cls(stage, Deviated.nothing(1, stage.profile.pins, stage.discs, stage.cranks), phi)

    @property
    def carrier_turned(self) -> float:
        """chi [rad]."""
        return -self.phi / self.stage.profile.lobes + self.turn

    @property
    def cranks_turned(self) -> float:
        """But for their phase errors [rad]: while the sun stands they roll on it as the carrier turns."""
        return self.phi + self.stage.rolling * self.turn

    @property
    def carrier(self) -> Place:
        """The carrier, displaced by its main bearing."""
        offset = _complex(self.deviated.carrier_offsets[0])
        return Place(complex(np.exp(1j * self.carrier_turned) * offset), self.carrier_turned)

    @property
    def cranks(self) -> tuple[Place, ...]:
        """In the carrier's holes."""
        count = self.stage.cranks
        holes = self.stage.crank_circle * np.exp(2j * math.pi * np.arange(count) / count)
        holes = holes + _complex(self.deviated.carrier_holes[0]) + _complex(self.deviated.carrier_offsets[0])
        axes = np.exp(1j * self.carrier_turned) * holes
        turns = self.cranks_turned + self.deviated.crank_phases[0]
        return tuple(Place(complex(at), float(turned)) for at, turned in zip(axes, turns, strict=True))

    @property
    def discs(self) -> tuple[Place, ...]:
        """The profiles' centres, and the turns of their crank holes."""
        linkage = self._linkage
        chi, crank = np.exp(1j * self.carrier_turned), np.exp(1j * self.cranks_turned)
        turns = chi * linkage[:, CARRIER_TURN.start // 2] + crank * linkage[:, CRANK_TURN.start // 2]
        turns = turns / np.abs(turns)
        centres = chi * linkage[:, CENTRE.start // 2] + crank * linkage[:, THROW.start // 2]
        centres = centres - turns * linkage[:, HOLES.start // 2]
        return tuple(Place(complex(at), float(np.angle(turn))) for at, turn in zip(centres, turns, strict=True))

    @property
    def pins(self) -> tuple[Place, ...]:
        """Each turned to its azimuth."""
        count = self.stage.profile.pins
        azimuths = 2 * math.pi * np.arange(count) / count
        off = self.stage.profile.pin_circle_radius + _complex(self.deviated.pins[0])
        return tuple(
            Place(complex(at), float(azimuth))
            for at, azimuth in zip(off * np.exp(1j * azimuths), azimuths, strict=True)
        )

    @property
    def throws(self) -> Array:
        """Directions in which the cranks' eccentrics point for each disc (discs,) [rad]."""
        return throws(self.stage.discs)

    @cached_property
    def _linkage(self) -> NDArray[np.complex128]:
        """Of contact_kinematics, as complex numbers (discs, 5)."""
        found = self.stage.as_made(self.deviated).linkage[0]
        return np.asarray(found[:, 0::2] + 1j * found[:, 1::2])


def _complex(points: Array) -> NDArray[np.complex128]:
    return np.asarray(points[..., 0] + 1j * points[..., 1])
