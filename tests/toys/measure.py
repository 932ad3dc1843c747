"""A measure of a toy: a length in um."""

from dataclasses import dataclass

from tol3d.study.system.measure import Worse
from tol3d.study.system.pooled_statistic import PooledStatistic
from tol3d.study.system.positions import Positions, Take
from tol3d.study.system.spectrum import Spectrum


@dataclass(frozen=True)
class ToyMeasure:
    """Implements Measure."""

    name: str
    kind: str
    of: str
    positions: Positions
    take: Take = "value"
    lower_limit: float | None = None
    upper_limit: float | None = None
    worse: Worse = "low"
    adds_up: bool = True
    keeps_overlap: bool = False
    pooled_statistics: tuple[PooledStatistic, ...] = ()
    spectrum: Spectrum | None = None

    unit = "um"
    per_internal = 1e3
