"""A build's gears where they came to rest: poses, contact and gap of every mesh, for pictures and files."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import Mesh
from tol3d.gears import Gear
from tol3d.solids import DisplayMesh, display_mesh

Array = NDArray[np.float64]

DISPLAY_DEFLECTION: Final = 0.5e-3  # mm; a hundredth of a common backlash, and 40 000 triangles a gear at most
CONE_DEFLECTION: Final = 5e-3  # mm; of a bevel gear, whose faces OCC meshes one by one and much finer than asked


@dataclass(frozen=True, eq=False)
class PlacedGear:
    """A perturbed gear where it ended up.

    Args:
        name: the part's.
        gear: nominal geometry.
        world_from_gear: (4, 4), rotation and translation [mm].
        flank_turn: by what each flank is turned out of its tooth [rad]; offsets are shown as such turns.
        scale: thermal growth, 1 at the reference temperature.
    """

    name: str
    gear: Gear
    world_from_gear: Array
    flank_turn: float
    scale: float

    def surface(self) -> tuple[Array, NDArray[np.int64]]:
        """Closed triangle mesh in its own frame, before thermal growth: vertices (n, 3) [mm], triangles (m, 3)."""
        display = self.display
        return display.thickened(self.flank_turn), display.triangles

    def mesh(self) -> tuple[Array, NDArray[np.int64]]:
        """Closed triangle mesh in the world: vertices (n, 3) [mm], triangles (m, 3)."""
        own, triangles = self.surface()
        rotation, translation = self.world_from_gear[:3, :3], self.world_from_gear[:3, 3]
        return self.scale * own @ rotation.T + translation, triangles

    @property
    def display(self) -> DisplayMesh:
        """Its mesh in its own frame [mm], nominal."""
        return display_mesh(self.gear, CONE_DEFLECTION if self.gear.pitch_angle else DISPLAY_DEFLECTION)

    @property
    def unfolded(self) -> bool:
        """Whether the deviation turns no triangle over, as it does where a flank passes points of the tip."""
        display = self.display
        corners = (shape[display.triangles] for shape in (display.vertices, display.thickened(self.flank_turn)))
        before, after = (np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]) for c in corners)
        return bool(((before * after).sum(axis=1) >= 0.0).all())

    @property
    def perturbed(self) -> Gear:
        """The gear with its deviation and its growth in its numbers.

        Raises:
            GeometryError: such a gear cannot be made.
        """
        return self.gear.perturbed(self.flank_turn, self.scale)


@dataclass(frozen=True, eq=False)
class SeatedMesh:
    """A mesh of the build: its gears, where they touch, and how far their other flanks are apart.

    Args:
        mesh: which.
        driver, driven: the placed gears, in the world of the mesh.
        driver_angle, driven_angle: their turns about their own axes [rad].
        contact, normal: point on the driver's working flank (3,) [mm] and the unit vector to the driven.
        gap: the nearest points of the non-working flanks, driver's and driven's, (2, 3) [mm].
        gap_value: their distance [mm], the normal backlash; nan where the flanks overlap too deep to measure.
        status: OK, INTERFERES or NO_CONTACT.
    """

    mesh: Mesh
    driver: PlacedGear
    driven: PlacedGear
    driver_angle: float
    driven_angle: float
    contact: Array
    normal: Array
    gap: Array
    gap_value: float
    status: int

    @property
    def tip_clearance(self) -> float:
        """Smaller free distance [mm] between a tip and the mate's root."""
        origins = np.stack([part.world_from_gear[:3, 3] for part in (self.driver, self.driven)])
        return self.mesh.pair.tip_clearance(origins, (self.driver.scale, self.driven.scale))
