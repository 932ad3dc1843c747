"""Radial clearance of bearings, which shifts and tilts the gears on their shafts."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar, Literal

from pydantic import Discriminator, Field, Tag

from tol3d.gearing.effects import NOTHING, AxialPlay, AxisOffset, AxisTilt, Effect, Plane, Reversing
from tol3d.gearing.grammar.moves import BevelMeshSpec, GearMeshSpec, meshes_of
from tol3d.gearing.grammar.parts import BearingSpec, BevelGearSpec, GearSpec, gears_on
from tol3d.gearing.grammar.tolerances.gearing_tolerance import (
    GearToleranceSpec,
    Meaning,
    Nominal,
    in_direction,
    together,
)
from tol3d.gearing.shafts import Carried, Mesh
from tol3d.gears.flank import opposite
from tol3d.scene.bases import MoveSpec, PartSpec
from tol3d.scene.direction import At, FixedAngle, known_word, shape
from tol3d.scene.entry import Contradiction, Entry, Reference
from tol3d.scene.name import Name


@dataclass(frozen=True)
class Lever:
    """A gear on a shaft with one moving point.

    Args:
        own: the gear on the shaft.
        moved: z of the point that moves [mm].
        fixed: z of one that does not; None where all of the shaft moves alike.
        rate: motion of the point per deviation; half for a clearance.
    """

    own: Carried
    moved: float
    fixed: float | None
    rate: float = 0.5

    @property
    def share(self) -> float:
        """Displacement of the gear per displacement of the point."""
        return 1.0 if self.fixed is None else (self.own.at - self.fixed) / (self.moved - self.fixed)

    def anywhere(self) -> Iterator[Effect]:
        """Shift and tilt of the gear's axis where the point moves by a deviation with a direction on the shaft."""
        plane = Plane(mirrored=self.own.backward)
        yield AxisOffset(self.own.gear, factor=self.rate * self.share, plane=plane)
        if self.fixed is not None:
            per_length = self.rate * self.own.sense / (self.moved - self.fixed)
            yield AxisTilt(self.own.gear, per_length=per_length, plane=plane)

    def towards(self, azimuth: float) -> Iterator[Effect]:
        """Shift and tilt of the gear's axis where the point moves by a deviation, at an azimuth on the shaft."""
        sense = -1.0 if self.own.backward else 1.0
        x, y, _ = unit_vector(azimuth)
        yield AxisOffset(self.own.gear, (x, sense * y, 0.0), factor=self.rate * self.share)
        if self.fixed is not None:
            # z of the shaft turns towards (x, y): about z cross (x, y) = (-y, x)
            per_length = self.rate / (self.moved - self.fixed)
            yield AxisTilt(self.own.gear, (-y, sense * x, 0.0), per_length=per_length)


def unit_vector(azimuth: float) -> tuple[float, float, float]:
    """Unit vector across an axis at an azimuth [rad]."""
    return _exact(math.cos(azimuth)), _exact(math.sin(azimuth)), 0.0


def _exact(cosine: float) -> float:
    """A cosine or sine of a right angle as 0 or 1, not 6e-17 off."""
    return round(cosine) + 0.0 if abs(cosine - round(cosine)) < 1e-15 else cosine


WORDS = ("apart", "random", "tooth_force", "reversing")


class BearingClearanceSpec(GearToleranceSpec):
    """Delta b, a length on the diameter: the axis of the gear, or of the bearing's shaft, moves by Delta b / 2.

    `apart` moves it along the line of centres so that positive opens, away from the mate, `tooth_force` along
    the force on its working flank, `{at: angle}` at an azimuth of the frame of gear or shaft at rest, `random`
    anywhere. `reversing` is tooth_force, and once the load has changed sides the force on the other flank: lost motion
    contains that the axis crosses its clearance. Of a bearing, apart, tooth_force and reversing are those of the gear
    on its shaft that the mesh is of.

    Of a bearing with contact_angle or grooves the same draw lets the shaft slide, as axial_play does: G_a of G_r.
    """

    displaces: ClassVar[bool] = True
    applies_to: ClassVar[tuple[type[Entry], ...]] = (GearSpec, BearingSpec)

    kind: Literal["bearing_clearance"]

    nominal: ClassVar[str] = "clearance"  # a class of clearance

    of: Name = Field(description="the gear that the bearing carries, or a bearing")
    mesh: Name | None = Field(
        default=None,
        description="the mesh whose line of centres or tooth force gives the direction; needed where the gear is in "
        "several, and for a bearing whose direction is apart, tooth_force or reversing",
    )
    direction: Annotated[
        Annotated[Literal["apart", "random", "tooth_force", "reversing"], Tag("word")] | FixedAngle,
        Discriminator(shape),
        known_word(*WORDS),
    ] = Field(default="apart", description="which way the axis moves")
    measured: Literal["radial", "axial"] = Field(
        default="radial",
        description="axial: what is stated is the clearance along the axis, of a bearing with contact_angle or grooves",
    )

    def references(self) -> tuple[Reference, ...]:
        """The gear or bearing, and the mesh if it is given."""
        carried = super().references()
        return carried if self.mesh is None else (*carried, Reference(("mesh",), self.mesh, (GearMeshSpec,)))

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """The gear takes part in the mesh, or in one mesh only; so does a gear on the bearing's shaft."""
        part = parts[self.of]
        yield from self._of_bearing(part, parts, moves) if isinstance(part, BearingSpec) else self._of_gear(moves)
        raceways = part.raceways if isinstance(part, BearingSpec) else None
        if self.measured == "axial" and raceways is None:
            yield Contradiction(("measured",), "radial, or a bearing with contact_angle or grooves", "axial")
        elif isinstance(part, BearingSpec) and raceways is not None:
            for gear in gears_on(part.shaft, parts):
                if isinstance(parts[gear], BevelGearSpec):
                    expected = "a bearing without contact_angle or grooves, for its shaft would slide"
                    yield Contradiction(("of",), expected, f"{self.of!r} of the shaft of the bevel gear {gear!r}")

    def _of_gear(self, moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        meshes = meshes_of(self.of, moves)
        if self.mesh is not None and self.mesh not in meshes:
            yield Contradiction(("mesh",), f"a mesh of the gear {self.of!r}", repr(self.mesh), meshes)
        elif self.mesh is None and len(meshes) != 1:
            yield Contradiction(
                ("of",),
                "a gear of one mesh (or the mesh named beside it)",
                f"{self.of!r}, which is in {len(meshes) or 'none'}",
            )

    def _of_bearing(
        self, bearing: BearingSpec, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]
    ) -> Iterator[Contradiction]:
        gears = gears_on(bearing.shaft, parts)
        through = {mesh for gear in gears for mesh in meshes_of(gear, moves)}
        meshes = tuple(name for name in moves if name in through)
        if self.mesh is not None and self.mesh not in meshes:
            yield Contradiction(("mesh",), f"a mesh of a gear on {bearing.shaft!r}", repr(self.mesh), meshes)
        elif self.mesh is None and self.direction in ("apart", "tooth_force", "reversing"):
            yield Contradiction(
                ("mesh",), f"the mesh that a bearing's direction: {self.direction} is of", "none", meshes
            )
        elif self.direction == "reversing" and self.mesh is not None and isinstance(moves[self.mesh], BevelMeshSpec):
            words = f"reversing: how the thrust of the bevel gear of {self.mesh!r} loads the bearings is not simulated"
            yield Contradiction(("direction",), "apart, random, tooth_force or {at: …}", words)

    def meaning(self, nominal: Nominal) -> Meaning:
        """Half the clearance, away from the mesh, at an azimuth of the frame at rest, or along the tooth force."""
        bearing = nominal.scene.parts[self.of]
        if isinstance(bearing, BearingSpec):
            return self._meaning_of_bearing(bearing, nominal)
        if self.direction == "random":
            return in_direction([AxisOffset(self.of, factor=0.5)], self.direction)

        def pushed(mesh: Mesh) -> list[Effect]:
            return [AxisOffset(self.of, unit_vector(self._azimuth(self.of, mesh, nominal)), factor=0.5)]

        return Meaning(self._by_load(pushed, nominal.mesh_of(self.of, self.mesh)), least=0.0)

    def _by_load(self, pushed: Callable[[Mesh], Sequence[Effect]], mesh: Mesh) -> Effect:
        """Effects with the load on a mesh's working flanks, and on the others where the direction is reversing."""
        loaded = pushed(mesh)
        if self.direction != "reversing":
            return together(loaded)
        return Reversing(tuple(loaded), tuple(pushed(replace(mesh, working_flank=opposite(mesh.working_flank)))))

    def _meaning_of_bearing(self, bearing: BearingSpec, nominal: Nominal) -> Meaning:
        """The shaft's axis moves at the bearing by half the clearance, at its other bearings not at all.

        With one other bearing it turns about that one; alone a bearing moves the whole shaft.
        """
        at = bearing.at.internal
        parts = (part for part in nominal.scene.parts.values() if isinstance(part, BearingSpec))
        others = [part.at.internal for part in parts if part.shaft == bearing.shaft and part.at.internal != at]
        levers = [Lever(own, at, others[0] if others else None) for own in nominal.carried_by(bearing.shaft)]
        if not levers:
            return Meaning(NOTHING)
        raceways = bearing.raceways
        slides = [AxialPlay(bearing.shaft, raceways)] if raceways else []
        scale = raceways if self.measured == "axial" else None
        if self.direction == "random":
            effects = [effect for lever in levers for effect in lever.anywhere()]
            return replace(in_direction([*effects, *slides], self.direction), scale=scale)

        def pushed(mesh: Mesh | None) -> list[Effect]:
            read = (lever.own for lever in levers if mesh and lever.own.gear in (mesh.driver, mesh.driven))
            azimuth = self._azimuth_on_shaft(next(read, levers[0].own), mesh, (at, *others), nominal)
            return [*(effect for lever in levers for effect in lever.towards(azimuth)), *slides]

        mesh = nominal.meshes[self.mesh] if self.mesh else None
        effect = together(pushed(None)) if mesh is None else self._by_load(pushed, mesh)
        return Meaning(effect, least=0.0, scale=scale)

    def _azimuth_on_shaft(self, gear: Carried, mesh: Mesh | None, bearings: Sequence[float], nominal: Nominal) -> float:
        """Azimuth in which the shaft moves at a bearing [rad], in the frame of the shaft at 0.

        Args:
            gear: on the shaft, in the mesh.
            mesh: with its working flanks loaded; None where the direction is an angle.
            bearings: places of this bearing and of the shaft's other one, if there is one [mm].
            nominal: of the scene.
        """
        if isinstance(self.direction, At) or mesh is None:
            return self._azimuth(gear.gear, mesh, nominal)
        seen = self._azimuth(gear.gear, mesh, nominal)
        helical = self.direction == "tooth_force" and mesh.gear(gear.gear).twist
        if helical or (self.direction == "reversing" and len(bearings) > 1):
            seen = seen - _force_azimuth(mesh, gear.gear) + _load_azimuth(mesh, gear, *bearings[:2])
        elif self.direction == "tooth_force" and len(bearings) > 1 and _share(gear, *bearings[:2]) < 0.0:
            seen += math.pi  # a gear beyond both bearings lifts the shaft at the far one
        return -seen if gear.backward else seen

    def _azimuth(self, gear: str, mesh: Mesh | None, nominal: Nominal) -> float:
        """Azimuth in which the axis of a gear moves [rad], in its frame at rest on its shaft."""
        if isinstance(self.direction, At):
            return self.direction.at.internal
        mesh = mesh or nominal.mesh_of(gear, self.mesh)
        role = 0 if gear == mesh.driver else 1
        towards, opening = mesh.pair.mesh_azimuths[role], mesh.pair.opening_off_mesh[role]
        towards += mesh.azimuth if gear == mesh.driver else nominal.seat_azimuth(mesh.name)
        return towards + (opening if self.direction == "apart" else _force_azimuth(mesh, gear))


def _share(own: Carried, at: float, other: float) -> float:
    """Share of a gear's radial force that a bearing takes, at places along the shaft [mm]; below 0 beyond the other."""
    return (other - own.at) / (other - at)


def _load_azimuth(mesh: Mesh, own: Carried, at: float, other: float) -> float:
    """Azimuth off the mesh [rad] of the load of a helical gear on one of two bearings, at places along the shaft [mm].

    The gear's own flank sigma, hand h: the force of its mate at +x is cos(beta_b) times (-sin(alpha_wt),
    sigma cos(alpha_wt), -sigma h tan(beta_b)); a ring is pulled towards the mesh. The thrust, F_z at the working circle
    r_w, adds r_w F_z over the bearings' distance to the load of one of them along the line of centres, and takes it
    from the other's.
    """
    pair, driver = mesh.pair, own.gear == mesh.driver
    alpha, beta_b = pair.working_pressure_angle, math.acos(pair.base_helix_cosine)
    flank = float(mesh.working_flank if driver else mesh.driven_flank)
    away = math.cos(pair.opening_off_mesh[0 if driver else 1])
    towards = away * math.sin(alpha) * math.cos(beta_b)
    onwards = flank * math.cos(alpha) * math.cos(beta_b)
    thrust = -flank * math.copysign(math.sin(beta_b), mesh.gear(own.gear).twist)
    share, radius = _share(own, at, other), pair.working_radii[0 if driver else 1]
    return math.atan2(share * onwards, share * towards + radius * thrust / (own.sense * (other - at)))


def _force_azimuth(mesh: Mesh, gear: str) -> float:
    """Azimuth off the mesh [rad] of the radial part of the force on a gear by its mate's working flank.

    With the mesh at azimuth 0 the normal force is (-sin(alpha_w) cos(delta), sigma cos(alpha_w)) across the axis,
    sigma the gear's own flank: each sees the other push it away and around. A ring is pulled towards the mesh.
    """
    alpha, driver = mesh.pair.working_pressure_angle, gear == mesh.driver
    flank = float(mesh.working_flank if driver else mesh.driven_flank)
    away = math.cos(mesh.pair.opening_off_mesh[0 if driver else 1])
    return math.atan2(flank * math.cos(alpha), away * math.sin(alpha) * math.cos(mesh.gear(gear).pitch_angle))
