"""Study of a system: from seed to summary.json.

    system      the seam: what a study asks of a system, and all that it knows of one
    execution   workers, blocks and their order
    runs        a run on disk, and the contents of its summary.json
    trials      settings, draws, and both methods' values as columns
    effects     who acts, slopes, ends, regions, worst cases
    tallies     statistics, folded block by block
    results     tasks of workers, attribution, agreement of the methods, the summary

From low to high: none knows those below it in this list, and none knows a mechanism, a part or a solid. Read
`system/system.py` first, then `results/task.py`.
"""

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
