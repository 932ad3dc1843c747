"""The turn of the motor that makes good for the mean lost motion of a train, and the sum of highs that it leaves.

Angles are in minutes of arc, as in columns and in summary.json.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from tol3d.apps.adjustment.robots import Robots
from tol3d.gearing import AnyStage, Ends, TrainPlay


@dataclass(frozen=True)
class Correction:
    """The motor's correction by one column: a method, the closed form or a publication; None for missing values.

    Args:
        means: each compensated link's own lost motion, at its driven shaft [arcmin].
        motor: turn of the motor that makes good for them together [arcmin].
        before: sum of all stages' highs at the shaft that is read [arcmin].
        left: sum of the excess of their highs over their means, and of the uncompensated highs [arcmin].
        left_of: excess of each compensated link's own high over its mean, at its driven shaft [arcmin].
    """

    means: Mapping[str, float | None]
    motor: float | None
    before: float | None
    left: float | None
    left_of: Mapping[str, float | None]


def corrections_of(
    play: TrainPlay, compensated: Sequence[AnyStage], robots: Robots
) -> Iterator[tuple[str, Correction]]:
    """Corrections by the closed form, by each method, and by every publication of all meshes of the train."""
    for column, ends in play.ends(robots.played):
        yield column, _correction(play, compensated, ends)


def _correction(play: TrainPlay, compensated: Sequence[AnyStage], ends: Mapping[str, Ends]) -> Correction:
    means = {stage.link: ends[stage.link].mean for stage in compensated}
    turns = {stage.link: play.motor_turns(stage) for stage in compensated}
    highs = [(stage.factor, ends[stage.link].high_3sigma) for stage in play.stages]
    kept = [(stage.factor, 0.0 if stage not in compensated else means[stage.link]) for stage in play.stages]
    before, known = _total(highs), _total(kept)
    return Correction(
        means=means,
        motor=_total([(turns[link], mean) for link, mean in means.items()]),
        before=before,
        left=None if before is None or known is None else before - known,
        left_of={link: _total([(1.0, ends[link].high_3sigma), (-1.0, mean)]) for link, mean in means.items()},
    )


def _total(parts: Sequence[tuple[float, float | None]]) -> float | None:
    """The sum of factor times value; None where a value is missing."""
    known = [factor * value for factor, value in parts if value is not None]
    return sum(known) if len(known) == len(parts) else None


def at_shaft(compensated: Sequence[AnyStage], correction: Correction) -> float:
    """Turn of the output shaft due to the motor's correction [arcmin]."""
    return _total([(stage.factor, correction.means[stage.link]) for stage in compensated]) or 0.0
