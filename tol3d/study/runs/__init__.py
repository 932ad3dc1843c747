"""A run on disk: its blocks of trials, summary, storage, and the conditions for replacing it."""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.study.runs.atomic_write import made_folder, write_by, write_texts, write_whole
    from tol3d.study.runs.summary.measure import MeasureSummary
    from tol3d.study.runs.summary.sample import Sample
    from tol3d.study.runs.summary.shows import Computed, Shows

_HOMES = {
    "Computed": "tol3d.study.runs.summary.shows",
    "MeasureSummary": "tol3d.study.runs.summary.measure",
    "Sample": "tol3d.study.runs.summary.sample",
    "Shows": "tol3d.study.runs.summary.shows",
    "made_folder": "tol3d.study.runs.atomic_write",
    "write_by": "tol3d.study.runs.atomic_write",
    "write_texts": "tol3d.study.runs.atomic_write",
    "write_whole": "tol3d.study.runs.atomic_write",
}

__all__ = [
    "Computed",
    "MeasureSummary",
    "Sample",
    "Shows",
    "made_folder",
    "write_by",
    "write_texts",
    "write_whole",
]

__getattr__, __dir__ = lazy_names(__name__, _HOMES)
