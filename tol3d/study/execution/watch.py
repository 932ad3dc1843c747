"""Callbacks of a run while it goes on."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tol3d.study.execution.folding import Progress

Activity = Callable[[str], None]
Finisher = Callable[[Path, Mapping[str, Any]], None]


@dataclass(frozen=True)
class Watch:
    """Callbacks.

    Args:
        activity: callback for the current activity, in words.
        progress: callback for the number of trials finished since its last call.
        finisher: adds pictures to the folder before the run is put in its place.
    """

    activity: Activity = lambda text: None
    progress: Progress = lambda done: None
    finisher: Finisher = lambda folder, summary: None


UNWATCHED = Watch()
