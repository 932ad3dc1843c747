"""What a backlash sees of contributors that move bores: each of their components, over its sigma."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.zones import ZoneDraw
from tol3d.system.contributor import Contributor
from tol3d.system.regressors import is_group, regress_plainly, regress_term
from tol3d.system.system import Columns

Array = NDArray[np.float64]


def regress_bores(
    contributors: Sequence[Contributor],
    columns: Columns,
    rows: Mapping[str, Array],
    squared: Mapping[str, NDArray[np.bool_]],
    slopes: Callable[[], Mapping[str, Array]],
) -> None:
    """Write contributors' rows (regressors, trials), see System.regress.

    Args:
        contributors: that move bores.
        columns: of the trials.
        rows: by contributor.
        squared: by contributor, which components displace bores to both sides of their mean alike.
        slopes: of the measure by each component of a contributor; asked for groups only.
    """
    for own in contributors:
        values = [np.asarray(columns[name], dtype=np.float64) * own.per_unit for name in own.columns]
        if is_group(own):
            mine = slopes()[own.name]
            term = sum((slope * value for slope, value in zip(mine, values, strict=True)), np.zeros(len(values[0])))
            regress_term(rows[own.name], term, own.draw.sigma * float(np.sqrt((mine * mine).sum())))
        elif isinstance(own.draw, ZoneDraw) and len(values) > 1:
            moments = zip(own.draw.mean_vector, own.draw.sigmas, squared[own.name], strict=True)
            for row, value, (mean, sigma, bent) in zip(rows[own.name], values, moments, strict=True):
                np.multiply(value - mean if bent else value, 1.0 / (sigma or 1.0), out=row)
                if bent:
                    np.square(row, out=row)
        else:
            regress_plainly(rows[own.name], own, values)
