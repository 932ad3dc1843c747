"""Seats of a frame's datums on their simulators: the part's actual features on nominal ones."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from tol3d.assembly.model import Datum, DatumFrame, Part
from tol3d.assembly.model.feature import Asks
from tol3d.assembly.placing.actual_feature import ActualFeature, actual, nominally, total
from tol3d.assembly.placing.alignment import Alignment, Seat, Tie
from tol3d.assembly.placing.freedoms import aligned
from tol3d.assembly.placing.poses import IDENTITY, Codes, Pose, dot, repeated, unit
from tol3d.assembly.placing.seen_motions import Pattern, pattern
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

ABREAST = 1e-6
"""Spread of points across a line [mm] below which they lie on it, and distance below which two are one."""

Actual = Callable[[str], ActualFeature]


class OnGauges(Protocol):
    """Placement of a part on gauges of virtual condition."""

    def placed(self, seats: Sequence[Seat], features: Actual, columns: Array) -> tuple[Pose, Codes]:
        """See GaugedFrame."""
        ...


@dataclass(frozen=True, eq=False)
class DatumSeats:
    """A datum frame by its seats: the part's features are aligned with the simulators; the frame is the inverse.

    Args:
        frame: the datum frame.
        alignment: of the ties, in order of precedence.
        nominal: nominal features of the part by name, as simulators.
        datums: index of each tie's datum.
        patterns: the datums that are patterns, by index.
        gauged: the gauges on which the part lies, if any.
    """

    frame: DatumFrame
    alignment: Alignment
    nominal: Mapping[str, ActualFeature]
    datums: tuple[int, ...]
    patterns: Mapping[int, Pattern]
    gauged: OnGauges | None = None

    def pose(self, features: Actual, columns: Array) -> tuple[Pose, Codes]:
        """Pose of the part in the frame, and status codes (n,) or (1,).

        Args:
            features: the part's actual features, by name.
            columns: the deviations, (width, n) [mm].
        """
        seats, gauges = self.of(features), self.frame.gauges
        if self.gauged is None or gauges is None or gauges.floating is None:
            return self.alignment.poses(seats, IDENTITY)
        return self.gauged.placed(seats, features, columns)

    def of(self, features: Actual) -> list[Seat]:
        """Seats of its ties for the actual features."""
        return [seat for _, _, seat in _tied(self.frame, features, self.nominal, self.patterns)]


def datum_seats(part: Part) -> dict[str, DatumSeats]:
    """Seats of all datum frames of a part, by name.

    Raises:
        InputError: a datum takes no freedom, targets or centres do not determine it, or it cannot be met at its
            precedence.
    """
    nominal = {feature.name: nominally(feature) for feature in part.features}
    return {frame.name: _seats_of(frame, nominal) for frame in part.datum_frames}


def _seats_of(frame: DatumFrame, nominal: Mapping[str, ActualFeature]) -> DatumSeats:
    _refuse_few_targets(frame)
    _refuse_scattered(frame, nominal)
    patterns = _patterns(frame, nominal)
    datums, ties, seats = zip(*_tied(frame, nominal.__getitem__, nominal, patterns), strict=True)
    alignment = aligned(ties, seats, IDENTITY)
    taking = {datums[tie] for tie in range(len(ties)) if tie not in alignment.idle}
    for k, datum in enumerate(frame.datums):
        if k not in taking:
            _refuse_idle(frame, datum)
    return DatumSeats(frame, alignment, nominal, tuple(datums), patterns)


def _refuse_idle(frame: DatumFrame, datum: Datum) -> None:
    """Refuse a datum that takes no freedom, unless it only reduces the play on the gauges."""
    if datum not in frame.later:
        raise InputError(
            f"{_name(frame, datum)} takes no freedom: datums before it hold all that it could take; leave it out"
        )


def _refuse_few_targets(frame: DatumFrame) -> None:
    """Refuse targets of a primary plane that lie on a line."""
    primary = frame.datums[0]
    if primary.simulator != "targets" or primary.targets is None:
        return
    spread = np.linalg.svd(primary.targets - primary.targets.mean(axis=0), compute_uv=False)
    if len(spread) < 2 or spread[1] < ABREAST:
        raise InputError(
            f"datum frame {frame.name}: targets of its primary datum {primary.features[0]} lie on a line: expected "
            "three or more that do not"
        )


def _refuse_scattered(frame: DatumFrame, nominal: Mapping[str, ActualFeature]) -> None:
    """Refuse a common datum whose nominal centres lie off a line, or two of them in one place."""
    for datum in frame.datums:
        if len(datum.features) < 2 or datum.simulator == "pattern":
            continue
        places = np.concatenate([nominal[name].origin.reshape(3, -1)[:, :1] for name in datum.features], axis=1).T
        name = "-".join(feature.partition(".")[2] for feature in datum.features)
        _, spread, directions = np.linalg.svd(places - places.mean(axis=0), full_matrices=False)
        if len(places) > 2 and spread[1] > ABREAST:
            raise InputError(
                f"datum frame {frame.name}: the centres of the common datum {name} lie off a line nominally, by "
                f"{spread[1]:.3g} mm: expected them on one; beside each other they are a pattern, write {{feature: "
                f"{name}, simulator: pattern}}"
            )
        along = np.sort(places @ directions[0])
        if np.diff(along).min() < ABREAST:
            raise InputError(
                f"datum frame {frame.name}: two features of the common datum {name} have one centre: name one"
            )


def _tied(
    frame: DatumFrame, features: Actual, nominal: Mapping[str, ActualFeature], patterns: Mapping[int, Pattern]
) -> Iterator[tuple[int, Tie, Seat]]:
    """Index of the datum, constraint and seat of each tie, in order of precedence."""
    seats: list[Seat] = []
    for k, datum in enumerate(frame.datums):
        actuals = [features(name) for name in datum.features]
        simulators = [nominal[name] for name in datum.features]
        asks: Iterable[tuple[Asks, Seat]]
        if k in patterns:
            asks = zip(patterns[k].ties, patterns[k].seats(seats, actuals), strict=True)
        else:
            asks = _line(actuals, simulators) if len(actuals) > 1 else _single(datum, k, actuals[0], simulators[0])
        for tie, seat in list(asks):
            seats.append(seat)
            yield k, Tie(_name(frame, datum), *tie), seat


def _name(frame: DatumFrame, datum: Datum) -> str:
    return f"datum frame {frame.name}: {'-'.join(datum.features)}"


def _patterns(frame: DatumFrame, nominal: Mapping[str, ActualFeature]) -> dict[int, Pattern]:
    """The patterns among its datums, by index."""
    patterns: dict[int, Pattern] = {}
    for k, datum in enumerate(frame.datums):
        if datum.simulator == "pattern":
            first = replace(frame, datums=frame.datums[:k])
            tied = list(_tied(first, nominal.__getitem__, nominal, patterns))
            ties, seats = [tie for _, tie, _ in tied], [seat for _, _, seat in tied]
            patterns[k] = pattern(_name(frame, datum), ties, seats, [nominal[name] for name in datum.features])
            if not patterns[k].freedoms.shape[1]:
                _refuse_idle(frame, datum)
    return patterns


def _line(actuals: Sequence[ActualFeature], simulators: Sequence[ActualFeature]) -> Iterator[tuple[Asks, Seat]]:
    """Seat of the line through the centres of two features, or of least squares through more."""
    (start, *_, end), (target_start, *_, target_end) = actuals, simulators
    direction, toward = unit(end.origin - start.origin), unit(target_end.origin - target_start.origin)
    middle, target = (start.origin + end.origin) / 2, (target_start.origin + target_end.origin) / 2
    if len(actuals) > 2:
        (middle, direction), (target, toward) = (
            fitted_line([feature.origin for feature in features]) for features in (actuals, simulators)
        )
    yield ("across", "direction"), Seat(middle, target, direction, toward)


def fitted_line(places: Sequence[Array]) -> tuple[Array, Array]:
    """Middle and direction (3, n) of the line of least squares through points, each (3, n).

    The direction points from the first to the last, along the largest spread: an eigenvector of the scatter (Pearson
    1901).
    """
    points = np.stack(np.broadcast_arrays(*places))
    middle = points.mean(axis=0)
    off = points - middle
    _, vectors = np.linalg.eigh(np.moveaxis(sum(point[:, None] * point[None] for point in off), 2, 0))
    direction = vectors[:, :, -1].T
    return middle, np.where(dot(direction, points[-1] - points[0]) < 0.0, -direction, direction)


def _single(datum: Datum, k: int, feature: ActualFeature, simulator: ActualFeature) -> Iterator[tuple[Asks, Seat]]:
    """Seats of a datum of one feature, the k-th of its frame; a secondary plane has one per target."""
    asks = feature.feature.shape.asks
    if datum.simulator == "targets" and datum.targets is not None and k > 0:
        for target in datum.targets:
            point, place = feature.at(target), simulator.at(target)
            yield ("along", "none"), Seat(point, place, None, simulator.direction, centre=feature.origin)
    elif asks[1] == "none":
        yield asks, Seat(feature.origin, simulator.origin)
    else:
        outermost = feature if datum.simulator == "contact" and k > 0 and "height" in feature.asked else None
        across = feature if "corners" in feature.asked else None
        places, directions = (feature.origin, simulator.origin), (feature.direction, simulator.direction)
        yield asks, Seat(*places, *directions, outermost=outermost, across=across)


class PartFeatures:
    """Actual features of one part, in its frame.

    Args:
        part: the part.
        datum_seats: seats of its datum frames, by name.
        columns: the deviations, (width, n) [mm].
        still: features that never deviate, by name; filled in, and shared with other trials.
    """

    def __init__(
        self,
        part: Part,
        datum_seats: Mapping[str, DatumSeats],
        columns: Array,
        still: dict[str, ActualFeature] | None = None,
    ) -> None:
        self._part = part
        self._features = {feature.name: feature for feature in part.features}
        self._datum_seats = datum_seats
        self._columns = columns
        self._still = {} if still is None else still
        self._actual: dict[str, ActualFeature] = {}
        self._frames: dict[str, tuple[Pose, Codes]] = {}

    def are_of(self, part: Part, trials: int) -> bool:
        """True if a part has the same features and datum frames, and a number of trials is a multiple of these."""
        return (
            trials % self._columns.shape[1] == 0
            and len(part.features) == len(self._features)
            and all(feature == self._features.get(feature.name) for feature in part.features)
            and part.datum_frames == self._part.datum_frames
        )

    def repeated(self, trials: int) -> "PartFeatures":
        """Features of these trials several times in succession, `trials` in all."""
        return self if self._columns.shape[1] == trials else _RepeatedFeatures(self, trials)

    def feature(self, name: str) -> ActualFeature:
        """An actual feature by its name."""
        known = self._actual.get(name) or self._still.get(name)
        if known is None:
            feature = self._features[name]
            base = self.displacement(feature.parent) @ Pose.of(feature.frame)
            known = actual(feature, base, self._columns)
            kept = self._still if feature.is_still else self._actual
            kept[name] = known
        return known

    def forget(self, name: str) -> None:
        """Free a feature that is unlikely to be needed again; if it is, it is recomputed."""
        self._actual.pop(name, None)

    def displacement(self, frame: str) -> Pose:
        """Displacement of a datum frame from nominal, in the part's frame; identity for "", the part's frame itself."""
        return self._displaced(frame)[0] if frame else IDENTITY

    def seats(self, frame: str) -> DatumSeats:
        """Seats of a datum frame."""
        return self._datum_seats[frame]

    def codes(self, frame: str) -> Codes:
        """Status codes of a datum frame (n,) or (1,)."""
        return self._displaced(frame)[1]

    def _displaced(self, name: str) -> tuple[Pose, Codes]:
        """Displacement and status codes of a datum frame."""
        if name not in self._frames:
            seats = self._datum_seats[name]
            aligned, codes = seats.pose(self.feature, self._columns)
            displacement = aligned.inverse
            if seats.frame.shifted_by:
                shift = np.stack(np.broadcast_arrays(*total(seats.frame.shifted_by, 3, self._columns)))
                displacement = Pose(displacement.turn, displacement.point(shift))
            self._frames[name] = displacement, codes
        return self._frames[name]


class _RepeatedFeatures(PartFeatures):
    """Features of a part in trials that follow each other several times, computed once."""

    def __init__(self, once: PartFeatures, trials: int) -> None:
        super().__init__(once._part, once._datum_seats, np.broadcast_to(0.0, (0, trials)), once._still)
        self._once, self._trials = once, trials

    def feature(self, name: str) -> ActualFeature:
        if name not in self._actual:
            once = self._once.feature(name)
            self._actual[name] = once if once.feature.is_still else once.repeated(self._trials)
        return self._actual[name]

    def _displaced(self, name: str) -> tuple[Pose, Codes]:
        if name not in self._frames:
            displacement, codes = self._once._displaced(name)
            self._frames[name] = displacement.repeated(self._trials), repeated(codes, self._trials)
        return self._frames[name]
