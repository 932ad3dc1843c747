"""Features and datum frames of a part in its trials, each found once."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Part
from tol3d.assembly.placing.actual_feature import ActualFeature, actual, total
from tol3d.assembly.placing.datum_seats import DatumSeats
from tol3d.assembly.placing.poses import IDENTITY, Codes, Pose

Array = NDArray[np.float64]


class PartFeatures:
    """Of one part, in its frame.

    Args:
        part: which.
        datum_seats: of its datum frames, by their names.
        columns: the deviations, (width, n) [mm].
        still: its features that never deviate, by name; what is found of them is kept there for other trials.
    """

    def __init__(
        self,
        part: Part,
        datum_seats: Mapping[str, DatumSeats],
        columns: Array,
        still: dict[str, ActualFeature] | None = None,
    ) -> None:
        self._features = {feature.name: feature for feature in part.features}
        self._datum_seats = datum_seats
        self._columns = columns
        self._still = {} if still is None else still
        self._actual: dict[str, ActualFeature] = {}
        self._frames: dict[str, tuple[Pose, Codes]] = {}

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
        """Free a feature that nothing is likely to ask for again; it is found anew if something does."""
        self._actual.pop(name, None)

    def displacement(self, frame: str) -> Pose:
        """From where a datum frame is nominally to where it is; none of "", the part's frame."""
        return self._found(frame)[0] if frame else IDENTITY

    def seats(self, frame: str) -> DatumSeats:
        """How a datum frame is found."""
        return self._datum_seats[frame]

    def codes(self, frame: str) -> Codes:
        """What became of a datum frame itself (n,) or (1,)."""
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
