"""Display sizes of shafts, arms and housings of links where the scene states none, chosen for a readable picture.

Nothing is measured on them.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache
from typing import Final

from tol3d.cad.solids import ArmBody, Collar, ShaftBody
from tol3d.gearing.model import Arm, Model, Shaft, StatedLink

PITCH_SHARE: Final = 0.3  # of the smallest pitch diameter on a shaft, where none of its gears has a bore
ARM_DIAMETER: Final = 40.0  # mm, at most
ARM_SHARE: Final = 1 / 12  # of the arm's length, at most
BARE_DIAMETER: Final = 20.0  # mm; of a shaft that carries nothing and follows nothing
BEHIND_APEX: Final = 0.1  # diameters that a shaft goes beyond a bevel gear towards its apex, where the mate's shaft is
HUB_ON_SHAFT: Final = 0.7  # of an arm's diameter on either side of the middle of its hub
DISC_DIAMETER: Final = 2.6  # of a reducer's housing, in diameters of its driven shaft
DISC_LENGTH: Final = 1.0
MOTOR_DIAMETER: Final = 2.0  # of a bare first shaft, which stands for the motor, in diameters of the next shaft
MOTOR_LENGTH: Final = 2.0
STUB_SHARE: Final = 0.7  # of the driven shaft's diameter, for any other bare shaft before a reducer
LEAST_COLLAR: Final = 0.01  # of its diameter; the length of a collar that is drawn
LEAST_GAP: Final = 0.1  # diameters between two shafts that a reducer's housing fills; a smaller one takes DISC_LENGTH

Span = tuple[float, float]


def arm_body(arm: Arm) -> ArmBody:
    """An arm with its diameter, or the one that it is given."""
    points = tuple(place for _, place in arm.points)
    hub = (0.0, 0.0, points[0][2])
    length = sum(math.dist(begin, end) for begin, end in zip((hub, *points), points, strict=False))
    chosen = min(ARM_DIAMETER, ARM_SHARE * length) or ARM_DIAMETER
    return ArmBody(points, arm.diameter or chosen)


class ShaftSizes:
    """Diameters and ends of shafts: as stated, or as what they carry needs, or as the reducers between them do."""

    def __init__(self, model: Model, faces: Mapping[str, Span]) -> None:
        self._model = model
        self._faces = faces
        self.shafts: Mapping[str, Shaft] = {shaft.name: _with_meshing(shaft, faces) for shaft in model.shafts}
        self.body = cache(self._body)

    def _body(self, name: str) -> ShaftBody:
        """A shaft's cylinder, in its own frame."""
        shaft = self._shaft(name)
        housed = (link for link in self._model.links if link.housed and link.coaxial)
        after = next((link for link in housed if link.driver == name), None)
        diameter = shaft.diameter or self._needed_diameter(shaft, after)
        start, end = self._span(shaft, diameter, after)
        return ShaftBody(diameter, start, end, tuple(self._collars(shaft, diameter, (start, end))))

    def _span(self, shaft: Shaft, diameter: float, after: StatedLink | None) -> Span:
        if shaft.start is not None and shaft.end is not None:
            return min(shaft.start, shaft.end), max(shaft.start, shaft.end)
        start, end = self._needed_span(shaft, diameter, after)
        if shaft.start is not None:
            return shaft.start, end if end > shaft.start else shaft.start + diameter
        if shaft.end is not None:
            return start if start < shaft.end else shaft.end - diameter, shaft.end
        return start, end

    def _collars(self, shaft: Shaft, diameter: float, span: Span) -> Iterator[Collar]:
        """Collars that fill the bores of gears wider than the shaft."""
        for carried in shaft.carries:
            bore = self._bore(carried.gear)
            low, high = sorted(carried.at + carried.sense * place for place in self._faces[carried.gear])
            low, high = max(low, span[0]), min(high, span[1])
            if bore > diameter and high - low > LEAST_COLLAR * bore:
                yield bore, low, high

    def _bore(self, gear: str) -> float:
        return self._model.gear(gear).gear.bore

    def _shaft(self, name: str) -> Shaft:
        """A shaft, or a part that is its own; one in no mesh carries nothing known here."""
        if name in self.shafts:
            return self.shafts[name]
        own = self._model.layout.carrying.get(name)
        return Shaft(name, () if own is None else (own[1],))

    def _needed_diameter(self, shaft: Shaft, after: StatedLink | None) -> float:
        gears = [self._model.gear(carried.gear).gear for carried in shaft.carries]
        bores = [bore for carried in shaft.carries if (bore := self._bore(carried.gear)) > 0.0]
        if bores:
            return bores[0]
        if gears:
            return PITCH_SHARE * 2 * min(gear.thickness_radius for gear in gears)
        arms = [arm_body(arm).diameter for arm in self._arms(shaft)]
        if arms:
            return max(arms)
        if after:
            motor = shaft.name not in self._model.layout.driving
            return (MOTOR_DIAMETER if motor else STUB_SHARE) * self.body(after.driven).diameter
        return BARE_DIAMETER

    def _needed_span(self, shaft: Shaft, diameter: float, after: StatedLink | None) -> Span:
        spans = [*self._gear_spans(shaft, diameter), *self._hub_spans(shaft)]
        if spans:
            return min(low for low, _ in spans), max(high for _, high in spans)
        if after is None:
            return -diameter / 2, diameter / 2
        # in this shaft's frame the driven one's origin lies at the offset
        housing = self.housing(after)
        motor = shaft.name not in self._model.layout.driving
        length = MOTOR_LENGTH * diameter / MOTOR_DIAMETER if motor else diameter
        if after.offset >= 0.0:
            return after.offset + housing.start - length, after.offset + housing.start
        return after.offset + housing.end, after.offset + housing.end + length

    def _gear_spans(self, shaft: Shaft, diameter: float) -> Iterator[Span]:
        for carried in shaft.carries:
            low, high = self._faces[carried.gear]
            before = BEHIND_APEX if self._model.gear(carried.gear).gear.pitch_angle else 1.0
            low, high = low - before * diameter, high + diameter
            yield (
                carried.at + min(carried.sense * low, carried.sense * high),
                carried.at + max(carried.sense * low, carried.sense * high),
            )

    def _hub_spans(self, shaft: Shaft) -> Iterator[Span]:
        for arm in self._arms(shaft):
            middle, half = arm.points[0][1][2], HUB_ON_SHAFT * arm_body(arm).diameter
            yield middle - half, middle + half

    def _arms(self, shaft: Shaft) -> list[Arm]:
        return [arm for arm in self._model.arms if arm.on == shaft.name]

    def housing(self, link: StatedLink) -> ShaftBody:
        """A link's housing, a disc between its shafts, in the frame of the driven one."""
        driven = self.body(link.driven)
        thickness = DISC_LENGTH * driven.diameter
        before = self._shaft(link.driver)
        stated = before.carries or self._arms(before) or None not in (before.start, before.end)
        towards = -1.0 if link.offset >= 0.0 else 1.0
        place = driven.start if towards < 0.0 else driven.end
        if stated:
            driver = self.body(link.driver)
            facing = (driver.end if towards < 0.0 else driver.start) - link.offset
            gap = towards * (facing - place)
            thickness = gap if gap > LEAST_GAP * driven.diameter else thickness
        ends = sorted((place, place + towards * thickness))
        return ShaftBody(DISC_DIAMETER * driven.diameter, ends[0], ends[1])


def _with_meshing(shaft: Shaft, faces: Mapping[str, Span]) -> Shaft:
    """A shaft with those of its gears that are in meshes; other presenters show the others."""
    return replace(shaft, carries=tuple(carried for carried in shaft.carries if carried.gear in faces))
