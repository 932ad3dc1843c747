"""Radial clearance of bearings, which shifts and tilts the gears on their shafts."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar, Literal

from pydantic import Discriminator, Field, Tag

from tol3d.gearing.effects import NOTHING, AxialPlay, AxisOffset, AxisTilt, Effect, Plane
from tol3d.gearing.grammar.moves import GearMeshSpec, meshes_of
from tol3d.gearing.grammar.parts import BearingSpec, BevelGearSpec, GearSpec, gears_on
from tol3d.gearing.grammar.tolerances.gearing_tolerance import (
    GearToleranceSpec,
    Meaning,
    Nominal,
    in_direction,
    together,
)
from tol3d.gearing.shafts import Carried, Mesh
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


WORDS = ("apart", "random", "tooth_force")


class BearingClearanceSpec(GearToleranceSpec):
    """Delta b, a length on the diameter: the axis of the gear, or of the bearing's shaft, moves by Delta b / 2.

    `apart` moves it along the line of centres so that positive opens, away from the mate, `tooth_force` along
    the force on its working flank, `{at: angle}` at an azimuth of the frame of gear or shaft at rest, `random`
    anywhere. Of a bearing, the first two are those of the gear on its shaft that the mesh is of.

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
        "several, and for a bearing whose direction is apart or tooth_force",
    )
    direction: Annotated[
        Annotated[Literal["apart", "random", "tooth_force"], Tag("word")] | FixedAngle,
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
        elif self.mesh is None and self.direction in ("apart", "tooth_force"):
            yield Contradiction(
                ("mesh",), f"the mesh that a bearing's direction: {self.direction} is of", "none", meshes
            )

    def meaning(self, nominal: Nominal) -> Meaning:
        """Half the clearance, away from the mesh, at an azimuth of the frame at rest, or along the tooth force."""
        bearing = nominal.scene.parts[self.of]
        if isinstance(bearing, BearingSpec):
            return self._meaning_of_bearing(bearing, nominal)
        if self.direction == "random":
            return in_direction([AxisOffset(self.of, factor=0.5)], self.direction)
        return Meaning(AxisOffset(self.of, unit_vector(self._azimuth(self.of, nominal)), factor=0.5), least=0.0)

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
        mesh = nominal.meshes[self.mesh] if self.mesh else None
        read = (lever.own for lever in levers if mesh and lever.own.gear in (mesh.driver, mesh.driven))
        gear = next(read, levers[0].own)
        seen = self._azimuth(gear.gear, nominal)
        if self.direction == "tooth_force" and mesh and mesh.gear(gear.gear).twist:
            towards = seen - _force_azimuth(mesh, gear.gear)
            seen = towards + _load_azimuth(mesh, gear, at, others[0])
        azimuth = -seen if gear.backward and not isinstance(self.direction, At) else seen
        effects = [effect for lever in levers for effect in lever.towards(azimuth)]
        return Meaning(together([*effects, *slides]), least=0.0, scale=scale)

    def _azimuth(self, gear: str, nominal: Nominal) -> float:
        """Azimuth in which the axis of a gear moves [rad], in its frame at rest on its shaft."""
        if isinstance(self.direction, At):
            return self.direction.at.internal
        mesh = nominal.mesh_of(gear, self.mesh)
        role = 0 if gear == mesh.driver else 1
        towards, opening = mesh.pair.mesh_azimuths[role], mesh.pair.opening_off_mesh[role]
        towards += mesh.azimuth if gear == mesh.driver else nominal.seat_azimuth(mesh.name)
        return towards + (opening if self.direction == "apart" else _force_azimuth(mesh, gear))


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
    here, there = (own.sense * (place - own.at) for place in (at, other))
    radius = pair.working_radii[0 if driver else 1]
    share = there / (there - here)
    return math.atan2(share * onwards, share * towards + radius * thrust / (there - here))


def _force_azimuth(mesh: Mesh, gear: str) -> float:
    """Azimuth off the mesh [rad] of the radial part of the force on a gear by its mate's working flank.

    With the mesh at azimuth 0 the normal force is (-sin(alpha_w) cos(delta), sigma cos(alpha_w)) across the axis,
    sigma the gear's own flank: each sees the other push it away and around. A ring is pulled towards the mesh.
    """
    alpha, driver = mesh.pair.working_pressure_angle, gear == mesh.driver
    flank = float(mesh.working_flank if driver else mesh.driven_flank)
    away = math.cos(mesh.pair.opening_off_mesh[0 if driver else 1])
    return math.atan2(flank * math.cos(alpha), away * math.sin(alpha) * math.cos(mesh.gear(gear).pitch_angle))
