"""What explains the difference of the two methods, as it is kept and shown."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from tol3d.runs.summary import agreement
from tol3d.runs.summary.values import made


@dataclass(frozen=True)
class LinearPart:
    """What a contributor adds to the difference, more than chance and a small share of its own effect.

    Args:
        contributor: its name.
        percent: of its own effect, the larger of both methods' [%].
        standard_errors: how sure that is.
        by: what explains it, "" where nothing does.
    """

    contributor: str
    percent: float
    standard_errors: float
    by: str


@dataclass(frozen=True)
class Explanation:
    """What explains a measure's difference, in its unit.

    Args:
        undecided: why that is not known, "" where it is.
        faults: what is not explained, a sentence each.
        linear: contributors whose linear part is beyond chance and 2 % of their own effect.
        largest_percent: the largest linear part of the other contributors, of their own effect [%].
        neglected: what the stack-up leaves out on purpose, and the rms of its largest effect.
        second_order_rms, second_order_mean: of what is of second order.
        second_order_of: contributors with the largest second differences, the largest first.
        left_rms: rms of what is neither linear nor of second order.
        mean_left: what of the mean difference is not of second order, and how much of it may be.
        mean_allowed: as said.
        largest_trial: the trial with the largest difference.
    """

    undecided: str = ""
    faults: tuple[str, ...] = ()
    linear: tuple[LinearPart, ...] = ()
    largest_percent: float = 0.0
    neglected: Mapping[str, float] = field(default_factory=dict)
    second_order_rms: float | None = None
    second_order_mean: float | None = None
    second_order_of: tuple[str, ...] = ()
    left_rms: float | None = None
    mean_left: float | None = None
    mean_allowed: float | None = None
    largest_trial: int | None = None

    def summary(self) -> agreement.Explanation:
        """As summary.json shows it."""
        linear = [
            made(
                agreement.LinearPart,
                contributor=part.contributor,
                percent=part.percent,
                standard_errors=part.standard_errors,
                by=part.by,
            )
            for part in self.linear
        ]
        return made(
            agreement.Explanation,
            undecided=self.undecided,
            faults=list(self.faults),
            linear=linear,
            largest_percent=self.largest_percent,
            neglected=self.neglected,
            second_order_rms=self.second_order_rms,
            second_order_mean=self.second_order_mean,
            second_order_of=list(self.second_order_of),
            left_rms=self.left_rms,
            mean_left=self.mean_left,
            mean_allowed=self.mean_allowed,
            largest_trial=self.largest_trial,
        )


def faults(explained: Mapping[str, Explanation]) -> Iterator[str]:
    """A warning for everything that is not explained."""
    for name, explanation in explained.items():
        for fault in explanation.faults:
            yield f"{name}: {fault}"
