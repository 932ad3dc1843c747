"""Seats of a frame's datums on their simulators: the part's features on nominal ones."""

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
"""Spread [mm] of points across a line, below which they lie on it."""

Actual = Callable[[str], ActualFeature]


class OnGauges(Protocol):
    """Pose of a part on gauges of virtual condition."""

    def placed(self, seats: Sequence[Seat], features: Actual, columns: Array) -> tuple[Pose, Codes]:
        """See GaugedFrame."""
        ...


@dataclass(frozen=True, eq=False)
class DatumSeats:
    """Determination of a datum frame: the part's features are aligned with its simulators; the frame is the inverse.

    Args:
        frame: the datum frame.
        alignment: of the ties, in order.
        nominal: the nominal features of its datums.
        datums: number of each tie's datum.
        patterns: the datums that are patterns, by number.
        gauged: the gauges on which the part lies, if any.
    """

    frame: DatumFrame
    alignment: Alignment
    nominal: Mapping[str, ActualFeature]
    datums: tuple[int, ...]
    patterns: Mapping[int, Pattern]
    gauged: OnGauges | None = None

    def pose(self, features: Actual, columns: Array) -> tuple[Pose, Codes]:
        """The part in its frame, and status codes (n,) or (1,)."""
        seats, gauges = self.of(features), self.frame.gauges
        if self.gauged is None or gauges is None or gauges.floating is None:
            return self.alignment.poses(seats, IDENTITY)
        return self.gauged.placed(seats, features, columns)

    def of(self, features: Actual) -> list[Seat]:
        """The seats of its ties in their trials."""
        return [seat for _, _, seat in _asked(self.frame, features, self.nominal, self.patterns)]


def datum_seats(part: Part) -> dict[str, DatumSeats]:
    """Seats of all datum frames of a part, by name.

    Raises:
        InputError: a datum takes no freedom, or cannot be met at its precedence.
    """
    nominal = {feature.name: nominally(feature) for feature in part.features}
    return {frame.name: _of(frame, nominal) for frame in part.datum_frames}


def _of(frame: DatumFrame, nominal: Mapping[str, ActualFeature]) -> DatumSeats:
    _refuse_few_targets(frame)
    _refuse_scattered(frame, nominal)
    patterns = _patterns(frame, nominal)
    datums, ties, seats = zip(*_asked(frame, nominal.__getitem__, nominal, patterns), strict=True)
    alignment = aligned(ties, seats, IDENTITY)
    taking = {datums[tie] for tie in range(len(ties)) if tie not in alignment.idle}
    for k, datum in enumerate(frame.datums):
        if k not in taking:
            _refuse_idle(frame, datum)
    return DatumSeats(frame, alignment, nominal, tuple(datums), patterns)


def _refuse_idle(frame: DatumFrame, datum: Datum) -> None:
    """Refuse a datum that takes no freedom; later ones take from the room of the gauges."""
    if datum not in frame.later:
        raise InputError(
            f"{_name(frame, datum)} takes no freedom: datums before it hold all that it could take; leave it out"
        )


def _refuse_few_targets(frame: DatumFrame) -> None:
    """Refuse targets of a primary plane that do not hold it; three valid ones are on the plane itself."""
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
    """Refuse a common datum of several whose centres lie on no line, or two of them in one place, nominally."""
    for datum in frame.datums:
        if len(datum.features) < 2 or datum.simulator == "pattern":
            continue
        places = np.concatenate([nominal[name].origin.reshape(3, -1)[:, :1] for name in datum.features], axis=1).T
        name = "-".join(feature.partition(".")[2] for feature in datum.features)
        _, spread, ways = np.linalg.svd(places - places.mean(axis=0), full_matrices=False)
        if len(places) > 2 and spread[1] > ABREAST:
            raise InputError(
                f"datum frame {frame.name}: the centres of the common datum {name} lie off a line nominally, by "
                f"{spread[1]:.3g} mm: expected them on one; beside each other they are a pattern, write {{feature: "
                f"{name}, simulator: pattern}}"
            )
        along = np.sort(places @ ways[0])
        if np.diff(along).min() < ABREAST:
            raise InputError(
                f"datum frame {frame.name}: two features of the common datum {name} have one centre: name one"
            )


def _asked(
    frame: DatumFrame, features: Actual, nominal: Mapping[str, ActualFeature], patterns: Mapping[int, Pattern]
) -> Iterator[tuple[int, Tie, Seat]]:
    """Number of the datum, its constraint, and the seat."""
    seats: list[Seat] = []
    for k, datum in enumerate(frame.datums):
        own = [features(name) for name in datum.features]
        simulators = [nominal[name] for name in datum.features]
        asks: Iterable[tuple[Asks, Seat]]
        if k in patterns:
            asks = zip(patterns[k].ties, patterns[k].seats(seats, own), strict=True)
        else:
            asks = _line(own, simulators) if len(own) > 1 else _single(datum, k, own[0], simulators[0])
        for tie, seat in list(asks):
            seats.append(seat)
            yield k, Tie(_name(frame, datum), *tie), seat


def _name(frame: DatumFrame, datum: Datum) -> str:
    return f"datum frame {frame.name}: {'-'.join(datum.features)}"


def _patterns(frame: DatumFrame, nominal: Mapping[str, ActualFeature]) -> dict[int, Pattern]:
    """The patterns among its datums, by their numbers."""
    found: dict[int, Pattern] = {}
    for k, datum in enumerate(frame.datums):
        if datum.simulator == "pattern":
            first = replace(frame, datums=frame.datums[:k])
            asked = list(_asked(first, nominal.__getitem__, nominal, found))
            ties, seats = [tie for _, tie, _ in asked], [seat for _, _, seat in asked]
            found[k] = pattern(_name(frame, datum), ties, seats, [nominal[name] for name in datum.features])
            if not found[k].freedoms.shape[1]:
                _refuse_idle(frame, datum)
    return found


def _line(own: Sequence[ActualFeature], simulators: Sequence[ActualFeature]) -> Iterator[tuple[Asks, Seat]]:
    """The line through the centres of two features, or of more by least squares of their distances from it."""
    (start, *_, end), (its_start, *_, its_end) = own, simulators
    direction, toward = unit(end.origin - start.origin), unit(its_end.origin - its_start.origin)
    middle, target = (start.origin + end.origin) / 2, (its_start.origin + its_end.origin) / 2
    if len(own) > 2:
        (middle, direction), (target, toward) = (
            fitted_line([each.origin for each in some]) for some in (own, simulators)
        )
    yield ("across", "direction"), Seat(middle, target, direction, toward)


def fitted_line(places: Sequence[Array]) -> tuple[Array, Array]:
    """Middle and direction (3, n) of the line of least squares through points, each (3, n), from the first to the last.

    The direction is that of their largest spread, the eigenvector of their scatter (Pearson 1901).
    """
    points = np.stack(np.broadcast_arrays(*places))
    middle = points.mean(axis=0)
    off = points - middle
    _, vectors = np.linalg.eigh(np.moveaxis(sum(own[:, None] * own[None] for own in off), 2, 0))
    direction = vectors[:, :, -1].T
    return middle, np.where(dot(direction, points[-1] - points[0]) < 0.0, -direction, direction)


def _single(datum: Datum, k: int, own: ActualFeature, simulator: ActualFeature) -> Iterator[tuple[Asks, Seat]]:
    asks = own.feature.shape.asks
    if datum.simulator == "targets" and datum.targets is not None and k > 0:
        for target in datum.targets:
            point, place = own.at(target), simulator.at(target)
            yield ("along", "none"), Seat(point, place, None, simulator.direction, centre=own.origin)
    elif asks[1] == "none":
        yield asks, Seat(own.origin, simulator.origin)
    else:
        outermost = own if datum.simulator == "contact" and k > 0 and "height" in own.asked else None
        across = own if "corners" in own.asked else None
        places, directions = (own.origin, simulator.origin), (own.direction, simulator.direction)
        yield asks, Seat(*places, *directions, outermost=outermost, across=across)


class PartFeatures:
    """Actual features of one part, in its frame.

    Args:
        part: the part.
        datum_seats: seats of its datum frames, by name.
        columns: the deviations, (width, n) [mm].
        still: its features that never deviate, by name; cached there for other trials.
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
        """True if a part, perhaps at another pose, has these very features and datum frames, once or several times."""
        return (
            trials % self._columns.shape[1] == 0
            and len(part.features) == len(self._features)
            and all(feature == self._features.get(feature.name) for feature in part.features)
            and all(own == other for own, other in zip(part.datum_frames, self._part.datum_frames, strict=True))
        )

    def repeated(self, trials: int) -> "PartFeatures":
        """Those of trials that follow each other several times; themselves where all are the same ones."""
        return self if self._columns.shape[1] == trials else _RepeatedFeatures(self, trials)

    def feature(self, name: str) -> ActualFeature:
        """A feature."""
        found = self._actual.get(name) or self._still.get(name)
        if found is None:
            feature = self._features[name]
            base = self.displacement(feature.parent) @ Pose.of(feature.frame)
            found = actual(feature, base, self._columns)
            kept = self._still if feature.is_still else self._actual
            kept[name] = found
        return found

    def forget(self, name: str) -> None:
        """Free a feature that is unlikely to be needed again; it is recomputed if it is."""
        self._actual.pop(name, None)

    def displacement(self, frame: str) -> Pose:
        """Transform from the nominal to the actual datum frame; identity for "", the part's frame."""
        return self._found(frame)[0] if frame else IDENTITY

    def seats(self, frame: str) -> DatumSeats:
        """Seats of a datum frame."""
        return self._datum_seats[frame]

    def codes(self, frame: str) -> Codes:
        """Status codes of the datum frame itself (n,) or (1,)."""
        return self._found(frame)[1]

    def _found(self, name: str) -> tuple[Pose, Codes]:
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
    """Features of a part in trials that follow each other several times, found once."""

    def __init__(self, once: PartFeatures, trials: int) -> None:
        super().__init__(once._part, once._datum_seats, np.broadcast_to(0.0, (0, trials)), once._still)
        self._once, self._trials = once, trials

    def feature(self, name: str) -> ActualFeature:
        if name not in self._actual:
            found = self._once.feature(name)
            self._actual[name] = found if found.feature.is_still else found.repeated(self._trials)
        return self._actual[name]

    def _found(self, name: str) -> tuple[Pose, Codes]:
        if name not in self._frames:
            displacement, codes = self._once._found(name)
            self._frames[name] = displacement.repeated(self._trials), repeated(codes, self._trials)
        return self._frames[name]
