"""Explanation of the difference of the two methods, as it is kept and shown."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from tol3d.study.runs.summary import agreement
from tol3d.study.runs.summary.values import made


@dataclass(frozen=True)
class LinearPart:
    """Contribution of a contributor to the difference, beyond chance and a small share of its own effect.

    Args:
        contributor: its name.
        percent: of its own effect, the larger of both methods' [%].
        standard_errors: its size in standard errors.
        by: its explanation, "" if there is none.
    """

    contributor: str
    percent: float
    standard_errors: float
    by: str


@dataclass(frozen=True)
class Explanation:
    """Explanation of a measure's difference, in its unit.

    Args:
        undecided: reason why it is unknown, "" if it is known.
        faults: unexplained differences, a sentence each.
        linear: contributors whose linear part is beyond chance and 2 % of their own effect.
        largest_percent: the largest linear part of the other contributors, of their own effect [%].
        neglected: effects that the stack-up leaves out on purpose, and the rms of its largest effect.
        second_order_rms, second_order_mean: of the second-order part.
        second_order_of: contributors with the largest second differences, the largest first.
        left_rms: rms of the part that is neither linear nor of second order.
        mean_left: part of the mean difference that is not of second order.
        mean_allowed: allowed size of that part.
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
        """Explanation in the form of summary.json."""
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
