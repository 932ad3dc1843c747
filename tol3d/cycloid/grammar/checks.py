"""Warnings of probable slips in a scene of an RV reducer: discs ground far off, pins far off or overlapping."""

import math
from collections.abc import Iterator
from typing import Final

from tol3d.cycloid.grammar.moves import RVReducerSpec
from tol3d.cycloid.grammar.parts import PinRingSpec
from tol3d.cycloid.grammar.tolerances import (
    BearingPlaySpec,
    CarrierBearingSpec,
    CarrierHoleSpec,
    CrankEccentricitySpec,
    DiscEccentricitySpec,
    DiscHoleSpec,
    LobePitchSpec,
    LobeProfileSpec,
    PinCircleSpec,
    PinPositionSpec,
    PinRadiusSpec,
    PinRingOffsetSpec,
)
from tol3d.scene import Scene
from tol3d.scene.implausible import Implausible, larger_end
from tol3d.scene.place import KeyPath

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
