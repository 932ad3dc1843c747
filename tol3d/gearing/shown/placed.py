"""A build's gears where they came to rest: poses, contact and gap of every mesh, for pictures and files."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids import DisplayMesh, display_mesh
from tol3d.gearing.engines import OK
from tol3d.gearing.meshing.mesh import ROOT_FINDING_NOISE
from tol3d.gearing.model import Mesh
from tol3d.gears import Gear
from tol3d.numerics.arrays import Array
from tol3d.report.number import measured_text

DISPLAY_DEFLECTION: Final = 0.5e-3  # mm; a hundredth of a common backlash, and 40 000 triangles a gear at most
CONE_DEFLECTION: Final = 5e-3  # mm; of a bevel gear, whose faces OCC meshes one by one and much finer than asked
HELICAL_DEFLECTION: Final = 15e-3  # mm; on pages, of a helical gear, whose mesh for files has dozens of layers


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

    @property
    def coarse(self) -> Callable[[], tuple[Array, NDArray[np.int64]]] | None:
        """Its surface with coarser facets, of a helical gear; None of others."""
        if not self.gear.twist:
            return None

        def surface() -> tuple[Array, NDArray[np.int64]]:
            display = display_mesh(self.gear, HELICAL_DEFLECTION)
            return display.thickened(self.flank_turn), display.triangles

        return surface

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
        """True if the deviation folds no triangle over, as happens where a flank passes points of the tip."""
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
    """A mesh of the build: its gears, their contact, and the gap between their other flanks.

    Args:
        mesh: the mesh.
        driver, driven: the placed gears, in the world of the mesh.
        driver_angle, driven_angle: their turns about their own axes [rad].
        contact, normal: point on the driver's working flank (3,) [mm] and the unit vector to the driven.
        gap: the nearest points of the non-working flanks, driver's and driven's, (2, 3) [mm].
        gap_value: their distance [mm], the normal backlash; NaN where the flanks overlap too deep to measure.
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
    def gap_words(self) -> str:
        """The gap with its length, or the overlap."""
        word = "gap" if self.gap_value > -ROOT_FINDING_NOISE else "overlap"
        return f"{word} {measured_text(1000 * abs(self.gap_value), 'um')}"

    @property
    def tip_clearance(self) -> float:
        """Smaller free distance [mm] between a tip and the mate's root."""
        origins = np.stack([part.world_from_gear[:3, 3] for part in (self.driver, self.driven)])
        return self.mesh.pair.tip_clearance(origins, (self.driver.scale, self.driven.scale))


OPEN_SHARE: Final = 1 / 8  # of the base pitch; a magnified gap stays this small, a third of a tooth
MAGNIFY_STEPS: Final = 16  # halvings of the range of magnifications; 1/65536 of it
MAGNIFY_DIGITS: Final = 3  # of the magnification in use, rounded down

Meshes = Sequence[SeatedMesh]


def allowed_factor(seated: Callable[[float], Meshes], wanted: float) -> tuple[float, str]:
    """The largest factor up to the wanted one with which a build can be shown, and notes on it.

    Args:
        seated: the meshes of the build with its deviations multiplied by a factor.
        wanted: the factor that was asked for, at least 0.
    """
    plain, meshes = seated(1.0), seated(wanted)
    widest = {mesh.mesh.name: max(OPEN_SHARE * mesh.driver.gear.base_pitch, mesh.gap_value) for mesh in plain}

    def allowed(meshes: Meshes) -> bool:
        return all(_in_its_space(mesh, widest[mesh.mesh.name]) for mesh in meshes)

    if wanted < 1.0 or allowed(meshes):
        return wanted, f"deviations magnified {wanted:g} times: {_gaps_text(plain, meshes)}"
    if not allowed(plain):
        return 1.0, "not magnified: the teeth do not run free in this build"
    low, high = 1.0, wanted
    for _ in range(MAGNIFY_STEPS):
        middle = (low + high) / 2
        low, high = (middle, high) if allowed(seated(middle)) else (low, middle)
    used = max(1.0, _rounded_down(low))
    return (
        used,
        f"deviations magnified {used:g} times, not {wanted:g}: beyond that the gap would leave the tooth space "
        f"(allowed are 0 to {' or '.join(f'{1000 * width:.0f}' for width in widest.values())} µm) or a tip would fold; "
        f"{_gaps_text(plain, seated(used))}",
    )


def _in_its_space(mesh: SeatedMesh, widest: float) -> bool:
    free = mesh.status == OK and mesh.gap_value <= widest and mesh.tip_clearance > 0.0
    return free and mesh.driver.unfolded and mesh.driven.unfolded


def _gaps_text(plain: Meshes, meshes: Meshes) -> str:
    texts = [
        f"{mesh.mesh.name} has a normal backlash of {measured_text(1000 * mesh.gap_value, 'um')} instead of "
        f"{measured_text(1000 * before.gap_value, 'um')}"
        for before, mesh in zip(plain, meshes, strict=True)
    ]
    return ", ".join(texts)


def _rounded_down(value: float) -> float:
    step = 10.0 ** (math.floor(math.log10(value)) - MAGNIFY_DIGITS + 1)
    return round(math.floor(value / step) * step, 10)
