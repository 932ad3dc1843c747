"""What the stack-up of a bevel pair has of its own: shaft angle and offset of the axes.

The pair is replaced by the imaginary spur pair of its back cones, read in the middle of the face.
Source: Jiang et al., J. Zhejiang Univ. (Eng. Sci.) 58(8), 2024, 1533-1542, section 3.1, for equal gears at 90 deg;
here for any cones. Neglected: the position within a pitch (an axial or radial shift acts on the pairs of one mesh by
up to 10 % more or less, and differs by that between the gear with the tooth and the one with the space), and the
face: where contact or gap are read over the whole of it, they differ by several per cent.
"""

import math
from collections.abc import Iterator

from tol3d.gearing.model import AxesOffset, AxisOffset, AxisTilt, Contributor, ToothThickness, TurningOffset
from tol3d.gearing.model.effects import Effect
from tol3d.gearing.stack_up.neglect import Neglect, Part
from tol3d.gearing.stack_up.stack import Stack
from tol3d.gearing.stack_up.term import Role, Term
from tol3d.gears import BevelPair


class BevelStack(Stack[BevelPair]):
    """The stack-up of a bevel pair in the middle of its face."""

    def tilt(self, effect: AxisTilt, contributor: Contributor, role: Role) -> Term | None:
        """Shaft angle: 2 R_m sin(alpha) about the apex.

        About a point of the gear's axis at the distance h from the apex 2 h sin(alpha) cos(delta) less, which is
        what the shift of the apex towards the mesh takes. A turn out of the plane of the axes changes nothing.
        """
        lever = self.pair.mean_cone_distance - effect.pivot * math.cos(self.gear(role).pitch_angle)
        _, y = self.turns_of(effect, contributor, role)
        per_turn = -2 * self.sin * lever
        if len(y) == 1:
            return Term(contributor, per_turn * float(y[0]))
        return Term(contributor, per_turn * math.hypot(*y), along=math.atan2(y[1], y[0]))

    def axes_offset(self, contributor: Contributor, role: Role) -> Term | None:
        """2 sin(alpha) sin(delta) of the driven gear, as the source has it for its "axial distance".

        That is what a shift along the axis does. Of an offset across both axes the geometry sees nothing in the
        middle of the face, to first order: the 3D simulation tells.
        """
        return Term(contributor, 2 * self.sin * math.sin(self.gear(role).pitch_angle))

    # what it leaves out -----------------------------------------------------------------------------

    @property
    def neglects(self) -> tuple[Neglect, ...]:
        """Offset of the axes, the position within a pitch, and, where the whole face is read, the face.

        A pair that touches at the angle s from the pitch line in the plane of action has the normal
        n(s) = cos s p - sin s e there, e the pitch line and p the normal at it: of a shift D of one apex against the
        other n(s).D counts, on each flank side, where the stack-up has p.D. A turn about the apex takes the same at
        any s. On the face what turns gears grows with the distance from the apex, what shifts them does not; where
        either decides which end of the face counts they differ by the face's length over that distance.
        """
        found = [
            Neglect("offset of the axes, which by its source opens the mesh", self._by_offset),
            Neglect("position within a pitch, where shifts of the gears count more or less", self._by_position),
        ]
        if "face" in (self.reading.contact, self.reading.gap):
            found.append(Neglect("reading over the face instead of in its middle", self._by_face))
        return tuple(neglect for neglect in found if any(part.terms for part in neglect.parts))

    @property
    def _by_offset(self) -> tuple[Part, ...]:
        found = (self._term(effect, c) for _, effect, c in self._acting() if isinstance(effect, AxesOffset))
        return (Part(1.0, tuple(term for term in found if term)),)

    @property
    def _by_position(self) -> tuple[Part, ...]:
        along = tuple(term for role, effect, c in self._acting() if (term := self._along_line(role, effect, c)))
        short = 1 - math.cos(self._furthest)
        return (
            Part(2 * math.sin(self._furthest), along),
            Part(short, self._opened_by_shifts),
            Part(short, self._aside_by_shifts),
        )

    @property
    def _by_face(self) -> tuple[Part, ...]:
        """A turn's gap varies by half the face where the gap is read over it; a shift's contact by the ends' ratio."""
        inner, outer = self.pair.face
        gap = (outer - inner) / (outer + inner) if self.reading.gap == "face" else 0.0
        contact = (outer if self.reading.gap == "face" else self.pair.mean_cone_distance) / inner - 1
        shifts = contact if self.reading.contact == "face" else gap
        return (
            Part(gap, self._opened_by_turns),
            Part(shifts / 2, self._opened_by_shifts),
            Part(shifts, self._aside_by_shifts),
        )

    @property
    def _furthest(self) -> float:
        """Largest angle [rad] in the plane of action from the pitch line to a contact.

        All teeth: the ends of the path of contact. One tooth: its middle stands up to half a pitch from the line of
        centres, its flank half a thickness further.
        """
        pair, gear = self.pair, self.pair.wheel if self.reading.teeth == "driven" else self.pair.pinion
        if self.reading.teeth == "all":
            return max(pair.pinion.tip_q - pair.pinion.pitch_q, pair.pinion.pitch_q - pair.start_q)
        return math.sin(gear.base_angle) * (gear.pitch_half_angle + gear.angular_pitch / 2)

    def _acting(self) -> Iterator[tuple[Role, Effect, Contributor]]:
        """The effects in this mesh, and of which gear."""
        for contributor in self.model.contributors:
            for effect in contributor.effect.singles:
                role: Role | None = None
                if isinstance(effect, ToothThickness | TurningOffset):
                    role = self.role(effect.part)
                elif isinstance(effect, AxisOffset | AxisTilt | AxesOffset):
                    role = self.role(effect.part, effect.mesh)
                if role is not None:
                    yield role, effect, contributor

    def _along_line(self, role: Role, effect: Effect, contributor: Contributor) -> Term | None:
        """Way of one apex against the other along the pitch line.

        sin(delta) of a shift across a gear's axis towards the mesh, cos(delta) of one along it; the driver's, and
        against it the driven gear's.
        """
        sense, delta = (1.0 if role == "driver" else -1.0), self.gear(role).pitch_angle
        if isinstance(effect, AxisTilt):
            return self._turned(effect, contributor, role, -sense * math.sin(delta) * effect.pivot, 0.0)
        if not isinstance(effect, TurningOffset | AxisOffset) or (own := self._term(effect, contributor)) is None:
            return None
        if not isinstance(effect, AxisOffset) or len(contributor.draw.components) == 2:
            return own.times(-sense * math.sin(delta) / self._across(role))
        lengthwise = effect.factor * effect.direction[2]
        leaving = (own.coefficient - 2 * self.sin * math.sin(delta) * lengthwise) / self._across(role)
        return Term(contributor, sense * (math.cos(delta) * lengthwise - math.sin(delta) * leaving))

    @property
    def _opened_by_shifts(self) -> tuple[Term, ...]:
        """What shifts and offsets of flanks open, alike on the whole face."""
        terms: list[Term | None] = []
        for role, effect, contributor in self._acting():
            if isinstance(effect, TurningOffset | AxisOffset):
                terms.append(self._term(effect, contributor))
            elif isinstance(effect, ToothThickness):
                terms.append(Term(contributor, -2 * effect.offset))
            elif isinstance(effect, AxisTilt):
                terms.append(self._turned(effect, contributor, role, self._across(role) * effect.pivot, 0.0))
        return tuple(term for term in terms if term)

    @property
    def _opened_by_turns(self) -> tuple[Term, ...]:
        """What turns open in the middle of the face."""
        terms: list[Term] = []
        for role, effect, contributor in self._acting():
            if isinstance(effect, ToothThickness):
                terms.append(Term(contributor, -2 * effect.turn * self.gear(role).section_arm))
            elif isinstance(effect, AxisTilt):
                per_turn = -2 * self.sin * self.pair.mean_cone_distance
                terms.append(self._turned(effect, contributor, role, per_turn, 0.0))
        return tuple(terms)

    @property
    def _aside_by_shifts(self) -> tuple[Term, ...]:
        """What shifts take from one flank side and give to the other."""
        terms = list(self.sideways)
        for role, effect, contributor in self._acting():
            if isinstance(effect, AxisTilt):
                terms.append(self._turned(effect, contributor, role, 0.0, self.cos * effect.pivot))
        return tuple(terms)

    def _turned(self, effect: AxisTilt, contributor: Contributor, role: Role, per_y: float, per_x: float) -> Term:
        """A change by the turn of a gear's axis, per turn about y and about x of its frame at rest in the mesh."""
        x, y = self.turns_of(effect, contributor, role)
        per = per_x * x + per_y * y
        if len(per) == 1:
            return Term(contributor, float(per[0]))
        return Term(contributor, math.hypot(*per), along=math.atan2(per[1], per[0]))
