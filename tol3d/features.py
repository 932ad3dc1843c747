"""What a measure sees of each contributor: the columns that shares of the variance are regressed on.

A turning offset matters by where it points at the mesh, so it is turned into the world at the trial's
position; over a whole turn only its length matters. Squares catch one-sided effects such as tilts.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from tol3d.block import Columns, position_column
from tol3d.model import Contributor, Measure, Model, Planar, TurningOffset

Array = NDArray[np.float64]

FEATURES_EACH = 2  # columns a contributor: value and square, or the two components of a vector


def feature_groups(model: Model) -> Mapping[str, slice]:
    """Which feature columns belong to each contributor."""
    return {
        contributor.name: slice(FEATURES_EACH * k, FEATURES_EACH * (k + 1))
        for k, contributor in enumerate(model.contributors)
    }


def features(model: Model, measure: Measure, columns: Columns) -> Array:
    """Feature columns of a block for one measure, (trials, 2 x contributors), scaled by each one's sigma."""
    mesh = model.mesh(measure.kind.mesh)
    driver = np.radians(np.asarray(columns[position_column(mesh)], dtype=np.float64))
    if measure.positions.over == "at":
        driver = np.full_like(driver, measure.positions.angle)
    turning = {mesh.driver: driver, mesh.driven: mesh.pair.driven_angle(driver)}
    one_position = measure.take == "value"
    pairs = [
        _features(contributor, _own(contributor, columns), turning, one_position=one_position)
        for contributor in model.contributors
    ]
    return np.concatenate(pairs, axis=1)


def _own(contributor: Contributor, columns: Columns) -> Array:
    per_unit = contributor.per_unit
    return np.stack([np.asarray(columns[name], dtype=np.float64) * per_unit for name in contributor.columns], axis=1)


def _features(contributor: Contributor, own: Array, turning: Mapping[str, Array], *, one_position: bool) -> Array:
    law, effect = contributor.distribution, contributor.effect
    spread = law.sigma or 1.0
    if not isinstance(contributor.draw, Planar):
        value = (own[:, 0] - law.mean) / spread
        return np.stack([value, value**2], axis=1)
    x, y = own[:, 0], own[:, 1]
    if not isinstance(effect, TurningOffset):
        return own / spread
    if not one_position or effect.part not in turning:
        length = (np.sqrt(x**2 + y**2) - law.mean) / spread
        return np.stack([length, length**2], axis=1)
    cos, sin = np.cos(turning[effect.part]), np.sin(turning[effect.part])
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=1) / spread
