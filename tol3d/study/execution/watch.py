"""Callbacks of a run in progress."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tol3d.study.execution.folding import Progress

Activity = Callable[[str], None]
"""Gets what a run is doing, in words."""
Finisher = Callable[[Path, Mapping[str, Any]], None]
"""Gets the run's folder and its summary."""


@dataclass(frozen=True)
class Watch:
    """Callbacks of a run; by default each does nothing.

    Args:
        activity: callback for the current activity, in words.
        progress: callback for the number of trials finished since its last call.
        finisher: callback that adds files, such as pictures, to the run's folder before it is put in its place; it gets
            the folder and the summary.
    """

    activity: Activity = lambda text: None
    progress: Progress = lambda done: None
    finisher: Finisher = lambda folder, summary: None


UNWATCHED = Watch()
"""No callbacks."""
