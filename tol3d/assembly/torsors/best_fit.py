"""Best fit: the pose of least squares, or of the least largest residual."""

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import BestFit, Fit
from tol3d.assembly.torsors.freedoms import Freedoms
from tol3d.assembly.torsors.minimax import Minimax
from tol3d.assembly.torsors.torsor import shift_at
from tol3d.assembly.torsors.world import World

Array = NDArray[np.float64]


def fitted(move: BestFit, world: World) -> Array:
    """The torsor (6, columns) of a part by best fit; the middle of its points stays where no residual sees it."""
    residuals = [_residual(fit, move, world) for fit in move.fits]
    points = [world.origin(fit.moving) for fit in move.fits]
    freedoms = Freedoms(world.assembly.part[move.part].pose[:3, 3], points, world.columns.count)
    if move.criterion == "squares":
        weights = [np.full(len(rows), fit.weight**0.5) for fit, (rows, _) in zip(move.fits, residuals, strict=True)]
        rows, values = (np.concatenate(each) for each in zip(*residuals, strict=True))
        weight = np.concatenate(weights)[:, None]
        freedoms.take(weight * rows, weight * values)
        freedoms.settle(np.mean(points, axis=0))
        return freedoms.rest()
    # as many numbers for each, those that no direction counts are 0
    rows = np.array([np.pad(rows, ((0, 3 - len(rows)), (0, 0))) for rows, _ in residuals]) @ freedoms.scale
    values = np.array([np.pad(values, ((0, 3 - len(values)), (0, 0))) for _, values in residuals])
    _, strengths, right = np.linalg.svd(rows.reshape(-1, 6))
    seen = right[strengths > 1e-8 * strengths[0]]
    found = world.columns.made_by(Minimax(values.reshape(-1, world.columns.count), rows @ seen.T))
    freedoms.take(seen @ np.linalg.inv(freedoms.scale), found)
    freedoms.settle(np.mean(points, axis=0))
    return freedoms.rest()


def _residual(fit: Fit, move: BestFit, world: World) -> tuple[Array, Array]:
    """Rows (directions, 6) and values (directions, columns): their difference is the residual, moving less target."""
    moving, target = world.origin(fit.moving), world.origin(fit.target)
    part = world.part_of(fit.target)
    directions = world.turned(fit.directions, part)
    at_moving, at_target = directions @ shift_at(moving), directions @ shift_at(target)
    other = at_moving @ world.parts[part] + at_target @ world.on_part(fit.target)
    gap = world.columns.constants(directions @ (moving - target))
    return at_moving, other - at_moving @ world.on_body(fit.moving, move.part) - gap
