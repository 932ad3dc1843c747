"""Study of a system: its settings, draws, tallies, stopping and findings."""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.study.trials.draws import drawn
    from tol3d.study.trials.overrides import AS_WRITTEN
    from tol3d.study.trials.simulation import Simulation

_HOMES = {
    "AS_WRITTEN": "tol3d.study.trials.overrides",
    "Simulation": "tol3d.study.trials.simulation",
    "drawn": "tol3d.study.trials.draws",
}

__all__ = [
    "AS_WRITTEN",
    "Simulation",
    "drawn",
]

__getattr__, __dir__ = lazy_names(__name__, _HOMES)
