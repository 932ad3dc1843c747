"""Kinds of tolerance of RV reducers.

Warnings of probable slips in a scene of an RV reducer: discs ground far off, pins far off or overlapping.
"""

import math
from collections.abc import Iterator
from typing import ClassVar, Final, Literal

from pydantic import Field

from tol3d.gearing.cycloid.grammar.moves import RVReducerSpec
from tol3d.gearing.cycloid.grammar.parts import CrankCarrierSpec, CrankshaftSpec, CycloidDiscSpec, PinRingSpec
from tol3d.scene import Scene
from tol3d.scene.bases import PartSpec, ToleranceSpec
from tol3d.scene.entry import AboutOne
from tol3d.scene.implausible import Implausible, larger_end
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.units import Dimension


class OfDisc(AboutOne, ToleranceSpec):
    """A tolerance of the disc."""

    applies_to: ClassVar[tuple[type[PartSpec], ...]] = (CycloidDiscSpec,)

    of: Name = Field(description="the disc")


class OfPinRing(AboutOne, ToleranceSpec):
    """A tolerance of the ring of pins."""

    applies_to: ClassVar[tuple[type[PartSpec], ...]] = (PinRingSpec,)

    of: Name = Field(description="the ring of pins")


class OfCrankshaft(AboutOne, ToleranceSpec):
    """A tolerance of the crankshaft."""

    applies_to: ClassVar[tuple[type[PartSpec], ...]] = (CrankshaftSpec,)

    of: Name = Field(description="the crankshaft")


class OfCarrier(AboutOne, ToleranceSpec):
    """A tolerance of the carrier."""

    applies_to: ClassVar[tuple[type[PartSpec], ...]] = (CrankCarrierSpec,)

    of: Name = Field(description="the carrier")


class BearingPlaySpec(AboutOne, ToleranceSpec):
    """A length: the diametral clearance of each bearing, twice the offset of an inner ring from the middle of its hole.

    That is the radial internal clearance of ISO 5753-1, which is stated on the diameter, as it is left when fitted. Of
    a disc it is the bearing of each eccentric in it, of a carrier that of each crankshaft. Less than 0 is none.
    """

    words: ClassVar[str] = "play of the cranks' bearings"
    applies_to: ClassVar[tuple[type[PartSpec], ...]] = (CycloidDiscSpec, CrankCarrierSpec)

    kind: Literal["bearing_play"]
    of: Name = Field(description="the disc or the carrier")
    each: Literal["hole"] = Field(default="hole", description="hole: every bearing has its own")


class CarrierBearingSpec(OfCarrier):
    """A length: the axis of the carrier lies off that of its main bearing, in a random direction that turns with it.

    Half of a run-out of the inner ring.
    """

    words: ClassVar[str] = "the main bearing of a carrier"

    kind: Literal["carrier_bearing"]


class CarrierHoleSpec(OfCarrier):
    """A length: holes for crankshafts lie off their places in the carrier, in a random direction that turns with it.

    `hole` takes a deviation of every hole; `circle` one of their common centre.
    """

    words: ClassVar[str] = "places of a carrier's holes"

    kind: Literal["carrier_hole"]
    each: Literal["hole", "circle"] = Field(default="hole", description="hole: every hole by itself; circle: all alike")


class CrankEccentricitySpec(OfCrankshaft):
    """A length: an eccentric, or its bearing, lies off its place on the crankshaft, in a random direction of its own.

    Half of a run-out. `disc` takes one deviation for the eccentrics of all cranks that carry one disc; `crank` one for
    every eccentric, of which a disc follows the mean.
    """

    words: ClassVar[str] = "eccentricity of a crankshaft's eccentrics"

    kind: Literal["crank_eccentricity"]
    each: Literal["crank", "disc"] = Field(
        default="crank", description="crank: every eccentric by itself; disc: alike on all cranks"
    )


class CrankPhaseSpec(OfCrankshaft):
    """An angle: each crankshaft is turned against its planet by it, counter-clockwise; each one's own deviation."""

    words: ClassVar[str] = "phases of crankshafts"
    dimensions: ClassVar[tuple[Dimension, ...]] = ("angle",)

    kind: Literal["crank_phase"]
    each: Literal["crank"] = Field(default="crank", description="crank: every crankshaft deviates by itself")


class DiscEccentricitySpec(OfDisc):
    """A length: the profile's centre lies off that of the crank holes, in a random direction that turns with the disc.

    Half of a run-out.
    """

    words: ClassVar[str] = "eccentricity of discs"

    kind: Literal["disc_eccentricity"]
    each: Literal["disc"] = Field(default="disc", description="disc: every disc deviates by itself")


class DiscHoleSpec(OfDisc):
    """A length: each hole for a crank lies off its place in the disc by it, in a random direction."""

    words: ClassVar[str] = "places of a disc's holes"

    kind: Literal["disc_hole"]
    each: Literal["hole"] = Field(default="hole", description="hole: every hole of every disc deviates by itself")


class DiscTiltSpec(OfDisc):
    """An angle: each disc leans by it about an axis in its plane, in a random direction that turns with the disc.

    Pins are upright, so that a face of the disc touches first, or what lies between its faces.
    """

    words: ClassVar[str] = "tilt of discs"
    dimensions: ClassVar[tuple[Dimension, ...]] = ("angle",)

    kind: Literal["disc_tilt"]
    of: Name = Field(description="the disc, whose width counts")
    each: Literal["disc"] = Field(default="disc", description="disc: every disc deviates by itself")


class LobePitchSpec(OfDisc):
    """A length: each lobe lies counter-clockwise of its place by this arc; each one's own deviation, on every disc.

    Its best flank moves by K of it along the normal, K = a Zp/rp.
    """

    words: ClassVar[str] = "places of lobes"

    kind: Literal["lobe_pitch"]
    each: Literal["lobe"] = Field(default="lobe", description="lobe: every lobe deviates by itself")

    nominal: ClassVar[str] = ""  # lobes are drawn at equal pitches


class LobeProfileSpec(OfDisc):
    """A length: excess material of each lobe along the normal; each one's own deviation, on every disc."""

    words: ClassVar[str] = "profiles of lobes"

    kind: Literal["lobe_profile"]
    each: Literal["lobe"] = Field(default="lobe", description="lobe: every lobe deviates by itself")

    nominal: ClassVar[str] = ""  # a profile has one drawn form


class PinCircleSpec(OfPinRing):
    """A length: the radius of the pins' circle is larger by it, alike for all pins."""

    words: ClassVar[str] = "radius of the pins' circle"

    kind: Literal["pin_circle"]


class PinPositionSpec(OfPinRing):
    """A length: each pin lies off its place; each one's own deviation.

    `radial` is positive outwards, `tangential` counter-clockwise; `random` takes the law for the distance from the
    place, in any direction.
    """

    words: ClassVar[str] = "places of pins"

    kind: Literal["pin_position"]
    each: Literal["pin"] = Field(default="pin", description="pin: every pin deviates by itself")
    direction: Literal["radial", "tangential", "random"] = Field(description="radial, tangential or random")

    nominal: ClassVar[str] = ""  # pins are drawn at their places


class PinRadiusSpec(OfPinRing):
    """A length: the radius of each pin is larger by it; each one's own deviation."""

    words: ClassVar[str] = "radii of pins"

    kind: Literal["pin_radius"]
    each: Literal["pin"] = Field(default="pin", description="pin: every pin deviates by itself")


class PinRingOffsetSpec(OfPinRing):
    """A length: the pins' circle lies off the axis of the carrier by it, in a random direction."""

    words: ClassVar[str] = "the pin ring off its axis"

    kind: Literal["pin_ring_offset"]


Problem = tuple[KeyPath, str]

GROUND: Final = Implausible(0.05)
HALF: Final = Implausible(0.5)
OF_DISCS_AND_CRANKS: Final = (
    BearingPlaySpec, CarrierBearingSpec, CarrierHoleSpec, CrankEccentricitySpec, DiscEccentricitySpec, DiscHoleSpec,
    LobePitchSpec, LobeProfileSpec,
)  # fmt: skip
"""Offsets of lobes, discs, cranks and the carrier, as lengths."""


def implausible_grinding(scene: Scene) -> Iterator[Problem]:
    """Modifications of discs that take off, or leave, more than a twentieth of the pins' radius."""
    for move in scene.of(RVReducerSpec).values():
        ring, disc, crank, _ = move.parts_among(scene.parts)
        lever = disc.lobes * crank.eccentricity.internal  # the largest
        turned = disc.rotation.internal * lever
        ground = {"shift": disc.shift.internal, "offset": disc.offset.internal, "rotation": turned}
        for field, taken in ground.items():
            words = f"the pin radius of {move.pin_ring!r}"
            if sentence := GROUND.sentence(words, ring.pin_radius.internal, taken):
                how = f", of a rotation at a lever of {lever:.4g} mm" if field == "rotation" else ""
                yield ("parts", move.disc, field), f"{sentence}{how}"


def implausible_pins(scene: Scene) -> Iterator[Problem]:
    """Pins off their places by more than half of their pitch, off their radius by more than half of it, or overlapping.

    Neighbours overlap where all tolerances of their places and radii at their worst leave no room between them.
    """
    for name, ring in scene.of(PinRingSpec).items():
        half_angle, radius = math.pi / ring.pins, ring.pin_radius.internal
        pitch = 2 * ring.radius.internal * math.sin(half_angle)
        of_pitch, of_radius = f"the pitch of the pins of {name!r}", f"the pin radius of {name!r}"
        room, taken = pitch - 2 * radius, 0.0
        for tolerance, spec in scene.distributed.items():
            if (
                not isinstance(spec, PinPositionSpec | PinCircleSpec | PinRingOffsetSpec | PinRadiusSpec)
                or spec.of != name
            ):
                continue
            low, high = spec.distribution.resolve(scene.files).extremes
            far = max(low, high, key=abs)
            match spec:
                case PinRadiusSpec():
                    sentence, own = HALF.sentence(of_radius, radius, far), 2 * high
                case PinRingOffsetSpec():
                    sentence, own = HALF.sentence(of_pitch, pitch, far), 0.0
                case PinCircleSpec() | PinPositionSpec(direction="radial"):
                    sentence, own = HALF.sentence(of_pitch, pitch, far), -2 * low * math.sin(half_angle)
                case PinPositionSpec():
                    sentence, own = HALF.sentence(of_pitch, pitch, far), 2 * abs(far)
            taken += own
            if sentence:
                yield ("tolerances", tolerance, "distribution"), sentence
        if taken > room > 0.0:
            words = f"expected pins that stay clear of their neighbours, {pitch:.4g} mm apart, got pins of radius "
            words += (
                f"{ring.pin_radius} that overlap by up to {taken - room:.4g} mm where tolerances are at their worst"
            )
            yield ("parts", name, "pin_radius"), f"{words}; check the units of pins' places and radii"


def implausible_discs(scene: Scene) -> Iterator[Problem]:
    """Lobes, discs, cranks and carriers off by more than half of the radius of the pins among which discs run."""
    for move in scene.of(RVReducerSpec).values():
        ring = move.parts_among(scene.parts).ring
        for name, spec in scene.distributed.items():
            if isinstance(spec, OF_DISCS_AND_CRANKS) and spec.of in (move.disc, move.crankshaft, move.carrier):
                far = larger_end(spec.distribution.resolve(scene.files))
                words = f"the pin radius of {move.pin_ring!r}"
                if sentence := HALF.sentence(words, ring.pin_radius.internal, far):
                    yield ("tolerances", name, "distribution"), sentence
