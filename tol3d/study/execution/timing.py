"""Duration of a run, and the memory that it had."""

import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from tol3d.study.execution.folding import StudyOutcome

try:
    import resource
except ImportError:  # Windows has none
    resource = None  # type: ignore[assignment]


@dataclass
class Clock:
    """Seconds [s] since a run began, and when its trials, statistics and pictures began and ended."""

    began: float = field(default_factory=time.perf_counter)
    trials_began: float = 0.0
    trials_ended: float = 0.0
    findings_ended: float = 0.0
    slots: int = 1

    def start_trials(self) -> None:
        """Setup is over."""
        self.trials_began = time.perf_counter()

    def end_trials(self, slots: int) -> None:
        """All trials are made, by so many workers."""
        self.trials_ended, self.slots = time.perf_counter(), slots

    def end_findings(self) -> None:
        """The statistics are found; pictures follow."""
        self.findings_ended = time.perf_counter()

    def timing(self, outcome: StudyOutcome[Any]) -> Mapping[str, float | None]:
        """Timing in the form of summary.json.

        Args:
            outcome: of the trials.
        """
        simulate_s = self.trials_ended - self.trials_began
        return {
            "setup_s": round(self.trials_began - self.began, 4),
            "simulate_s": round(simulate_s, 4),
            "first_block_s": round(outcome.first_block_s, 4),
            "findings_s": round(self.findings_ended - self.trials_ended, 4),
            "pictures_s": 0.0,
            "trials_per_s": round((outcome.trials - outcome.resumed_trials) / simulate_s, 1),
            "resumed_trials": outcome.resumed_trials,
            "workers": self.slots,
            "peak_memory_mb": peak_memory_mb(),
        }

    def with_pictures(self, timing: Mapping[str, float | None]) -> Mapping[str, float | None]:
        """The same when pictures are drawn."""
        pictures_s = time.perf_counter() - self.findings_ended
        return {**timing, "pictures_s": round(pictures_s, 4), "peak_memory_mb": peak_memory_mb()}


def peak_memory_mb() -> float | None:
    """Largest resident size of this process so far [MB]; None where the system does not measure it."""
    if resource is None:
        return None
    per_mb = 1e6 if sys.platform == "darwin" else 1e3  # bytes there, kB elsewhere
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / per_mb, 1)
