"""The stack-up of a bevel pair, and what it leaves out.

The pair is replaced by the imaginary spur pair of its back cones, read in the middle of the face.
Source: Jiang et al., J. Zhejiang Univ. (Eng. Sci.) 58(8), 2024, 1533-1542, section 3.1, for equal gears at 90 deg;
here for any cones. Neglected: the position within a pitch (an axial or radial shift acts on the pairs of one mesh by
up to 10 % more or less, and differs by that between the gear with the tooth and the one with the space), and the
face: where contact or gap are read over the whole of it, they differ by several per cent.
"""

import math
from typing import Literal

from tol3d.gearing.stack_up.neglect import Bound, Neglect
from tol3d.gearing.stack_up.stack import Stack
from tol3d.gearing.stack_up.term import Term
from tol3d.gears import BevelPair

Terms = tuple[Term, ...]


class BevelStack(Stack[BevelPair]):
    """The stack-up of a bevel pair in the middle of its face."""

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
    def _by_offset(self) -> tuple[Bound, ...]:
        return (Bound(1.0, self._left_out("claimed")),)

    @property
    def _by_position(self) -> tuple[Bound, ...]:
        short = 1 - math.cos(self._furthest)
        return (
            Bound(2 * math.sin(self._furthest), self._left_out("along_line")),
            Bound(short, self._left_out("by_shifts")),
            Bound(short, self._aside_by_shifts),
        )

    @property
    def _by_face(self) -> tuple[Bound, ...]:
        """A turn's gap varies by half the face where the gap is read over it; a shift's contact by the ends' ratio."""
        inner, outer = self.pair.face
        gap = (outer - inner) / (outer + inner) if self.reading.gap == "face" else 0.0
        contact = (outer if self.reading.gap == "face" else self.pair.mean_cone_distance) / inner - 1
        shifts = contact if self.reading.contact == "face" else gap
        return (
            Bound(gap, self._left_out("by_turns")),
            Bound(shifts / 2, self._left_out("by_shifts")),
            Bound(shifts, self._aside_by_shifts),
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

    def _left_out(self, name: Literal["claimed", "along_line", "by_shifts", "by_turns", "aside_by_turns"]) -> Terms:
        """Terms of one kind, of all contributions."""
        terms = (getattr(contribution, name) for contribution in self.contributions)
        return tuple(term for term in terms if term is not None)

    @property
    def _aside_by_shifts(self) -> Terms:
        """What shifts take from one flank side and give to the other."""
        return (*self.sideways, *self._left_out("aside_by_turns"))
