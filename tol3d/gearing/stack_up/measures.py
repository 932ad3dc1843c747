"""The analytic value of a backlash measure: the stack-up of its mesh, turned into the measure's quantity.

Transmission error to first order: rotating deviations, on the flanks that touch.

What shifts a flank along the line of action by s turns the driven gear by s over its arm r_b2. A centre that lies e off
its axis shifts the flanks of a driver by e sin(psi + alpha) on the drive side and e sin(psi - alpha) on the back side,
psi its azimuth from the line of centres in the driver's sense of rotation; those of a driven gear by e sin(psi - alpha)
and e sin(psi + alpha), psi in its own sense; alpha is the working pressure angle. With psi1 = phi1 + theta1 and psi2 =
phi2 + theta2, each gear's angle positive in its own sense, the drive side leads by

    TE_d = 1/r_b2 [e1 sin(psi1 + alpha) + e2 sin(psi2 - alpha)] less that at the first position.

Source: Wang, Zhou, Zou, Chinese J. Engineering 42(8), 2020, 1055-1064, equations 3 and 4. Here it is half of what a
deviation takes from the normal backlash (-2 e1 sin(alpha) cos(psi1) ...) and the shift of the middle of the play (e1
cos(alpha) sin(psi1) ...) of every effect that turns, of any pair; sin(psi) cos(alpha) + cos(psi) sin(alpha) is the sine
of the sum. What rests drops out: tooth thickness, centre distance, bearing clearance, tilt, temperature. They return
only in products with rotating deviations, and if base pitches differ, which is neglected here as in all stack-ups.
Single flanks that deviate add the offset of the pair that touches first, see tooth_pairs.py; so do the contact lines of
helical gears whose axes lean.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np

from tol3d.gearing.model import Backlash, Kind, LostMotion, Mesh, Model, Reading, TransmissionError
from tol3d.gearing.stack_up.cylindrical import HelicalStack, SpurStack
from tol3d.gearing.stack_up.stack import Stack
from tol3d.gearing.stack_up.term import Bound, Neglect, Role, Term
from tol3d.gears import BevelPair, GearPair, InternalPair, SpurPair
from tol3d.numerics.arrays import Array

Terms = tuple[Term, ...]


class BevelStack(Stack[BevelPair]):
    """The stack-up of a bevel pair in the middle of its face: of the imaginary spur pair of its back cones.

    Source: Jiang et al., J. Zhejiang Univ. (Eng. Sci.) 58(8), 2024, 1533-1542, section 3.1, for equal gears at 90 deg;
    here for any cones. Neglected: the position within a pitch (an axial or radial shift acts on the pairs of one mesh
    within ±10 % of that, and differs by that between the gear with the tooth and the one with the space), and
    the face: where contact or gap are read over the whole of it, they differ by several per cent.
    """

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
            Neglect("position within a pitch, which scales the effect of gear shifts", self._by_position),
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
        """Terms of shifts that take from one flank side and give to the other."""
        return (*self.sideways, *self._left_out("aside_by_turns"))


def stack_of(model: Model, mesh: Mesh, reading: Reading, at: Sequence[float] | None = None) -> Stack[GearPair]:
    """The stack-up of a mesh for one of its readings, at the driver's turns [rad] (positions,) or at any."""
    pair = mesh.pair
    if isinstance(pair, SpurPair | InternalPair) and pair.pinion.helix_angle:
        return HelicalStack(model, mesh, pair, reading, at)
    if isinstance(pair, SpurPair | InternalPair):
        return SpurStack(model, mesh, pair, reading)
    if isinstance(pair, BevelPair):
        return BevelStack(model, mesh, pair, reading)
    raise TypeError(f"analytic/ has no stack-up for {type(pair).__name__}")


def analytic_backlash(model: Model, kind: Backlash, deviations: Array, driver_angle: Array) -> Array:
    """Value of a backlash measure by the stack-up [mm, or rad for an angle], (rows,).

    j_wt = j_bn / (cos(alpha_w) cos(beta_b)); an angle is j_bn over the arm of the gear that turns. For the rest angle
    it is the middle between both rests, by which the driven gear's play lies aside.
    """
    stack = stack_of(model, model.mesh(kind.mesh), kind.reading)
    per = per_normal_backlash(model, kind)
    if kind.quantity == "rest_angle":
        return stack.aside(deviations, driver_angle) * per
    turns: Role | None = None
    if kind.quantity != "normal_backlash":
        turns = "driver" if kind.is_angle and kind.gear == stack.mesh.driver else "driven"
    return stack.normal_backlash(deviations, driver_angle, turns) * per


def per_normal_backlash(model: Model, kind: Backlash) -> float:
    """Factor from j_bn [mm] to the measure: 1, 1/(cos(alpha_w) cos(beta_b)) or one over the gear's arm [rad/mm]."""
    if kind.quantity == "normal_backlash":
        return 1.0
    if kind.quantity == "circumferential_backlash":
        pair = model.mesh(kind.mesh).pair
        return 1.0 / (math.cos(pair.working_pressure_angle) * pair.base_helix_cosine)
    return 1.0 / model.gear(kind.gear).gear.section_arm


def first_order(kind: Kind, free: Array) -> Array:
    """A measure's values (trials, positions) of what its backlashes leave free: a tip moves by L times the turn.

    Over a swing the tip errs where the other flanks work than at the start.
    """
    if not isinstance(kind, LostMotion) or kind.tip is None:
        return free
    displacement = kind.tip.lever * free
    return displacement * np.array(kind.turned, dtype=float) if kind.turned else displacement


def analytic_transmission_error(
    model: Model, kind: TransmissionError, deviations: Array, angles: Sequence[Array]
) -> Array:
    """Transmission error by the stack-up [rad], (trials, positions), 0 at the first of them.

    Args:
        model, kind: what is read.
        deviations: (trials, components) [mm, rad, K].
        angles: of the driver of each of its meshes (positions,) [rad], in their order.
    """
    total = np.zeros((len(deviations), len(angles[0])))
    for (factor, backlash), driver in zip(kind.backlashes, angles, strict=True):
        for columns, wave in _waves(model, backlash, driver):
            for column, own in zip(columns, wave, strict=True):
                total += np.multiply.outer(deviations[:, column], factor * (own - own[0]))
        mesh = model.mesh(backlash.mesh)
        stack, side = stack_of(model, mesh, backlash.reading), mesh.resting_flank(backlash.reading.flank)
        if stack.turning_teeth:
            turned = stack.turned_by_teeth(side, deviations, driver) * per_normal_backlash(model, backlash)
            total += factor * (turned - turned[:, :1])
    return total


def _waves(model: Model, backlash: Backlash, driver: Array) -> Iterator[tuple[range, Array]]:
    """Columns of rotating deviations, and the driven gear's turn about z per mm of each: (components, positions)."""
    mesh = model.mesh(backlash.mesh)
    stack = stack_of(model, mesh, backlash.reading)
    side = mesh.pair.mating_flank(mesh.resting_flank(backlash.reading.flank))
    per = per_normal_backlash(model, backlash)
    for contribution in stack.contributions:
        for term, share in ((contribution.aside, 1.0), (contribution.opening, -side / 2)):
            if term is not None and term.turns is not None:
                columns = model.component_slices[term.contributor.name]
                yield range(columns.start, columns.stop), share * per * _wave(term, stack, driver)


def _wave(term: Term, stack: Stack[GearPair], driver: Array) -> Array:
    """Effect of one mm along x and along y of a gear's frame [mm], (2, positions)."""
    turn = driver if term.turns == "driver" else stack.pair.driven_angle(driver)
    azimuth = term.along - term.sense * turn
    return term.coefficient * np.stack([np.cos(azimuth), np.sin(azimuth)])
