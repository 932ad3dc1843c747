"""The nominal scene that tolerances deviate from, and how a tolerance becomes a contributor."""

from collections.abc import Mapping
from dataclasses import dataclass

from tol3d.errors import GeometryError
from tol3d.gearing.effects import NOTHING, Temperature
from tol3d.gearing.grammar.moves import meshes_of
from tol3d.gearing.grammar.tolerances.flank_tolerance import FlankToleranceSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import GearingToleranceSpec, by_scale
from tol3d.gearing.model.layout import Layout
from tol3d.gearing.model.model import Contributor
from tol3d.gearing.shafts import Carried, Mesh
from tol3d.gears import BevelPair
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.cylindrical_pair import CylindricalPair
from tol3d.scene import Scene
from tol3d.scene.bases import ToleranceEntry
from tol3d.scene.temperature import TemperatureSpec
from tol3d.study.system.draw import Planar, Scalar


@dataclass(frozen=True)
class Nominal:
    """Nominal data for the meaning of a tolerance: the scene, its meshes and the positions of its shafts."""

    scene: Scene
    meshes: Mapping[str, Mesh]
    layout: Layout

    def mesh_of(self, gear: str, mesh: str | None = None) -> Mesh:
        """The mesh of that name, or the first one of a gear."""
        return self.meshes[mesh or meshes_of(gear, self.scene.moves)[0]]

    def bevel_pair(self, mesh: str) -> BevelPair:
        """The pair of a bevel mesh."""
        pair = self.meshes[mesh].pair
        if not isinstance(pair, BevelPair):
            raise TypeError(f"{mesh} has no shaft angle")
        return pair

    def smaller_face_width(self, mesh: str) -> float:
        """Smaller face width of the gears of a mesh [mm]."""
        pair = self.meshes[mesh].pair
        return min(pair.pinion.face_width, pair.wheel.face_width)

    def carried_by(self, shaft: str) -> list[Carried]:
        """The gears on a shaft."""
        return [own for name, own in self.layout.carrying.values() if name == shaft]

    def seat_azimuth(self, mesh: str) -> float:
        """Turn of the driven gear of a mesh that closes a load path, 0 of others [rad]."""
        return self.layout.seating(mesh).azimuth

    def contributor(self, name: str, spec: ToleranceEntry) -> Contributor:
        """A tolerance in the simulation.

        Raises:
            SceneError: of a shaft, or a bearing of one, on which no gear sits; limits that do not go with their gear.
        """
        if isinstance(spec, FlankToleranceSpec):
            return self._of_flanks(name, spec)
        if isinstance(spec, TemperatureSpec):
            return self._warming(name, spec)
        if not isinstance(spec, GearingToleranceSpec):
            raise TypeError(f"{type(spec).__name__} is no tolerance of gears")
        meaning = spec.meaning(self)
        if meaning.effect == NOTHING:
            shaft, *_ = spec.references()
            raise self.scene.refuse(
                ("tolerances", name, *shaft.path),
                f"expected a shaft with a gear on it, or a bearing of one, got {shaft.name!r}: nothing that meshes "
                "moves with it",
            )
        law = by_scale(spec.distribution.resolve(self.scene.files), meaning.scale)
        return Contributor(
            name=name,
            kind=spec.kind,
            effect=meaning.effect,
            draw=Planar(law, meaning.azimuth) if meaning.planar else Scalar(law),
            unit=spec.unit,
            description=spec.description,
            least=meaning.least,
            nominal=spec.nominal,
        )

    def _warming(self, name: str, spec: TemperatureSpec) -> Contributor:
        law = spec.distribution.resolve(self.scene.files)
        return Contributor(name, spec.kind, Temperature(spec.of), Scalar(law), "K", spec.description)

    def _of_flanks(self, name: str, spec: FlankToleranceSpec) -> Contributor:
        gear = self.mesh_of(spec.of).gear(spec.of)
        if not isinstance(gear, CylindricalGear):
            raise TypeError(f"{spec.of} is no cylindrical gear")
        try:
            draw = spec.draw(gear, self.scene.files)
            effect = spec.effect(gear, self._active_roll(spec.of, gear))
            return Contributor(name, spec.kind, effect, draw, spec.unit, spec.description)
        except GeometryError as error:
            raise self.scene.refuse(("tolerances", name), str(error)) from error

    def _active_roll(self, name: str, gear: CylindricalGear) -> float:
        """Roll [rad] at which a gear's active profile begins: where a mate's nominal tip touches nearest to its root.

        The least of an external gear, the largest of a ring.
        """
        found, sense = list[float](), gear.iso_sign
        for mesh in (self.meshes[own] for own in meshes_of(name, self.scene.moves)):
            pair = mesh.pair
            if isinstance(pair, CylindricalPair):
                own = pair if name == mesh.driver else type(pair)(pair.wheel, pair.pinion, pair.centre_distance)
                found.append(own.start_roll)
        return sense * max(sense * gear.form_roll, min(sense * roll for roll in found or [gear.form_roll]))
