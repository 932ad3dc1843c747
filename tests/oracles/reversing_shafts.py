"""Two gears on shafts in two bearings each, which their loads push across the clearances: statics and a search.

The force is along the common normal at the pitch point; equilibrium in space gives the load on each bearing, towards
which its end of the shaft moves by half the clearance. The free turn is found by searching the screw flanks. Nothing
here comes from tol3d.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from oracles.screw_flanks import Array, Placed, ScrewGear, lag


@dataclass(frozen=True)
class Bearings:
    """Two bearings of a shaft: heights over the middle of the gear's face, along its z, and clearances [mm]."""

    heights: tuple[float, float]
    clearances: tuple[float, float]


@dataclass(frozen=True)
class Stage:
    """A driver and a driven gear, which may be a ring, with parallel axes so far apart [mm], on their bearings.

    The world: the driver's axis is z, the teeth meet at +x of it.
    """

    gears: tuple[ScrewGear, ScrewGear]
    bearings: tuple[Bearings, Bearings]
    apart: float

    @property
    def out(self) -> int:
        """-1 where the driven gear is a ring."""
        return self.gears[1].out

    @property
    def working_angle(self) -> float:
        """alpha_wt [rad]."""
        return math.acos(abs(self.gears[0].base + self.out * self.gears[1].base) / self.apart)

    def normal(self, side: int) -> Array:
        """Direction of the force on the driven gear by the driver's right (1) or left (-1) flanks.

        Through the pitch point, and across the flank's generators, which lean by the base helix.
        """
        gear, alpha = self.gears[0], self.working_angle
        base_helix = math.atan(gear.twist * gear.base)
        outwards = np.array([math.sin(alpha), -side * math.cos(alpha), 0.0])
        return np.asarray(outwards * math.cos(base_helix) + np.array([0.0, 0.0, side * math.sin(base_helix)]))

    def loads(self, which: int, side: int) -> Array:
        """Loads across the axis (2, 2) on both bearings of the driver (0) or the driven gear (1), per normal force."""
        force = self.normal(side) * (1.0 if which else -1.0)
        pitch = self.gears[0].base / math.cos(self.working_angle)
        point = np.array([pitch - (self.out * self.apart if which else 0.0), 0.0, 0.0])
        moment = np.cross(point, force)
        low, high = self.bearings[which].heights
        rows = np.array([[1, 0, 1, 0], [0, 1, 0, 1], [0, -low, 0, -high], [low, 0, high, 0]], dtype=float)
        return np.linalg.solve(rows, [force[0], force[1], moment[0], moment[1]]).reshape(2, 2)

    def placed(self, which: int, side: int) -> Placed:
        """A gear where the load on the driver's right or left flanks pushes its shaft."""
        loads, own = self.loads(which, side), self.bearings[which]
        ends = [size / 2 * load / np.hypot(*load) for size, load in zip(own.clearances, loads, strict=True)]
        slope = (ends[1] - ends[0]) / (own.heights[1] - own.heights[0])
        off = ends[0] - slope * own.heights[0]
        turned = Rotation.from_rotvec([-slope[1], slope[0], 0.0]).as_matrix()
        at = np.array([self.out * self.apart if which else 0.0, 0.0, 0.0])
        return Placed(self.gears[which], turned, at + np.array([*off, 0.0]))

    def rest(self, turn: float, flank: int, loaded: int) -> float:
        """Turn of the driven gear [rad] at which a side touches, the shafts as the load on a side pushes them."""
        driver, driven = (self.placed(which, loaded) for which in (0, 1))
        first, last = self.gears
        found = (math.pi if self.out > 0 else 0.0) + math.pi / last.teeth - self.out * first.teeth / last.teeth * turn
        middle = round(-turn * first.teeth / (2 * math.pi))
        for _ in range(3):  # no gear is eccentric: the lag falls by a base arm per turn
            least = min(
                lag(driver, driven, (turn, found), flank, (tooth, self._mate(tooth, flank)))
                for tooth in range(middle - 4, middle + 5)
            )
            found -= self.out * flank * least / last.base
        return found

    def _mate(self, tooth: int, flank: int) -> int:
        if self.out > 0:
            return -tooth if flank == 1 else -tooth - 1
        return tooth - 1 if flank == 1 else tooth

    def free_turn(self, turn: float, working: int, *, reversing: bool = True) -> float:
        """Turn of the driven gear [rad] from the working flanks to the others; without reversal the shafts stay."""
        drive = self.rest(turn, working, working)
        return self.out * working * (self.rest(turn, -working, -working if reversing else working) - drive)

    def pushed_open(self, working: int) -> float:
        """Opening by both loads [mm along the normals] if nothing leans, by virtual work: half of each clearance
        times the load on its bearing."""
        return sum(
            size / 2 * float(np.hypot(*load))
            for which in (0, 1)
            for side in (working, -working)
            for size, load in zip(self.bearings[which].clearances, self.loads(which, side), strict=True)
        )
