"""What a measure sees of each contributor: the columns that shares of the variance are regressed on.

A turning offset matters by where it points at the mesh, so it is turned into the world at the trial's
position; over a whole turn only its length matters. Squares catch one-sided effects such as tilts.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from tol3d.block import Columns, position_column
from tol3d.model import Contributor, Measure, Model, Planar, Positions, TurningOffset

Array = NDArray[np.float64]

FEATURES_EACH = 2  # columns a contributor: value and square, or the two components of a vector


def feature_groups(model: Model) -> Mapping[str, slice]:
    """Which feature columns belong to each contributor."""
    return {
        contributor.name: slice(FEATURES_EACH * k, FEATURES_EACH * (k + 1))
        for k, contributor in enumerate(model.contributors)
    }


def features(model: Model, measure: Measure, columns: Columns) -> Array:
    """Features of a block for one measure, a row each, (2 x contributors, trials), scaled by each one's sigma."""
    mesh = model.mesh(measure.kind.mesh)
    driver = np.radians(np.asarray(columns[position_column(mesh)], dtype=np.float64))
    if measure.positions.over == "at":
        driver = np.full_like(driver, measure.positions.angle)
    turning = _Turning({mesh.driver: driver, mesh.driven: mesh.pair.driven_angle(driver)})
    rows = np.empty((FEATURES_EACH * len(model.contributors), len(driver)))
    for contributor, own in zip(model.contributors, feature_groups(model).values(), strict=True):
        values = [np.asarray(columns[name], dtype=np.float64) * contributor.per_unit for name in contributor.columns]
        _fill(rows[own], contributor, values, turning if measure.take == "value" else _Turning({}))
    return rows


def feature_key(measure: Measure) -> tuple[str, Positions, bool]:
    """Measures of one key have the same features."""
    return measure.kind.mesh, measure.positions, measure.take == "value"


class _Turning:
    """Cosines and sines of gears' turns, each worked out once."""

    def __init__(self, angles: Mapping[str, Array]) -> None:
        self._angles = angles
        self._known: dict[str, tuple[Array, Array]] = {}

    def __contains__(self, part: str) -> bool:
        return part in self._angles

    def __getitem__(self, part: str) -> tuple[Array, Array]:
        if part not in self._known:
            self._known[part] = (np.cos(self._angles[part]), np.sin(self._angles[part]))
        return self._known[part]


def _fill(rows: Array, contributor: Contributor, values: Sequence[Array], turning: _Turning) -> None:
    """Write a contributor's two rows (2, trials) from the columns of its components."""
    law, effect = contributor.distribution, contributor.effect
    per_spread = 1.0 / (law.sigma or 1.0)
    if not isinstance(contributor.draw, Planar):
        np.multiply(values[0] - law.mean, per_spread, out=rows[0])
        np.square(rows[0], out=rows[1])
        return
    x, y = values
    if not isinstance(effect, TurningOffset):
        np.multiply(x, per_spread, out=rows[0])
        np.multiply(y, per_spread, out=rows[1])
    elif effect.part in turning:
        cos, sin = turning[effect.part]
        np.multiply(cos * x - sin * y, per_spread, out=rows[0])
        np.multiply(sin * x + cos * y, per_spread, out=rows[1])
    else:
        np.multiply(np.sqrt(x * x + y * y) - law.mean, per_spread, out=rows[0])
        np.square(rows[0], out=rows[1])
