"""All parts of a cycloid stage as shapes, where they stand nominally or as the first contact of a trial leaves them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.cad.solids import PosedGear, PosedPart, PosedShape
from tol3d.gearing.cycloid.exact.contact import CARRIER_TURN, CENTRE, CRANK_TURN, HOLES, THROW, ContactStage
from tol3d.gearing.cycloid.model.limits import LEAST_WALL, largest_hole, lobe_reach
from tol3d.gearing.cycloid.model.profile import DiscProfile
from tol3d.gearing.cycloid.model.shapes import (
    Carrier,
    CrankSection,
    Crankshaft,
    CycloidDisc,
    DiscHoles,
    PinRing,
    RingPin,
)
from tol3d.gearing.cycloid.model.stage import Deviated
from tol3d.gears import SpurGear
from tol3d.numerics.arrays import Array, Complex
from tol3d.numerics.plane import as_complex, evenly, upright_pose


@dataclass(frozen=True)
class Place:
    """Position and orientation of a part in the plane.

    Args:
        at: position of its axis, x + i y [mm].
        turned: angle, counter-clockwise [rad].
    """

    at: complex
    turned: float

    def pose(self, level: float = 0.0) -> Array:
        """The same in space (4, 4), at a height [mm]."""
        return upright_pose(self.turned, (self.at.real, self.at.imag), level)


@dataclass(frozen=True)
class StagePlaces:
    """One trial of a cycloid stage with its cranks at an angle and its carrier turned.

    Args:
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
        offset = as_complex(self.deviated.carrier_offsets[0])
        return Place(complex(np.exp(1j * self.carrier_turned) * offset), self.carrier_turned)

    @property
    def cranks(self) -> tuple[Place, ...]:
        """Places of the cranks in the carrier's holes."""
        count = self.stage.cranks
        holes = self.stage.crank_circle * np.exp(2j * math.pi * np.arange(count) / count)
        holes = holes + as_complex(self.deviated.carrier_holes[0]) + as_complex(self.deviated.carrier_offsets[0])
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
        azimuths = evenly(count)
        off = self.stage.profile.pin_circle_radius + as_complex(self.deviated.pins[0])
        return tuple(
            Place(complex(at), float(azimuth))
            for at, azimuth in zip(off * np.exp(1j * azimuths), azimuths, strict=True)
        )

    @cached_property
    def _linkage(self) -> Complex:
        """Terms of contact.linkage, as complex numbers (discs, 5)."""
        found = self.stage.as_made(self.deviated).linkage[0]
        return np.asarray(found[:, 0::2] + 1j * found[:, 1::2])


WALL: Final = 0.08  # of the cranks' circle: between holes
LARGEST_HOLE: Final = 0.8  # of it: a disc's bearing hole
ECCENTRIC: Final = 0.7  # of a bearing hole; rollers fill the rest and are not drawn
JOURNAL: Final = 0.85  # of what an eccentric leaves about the crank's axis
SEAT: Final = 0.9  # of a bearing hole: the carrier's hole for a crank
POST_ROOM: Final = 0.02  # of the cranks' circle: about a post, beyond the eccentricity
WIDTH: Final = 0.15  # of the pins' circle: a disc
GAP: Final = 0.1  # of a disc's width: between discs and flanges
FLANGE: Final = 0.8  # of a disc's width
LOBE_ROOM: Final = 0.1  # of a pin's radius: between lobes and the ring's bore
RIM: Final = 2.0  # pin radii outside the pins
RECESS: Final = 0.3  # of the gap: ends of cranks within faces about them; two faces in one plane flicker


@dataclass(frozen=True)
class StageShapes:
    """Shapes of an RV reducer.

    Args:
        discs: from the lowest on; lobes are clocked so that each meshes where its eccentrics point.
        ring, pin, crank, carrier: the others; the ring's own frame is the world.
        first: gears of the first stage, which lies above the carrier; or none.
    """

    discs: tuple[CycloidDisc, ...]
    ring: PinRing
    pin: RingPin
    crank: Crankshaft
    carrier: Carrier
    first: tuple[SpurGear, SpurGear] | None = None

    @property
    def sun_level(self) -> float:
        """Axial position of the middle of the first stage, that of the discs being 0 [mm]; 0 without a first stage."""
        if self.first is None:
            return 0.0
        width = max(gear.face_width for gear in self.first)
        return self.carrier.between / 2 + self.carrier.flange_width + GAP * self.discs[0].width + width / 2

    def placed(self, places: StagePlaces) -> tuple[PosedPart, ...]:
        """Every part in the world, by names such as "pin 1", "disc 2" and "planet 3"; pins as thick as they are."""
        return tuple(self._placed(places))

    def _placed(self, places: StagePlaces) -> Iterator[PosedPart]:
        yield PosedShape("pin ring", self.ring, np.eye(4))
        for number, (place, grown) in enumerate(zip(places.pins, places.deviated.pin_radii[0], strict=True), start=1):
            own = replace(self.pin, radius=self.pin.radius + float(grown)) if grown else self.pin
            yield PosedShape(f"pin {number}", own, place.pose())
        step = self.discs[0].width * (1 + GAP)
        for number, (disc, place) in enumerate(zip(self.discs, places.discs, strict=True)):
            level = step * (number - (len(self.discs) - 1) / 2)
            yield PosedShape(f"disc {number + 1}", disc, place.pose(level))
        yield PosedShape("carrier", self.carrier, places.carrier.pose())
        for number, place in enumerate(places.cranks, start=1):
            yield PosedShape(f"crank {number}", self.crank, place.pose())
        if self.first is not None:
            yield from self._first_stage(places, *self.first)

    def _first_stage(self, places: StagePlaces, sun: SpurGear, planet: SpurGear) -> Iterator[PosedPart]:
        """A sun tooth faces a space of each planet nominally; planets turn with their cranks, the sun stands."""
        level = self.sun_level
        ratio, carried = sun.teeth / planet.teeth, -places.phi / places.stage.profile.lobes
        sun_turned = carried - (places.phi - carried) / ratio
        yield PosedGear("sun", sun, Place(0j, sun_turned).pose(level))
        for number, crank in enumerate(places.cranks):
            arm = carried + 2 * math.pi * number / len(places.cranks)
            facing = arm + math.pi + math.pi / planet.teeth - ratio * (sun_turned - arm)
            turned = Place(crank.at, facing + crank.turned - places.phi)
            yield PosedGear(f"planet {number + 1}", planet, turned.pose(level))


def usual_shapes(
    stage: ContactStage,
    width: float | None = None,
    crank_hole: float | None = None,
    first: tuple[SpurGear, SpurGear] | None = None,
) -> StageShapes:
    """Shapes of a reducer of which only the acting surfaces are known; all else by the proportions above.

    Args:
        width: of a disc [mm].
        crank_hole: diameter of the discs' crank holes [mm].
        first: sun and planet.
    """
    profile, circle = stage.profile, stage.crank_circle
    width = WIDTH * profile.pin_circle_radius if width is None else width
    holes = _holes(stage, crank_hole)
    gap, flange = GAP * width, FLANGE * width
    length = stage.discs * width + (stage.discs - 1) * gap
    rim = profile.pin_circle_radius + (1 + RIM) * profile.pin_radius
    discs = (CycloidDisc(width, profile, holes, -throw / profile.lobes) for throw in stage.throws.tolist())
    return StageShapes(
        tuple(discs),
        PinRing(length, profile.pins, profile.pin_circle_radius, profile.pin_radius, _bore_radius(profile), rim),
        RingPin(profile.pin_radius, length),
        Crankshaft(tuple(_sections(stage, holes, width, first)), -length / 2 - gap - flange + RECESS * gap),
        Carrier(
            cranks=stage.cranks,
            circle_radius=circle,
            hole_diameter=SEAT * holes.crank_diameter,
            post_diameter=max(holes.window_diameter - 2 * (profile.eccentricity + POST_ROOM * circle), 0.0),
            bore_diameter=holes.bore_diameter,
            flange_diameter=2 * circle + holes.crank_diameter + 2 * WALL * circle,
            flange_width=flange,
            between=length + 2 * gap,
        ),
        first,
    )


def _sections(
    stage: ContactStage, holes: DiscHoles, width: float, first: tuple[SpurGear, SpurGear] | None
) -> Iterator[CrankSection]:
    """Sections of a crankshaft: journal, eccentrics with a piece of journal between, journal, seat of a planet."""
    gap, flange, own = GAP * width, FLANGE * width, stage.profile.eccentricity
    eccentric = max(ECCENTRIC * holes.crank_diameter, (holes.crank_diameter + 2 * own) / 2)
    journal = JOURNAL * (eccentric - 2 * own)
    recess = RECESS * gap
    yield CrankSection(journal, flange + gap - recess)
    for number, throw in enumerate(stage.throws.tolist()):
        if number:
            yield CrankSection(journal, gap)
        yield CrankSection(eccentric, width, own, throw)
    yield CrankSection(journal, flange + gap - (recess if first is None else 0.0))
    if first is not None:
        sun, planet = first
        yield CrankSection(journal, gap + max(sun.face_width - planet.face_width, 0.0) / 2)
        if planet.bore > 0.0:
            yield CrankSection(planet.bore, planet.face_width - recess)


def _bore_radius(profile: DiscProfile) -> float:
    """Bore radius of the ring between the pins [mm]: half of each pin is held, or as much as the lobes allow."""
    reach, circle = lobe_reach(profile), profile.pin_circle_radius
    if reach < circle - LOBE_ROOM * profile.pin_radius:
        return circle
    return (reach + circle + profile.pin_radius) / 2


def _holes(stage: ContactStage, crank_hole: float | None) -> DiscHoles:
    """Crank holes and windows as large as walls allow, and the bore that is left; no windows where no post passes."""
    circle, least = stage.crank_circle, 2 * stage.profile.eccentricity
    wall = max(WALL * circle, LEAST_WALL)
    outwards = 2 * (stage.profile.root_radius - wall - circle)
    beside = 2 * circle * math.sin(math.pi / (2 * stage.cranks)) - wall
    hole = min(outwards, beside, LARGEST_HOLE * circle) if crank_hole is None else crank_hole
    if hole <= least:  # no room for usual walls
        hole = (least + largest_hole(stage.profile, stage.cranks, circle)) / 2
    window = min(hole, 2 * beside - hole)
    posted = window - 2 * POST_ROOM * circle > least
    return DiscHoles(stage.cranks, circle, hole, window if posted else 0.0, max(2 * (circle - wall) - hole, 0.0))
