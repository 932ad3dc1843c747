"""Position of a joint in its play: draws that are fractions of its clearance, and the offset of its frame."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.placing.poses import IDENTITY, Pose, about, unit
from tol3d.assembly.torsors.columns import Columns
from tol3d.statistics.distributions.base import Distribution

Array = NDArray[np.float64]

NOWHERE: Final = 1e-300


@dataclass(frozen=True)
class InBall(Distribution):
    """Distance from its middle of a point anywhere in a ball."""

    radius_of_ball: float = 1.0

    def ppf(self, u: Array) -> Array:
        """radius u^(1/3)."""
        return np.asarray(self.radius_of_ball * np.cbrt(u))

    def cdf(self, x: Array) -> Array:
        """(x / radius)^3."""
        return np.asarray(np.clip(x / self.radius_of_ball, 0.0, 1.0) ** 3)

    @property
    def mean(self) -> float:
        """3/4 of the radius."""
        return 0.75 * self.radius_of_ball

    @property
    def variance(self) -> float:
        """3/5 - 9/16 of its square."""
        return 0.0375 * self.radius_of_ball**2

    @property
    def limits(self) -> tuple[float, float]:
        """0 and the radius."""
        return 0.0, self.radius_of_ball


@dataclass(frozen=True, eq=False)
class JointPlay:
    """Play of one joint.

    Args:
        clearance: half of the diameter's nominal clearance [mm].
        clearance_by: column of its deviation, a diameter; -1 for none.
        drawn: columns of what is drawn: of a ball (x, y, z), of two ends (x, y each), as shares; None where it is not.
        toward: the direction in the frame before in which a ball lies at the end of its play (3,); None for centred.
        length: between the two ends [mm]; 0 of a ball.
    """

    clearance: float
    clearance_by: int
    drawn: slice | None
    toward: Array | None
    length: float

    @property
    def told(self) -> tuple[object, ...]:
        """All of it, to be compared."""
        toward = None if self.toward is None else self.toward.tobytes()
        drawn = None if self.drawn is None else (self.drawn.start, self.drawn.stop)
        return self.clearance, self.clearance_by, drawn, toward, self.length

    def radius(self, columns: Array) -> Array:
        """Half of the clearance in trials (n,) or (1,) [mm]."""
        if self.clearance_by < 0:
            return np.array([self.clearance])
        return np.asarray(self.clearance + 0.5 * columns[self.clearance_by])

    def offset(self, columns: Array) -> tuple[Pose, NDArray[np.bool_]]:
        """Offset of the frame before, and True where there is any room (n,) or (1,)."""
        radius = self.radius(columns)
        fits = radius >= 0.0
        size = np.maximum(radius, 0.0)
        if self.toward is not None:
            return Pose(IDENTITY.turn, size * self.toward[:, None]), fits
        if self.drawn is None:
            return IDENTITY, fits
        shares = size * columns[self.drawn]
        if self.length == 0.0:
            return Pose(IDENTITY.turn, shares), fits
        zero = np.zeros_like(shares[0])
        lean = np.stack(
            [(shares[2] - shares[0]) / self.length, (shares[3] - shares[1]) / self.length, np.ones_like(zero)]
        )
        z = unit(lean)
        sine = np.sqrt(z[0] * z[0] + z[1] * z[1])
        share = 1.0 / np.where(sine > NOWHERE, sine, 1.0)
        axis = np.stack([-z[1] * share, z[0] * share, zero])
        middle = np.stack([(shares[0] + shares[2]) / 2, (shares[1] + shares[3]) / 2, zero])
        return Pose(about(axis, z[2], sine), middle), fits

    @property
    def nominal(self) -> Pose:
        """Offset of the frame before without deviations."""
        return IDENTITY if self.toward is None else Pose(IDENTITY.turn, self.clearance * self.toward[:, None])

    def torsor(self, columns: Columns) -> Array:
        """First-order torsor about its nominal position, in the frame before (6, columns)."""
        found = columns.zeros(6)
        if self.toward is not None:
            if self.clearance_by >= 0:
                found[:3, self.clearance_by] = 0.5 * self.toward
        elif self.drawn is not None:
            own = self.drawn.start
            if self.length == 0.0:
                found[[0, 1, 2], [own, own + 1, own + 2]] = self.clearance
            else:
                for end, sign in ((0, -1.0), (2, 1.0)):
                    found[0, own + end] = found[1, own + end + 1] = self.clearance / 2
                    found[4, own + end] = sign * self.clearance / self.length
                    found[3, own + end + 1] = -sign * self.clearance / self.length
        return found
