"""Transmission error to first order: rotating deviations, on the flanks that touch.

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
Single flanks that deviate add the offset of the pair that touches first, see tooth_pairs.py.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from tol3d.gearing.model import Backlash, Model, TransmissionError
from tol3d.gearing.stack_up.backlash import per_normal_backlash, stack_of
from tol3d.gearing.stack_up.stack import Stack
from tol3d.gearing.stack_up.term import Term
from tol3d.gearing.stack_up.tooth_pairs import teeth_deviate
from tol3d.gears import GearPair
from tol3d.numerics.arrays import Array


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
        if teeth_deviate(model, model.mesh(backlash.mesh)):
            turned = _turned_by_teeth(model, backlash, deviations, driver)
            total += factor * (turned - turned[:, :1])
    return total


def _turned_by_teeth(model: Model, backlash: Backlash, deviations: Array, driver: Array) -> Array:
    """Turn of the driven gear about its z [rad], (trials, positions), by single flanks that deviate."""
    mesh = model.mesh(backlash.mesh)
    stack, side = stack_of(model, mesh, backlash.reading), mesh.resting_flank(backlash.reading.flank)
    return stack.turned_by_teeth(side, deviations, driver) * per_normal_backlash(model, backlash)


def _waves(model: Model, backlash: Backlash, driver: Array) -> Iterator[tuple[range, Array]]:
    """Columns of rotating deviations, and the driven gear's turn about z per mm of each: (components, positions)."""
    mesh = model.mesh(backlash.mesh)
    stack = stack_of(model, mesh, backlash.reading)
    side = mesh.pair.mating_flank(mesh.resting_flank(backlash.reading.flank))
    per = per_normal_backlash(model, backlash)
    for own in stack.contributions:
        for term, share in ((own.aside, 1.0), (own.opening, -side / 2)):
            if term is not None and term.turns is not None:
                columns = model.component_slices[term.contributor.name]
                yield range(columns.start, columns.stop), share * per * _wave(term, stack, driver)


def _wave(term: Term, stack: Stack[GearPair], driver: Array) -> Array:
    """Effect of one mm along x and along y of a gear's frame [mm], (2, positions)."""
    turn = driver if term.turns == "driver" else stack.pair.driven_angle(driver)
    azimuth = term.along - term.sense * turn
    return term.coefficient * np.stack([np.cos(azimuth), np.sin(azimuth)])
