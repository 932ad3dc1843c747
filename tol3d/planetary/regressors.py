"""What a measure of a set sees of contributors: each component, offsets of gears as they lie seen from the carrier."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from tol3d.planetary.free import turned
from tol3d.planetary.measure import PlanetaryMeasure
from tol3d.planetary.set_trials import SetTrials
from tol3d.system.contributor import Contributor
from tol3d.system.regressors import is_group, regress_plainly, regress_term
from tol3d.system.system import Columns

Array = NDArray[np.float64]


def regress(
    system: SetTrials,
    measure: PlanetaryMeasure,
    contributors: Sequence[Contributor],
    columns: Columns,
    rows: Mapping[str, Array],
) -> None:
    """Write contributors' rows (regressors, trials), see System.regress."""
    for own in contributors:
        values = [np.asarray(columns[name], dtype=np.float64) * own.per_unit for name in own.columns]
        if system.acts[own.name].effect == "offset" and measure.positions.over == "random":
            values = _seen(system, system.acts[own.name].gear, values, columns)
        if is_group(own):
            slopes = system.slopes(measure, own)
            term = sum((slope * value for slope, value in zip(slopes, values, strict=True)), np.zeros(len(values[0])))
            mean = sum(
                slope * own
                for slope, own in zip(slopes, own.draw.mean(turning=_turns(system, own, measure)), strict=True)
            )
            regress_term(rows[own.name], term - mean, own.draw.sigma * float(np.sqrt((slopes * slopes).sum())))
        else:
            regress_plainly(rows[own.name], own, values)


def _turns(system: SetTrials, contributor: Contributor, measure: PlanetaryMeasure) -> bool:
    return system.turns_at_random(contributor, measure.positions)


def _seen(system: SetTrials, gear: str, values: Sequence[Array], columns: Columns) -> list[Array]:
    """Components x and y, one after the other, of offsets turned with their gear against the carrier."""
    own = system.own
    mesh = next((mesh for mesh in own.teeth.meshes if mesh.central == gear), None)
    rate = float((mesh.turn if mesh else 1) * own.planet_turns)
    turns = rate * np.asarray(columns[system.position_column], dtype=np.float64) / 360.0
    found: list[Array] = []
    for x, y in zip(values[::2], values[1::2], strict=True):
        both = turned(np.stack([x, y], axis=-1), turns)
        found += [both[:, 0], both[:, 1]]
    return found
