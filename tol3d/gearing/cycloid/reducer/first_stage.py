"""The first stage of an RV reducer: turns of planets on a standing sun, and so of their cranks.

Discs hold the throws of all cranks parallel, so that they turn together as far as the first planet lets them: load
paths in parallel, of which one carries. A phase of a crank is a turn of its planet. Both methods find the turn beyond
where teeth without backlash would have the planets, counted counter-clockwise. Meshes are looked at in frames that turn
with the carrier, the sun at the origin, the planet on x.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tol3d.gearing.cycloid.exact.mesh_kernel import MeshShape, planet_turns
from tol3d.gearing.cycloid.model.stage import Deviated
from tol3d.gearing.cycloid.reducer.deviated import RVDeviated
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gears import LEFT, RIGHT, Flank
from tol3d.numerics.arrays import Array, Complex, Places
from tol3d.numerics.plane import as_complex, as_points

OneMesh = Callable[[RVSet, RVDeviated, Array, int, Flank], Array]


def crank_turns(
    rv_set: RVSet, deviated: RVDeviated, turns: Array, sense: float, one_mesh: OneMesh
) -> tuple[Array, Places]:
    """Turn of the throws beyond their place (trials, positions) [rad], and the planet that stops them.

    Args:
        turns: of the output (trials, positions) or (1, positions).
        sense: of the carrier's turn; cranks turn the other way.
    """
    shape = len(deviated.sun_thickness), turns.shape[1]
    if rv_set.first is None:
        return np.zeros(shape), np.zeros(shape, dtype=np.int64)
    flank = LEFT if sense < 0 else RIGHT
    found = np.stack([throw_turn(rv_set, deviated, turns, crank, flank, one_mesh) for crank in range(rv_set.cranks)])
    first = found.argmin(axis=0) if sense < 0 else found.argmax(axis=0)
    return np.take_along_axis(found, first[None], axis=0)[0], first


def throw_turn(rv_set: RVSet, deviated: RVDeviated, turns: Array, crank: int, flank: Flank, one_mesh: OneMesh) -> Array:
    """Turn of one crank's throws (trials, positions) [rad]: its planet's, which they lead by their phase."""
    return one_mesh(rv_set, deviated, turns, crank, flank) + deviated.stage.crank_phases[:, crank, None]


def held_stage(rv_set: RVSet, deviated: RVDeviated) -> Deviated:
    """The cycloid stage, its throws parallel where discs hold them so; cranks that are the input keep their phases."""
    stage = deviated.stage
    return stage if rv_set.first is None else replace(stage, crank_phases=np.zeros_like(stage.crank_phases))


def placed_mesh(
    rv_set: RVSet, deviated: RVDeviated, turns: Array, crank: int, flank: Flank, carried: float | Array = 0.0
) -> Array:
    """Turn of one planet (trials, positions) [rad] until its flank touches the sun's, gears as they lie.

    Args:
        own, deviated, turns, crank, flank: see OneMesh.
        carried: turn of the carrier beyond its place while the sun stands (trials, positions) [rad]. 100 arc
            seconds turn an eccentricity of 10 um by 5 nm.
    """
    pair, sizes = rv_set.pair, (len(deviated.sun_thickness), turns.shape[1])
    sun, planet = angles(rv_set, turns, crank)
    thicker = deviated.sun_thickness + deviated.planet_thickness[:, crank]
    found = np.empty(sizes)
    planet_turns(
        MeshShape(
            distance=pair.centre_distance,
            base_radii=pair.base_radii,
            wheel_base_radius=pair.wheel.base_radius,
            tan=math.tan(pair.working_pressure_angle),
            ratio=pair.ratio,
            flank=float(flank),
        ),
        *(
            np.require(each, dtype=np.float64, requirements=["C", "W"])
            for each in (
                as_points(np.exp(1j * sun)), as_points(np.exp(1j * planet)), deviated.sun_offset,
                deviated.planet_offset[:, crank], as_points(_carried(rv_set, deviated, crank)),
                thicker * math.cos(pair.pinion.pressure_angle) / 2 - pair.normal_backlash / 2,
                np.broadcast_to(carried, sizes),
            )
        ),
        found,
    )  # fmt: skip
    return found


def first_order_mesh(rv_set: RVSet, deviated: RVDeviated, turns: Array, crank: int, flank: Flank) -> Array:
    """The same to first order.

    Along the line of action, with alpha the working pressure angle and sigma the flank,

    r_b2 beta = cos(alpha) d_t + sigma ((E1 + E2) cos(alpha_0)/2 - sin(alpha) d_r - j_bn/2),

    of a planet displaced against its sun by d_r outwards and d_t counter-clockwise, of thicker teeth and of the nominal
    backlash.
    """
    sun, planet = angles(rv_set, turns, crank)
    pair = rv_set.pair
    alpha = pair.working_pressure_angle
    apart = _carried(rv_set, deviated, crank)[:, None] + as_complex(deviated.planet_offset[:, crank])[:, None] * np.exp(
        1j * planet
    )
    apart = apart - as_complex(deviated.sun_offset)[:, None] * np.exp(1j * sun)
    thicker = (deviated.sun_thickness + deviated.planet_thickness[:, crank])[:, None]
    closing = thicker * math.cos(pair.pinion.pressure_angle) / 2 - math.sin(alpha) * apart.real
    closing = closing - pair.normal_backlash / 2
    return np.asarray((math.cos(alpha) * apart.imag + flank * closing) / pair.wheel.base_radius)


def add_rates(
    rv_set: RVSet, rates: RVDeviated, turns: Array, planets: Places, flank: Flank, factor: float | Array
) -> None:
    """Add the derivatives of the first planet's turn by each deviation, times a factor.

    Args:
        rates: of the trials; written.
        turns: of the output (trials,).
        planets: which planet stops the cranks (trials,).
        flank: of the sun.
        factor: of a turn of the cranks, one or by trial.
    """
    if rv_set.first is None:
        return
    pair = rv_set.pair
    rows, alpha, arm = np.arange(len(turns)), pair.working_pressure_angle, pair.wheel.base_radius
    push = factor / arm * complex(-flank * math.sin(alpha), math.cos(alpha))
    thicker = factor / arm * flank * math.cos(pair.pinion.pressure_angle) / 2
    relative = rv_set.azimuths[planets]
    sun = _sun_angle(rv_set, turns) - relative
    planet = pair.driven_angle(sun)
    carried = as_points(push * np.exp(1j * relative))
    rates.sun_offset[...] += as_points(-push * np.exp(-1j * sun))
    rates.planet_offset[rows, planets] += as_points(push * np.exp(-1j * planet))
    rates.sun_thickness[...] += thicker
    rates.planet_thickness[rows, planets] += thicker
    rates.stage.crank_phases[rows, planets] += factor
    rates.stage.carrier_holes[rows, planets] += carried
    rates.stage.carrier_offsets[...] += carried


def angles(rv_set: RVSet, turns: Array, crank: int) -> tuple[Array, Array]:
    """Turns of sun and planet in the frame of their mesh [rad], at turns of the output."""
    sun = _sun_angle(rv_set, turns) - rv_set.azimuths[crank]
    return sun, rv_set.pair.driven_angle(sun)


def _sun_angle(rv_set: RVSet, turns: Array) -> Array:
    """Angle of the sun against the carrier [rad], less whole turns after which the planets stand as before."""
    return np.asarray(
        2 * math.pi * np.mod(float(rv_set.gear_ratio * rv_set.profile.pins) * turns, rv_set.gear_ratio.numerator)
    )


def _carried(rv_set: RVSet, deviated: RVDeviated, crank: int) -> Complex:
    """Offset of a crank's axis from its place (trials,) in the frame of its mesh [mm]."""
    off = as_complex(deviated.stage.carrier_offsets) + as_complex(deviated.stage.carrier_holes[:, crank])
    return np.asarray(off * np.exp(-1j * rv_set.azimuths[crank]))
