"""Patterns of features: one entry for all that lie in rows and columns."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Final, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from tol3d.assembly.grammar.features.nominal_frame import ALONG, unit
from tol3d.numerics.arrays import Array
from tol3d.scene.bases import Length
from tol3d.scene.vector import Direction
from tol3d.strict import Strict, refused
from tol3d.units import Quantity, summed

MOST: Final = 1000  # features of a pattern

Count = Annotated[int, Field(ge=1, le=MOST)]


def _both(given: Any) -> tuple[Any, Any]:
    """One pitch for rows and columns, or that between columns and that between rows."""
    if isinstance(given, list | tuple):
        if len(given) != 2:
            expected = "a length, or two: between columns and between rows"
            raise refused("", expected, f"a list of {len(given)}")
        return given[0], given[1]
    return given, given


Pitches = Annotated[
    tuple[Length, Length], BeforeValidator(_both, json_schema_input_type=Length | tuple[Length, Length])
]


class PatternSpec(Strict):
    """Features in rows and columns, equal except for their places; the entry's own is the first of the first row."""

    rows: Count = Field(default=1, description="how many rows there are")
    columns: Count = Field(default=1, description="how many features a row has")
    pitch: Pitches = Field(description="between neighbours; a list of two: between columns, between rows")
    along: Direction | None = Field(default=None, description="from column to column; default: x of the feature")
    across: Direction | None = Field(
        default=None, description="from row to row; default: square to `along` in the plane of the feature"
    )

    @property
    def count(self) -> int:
        """Number of features."""
        return self.rows * self.columns

    def ways(self, frame: Array) -> tuple[Array, Array]:
        """Directions (3,) of unit length from column to column and from row to row, in the nominal frame (4, 4)."""
        x = frame[:3, 0] if self.along is None else unit(self.along)
        if self.across is not None:
            return x, unit(self.across)
        y = np.cross(frame[:3, 2], x)
        size = float(np.linalg.norm(y))
        return x, y / size if size > ALONG else np.zeros(3)

    def places(self, at: tuple[Quantity, ...], frame: Array) -> Iterator[tuple[Quantity, ...]]:
        """Midpoints of the features, row by row.

        Args:
            at: midpoint of the first one.
            frame: its nominal frame (4, 4).
        """
        x, y = self.ways(frame)
        for row in range(self.rows):
            for column in range(self.columns):
                steps = ((column, self.pitch[0], x), (row, self.pitch[1], y))
                yield tuple(
                    _moved(own, [(k, pitch, float(way[i])) for k, pitch, way in steps]) for i, own in enumerate(at)
                )

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if not 1 < self.count <= MOST:
            raise refused("", f"2 to {MOST} features in rows and columns", str(self.count))
        return self


@dataclass(frozen=True)
class Scattered:
    """Features that one entry selects, wherever each lies: in place of a pattern.

    Args:
        members: the features, in their order.
    """

    members: tuple[Any, ...]

    @property
    def count(self) -> int:
        """Number of features."""
        return len(self.members)


def _moved(at: Quantity, steps: list[tuple[int, Quantity, float]]) -> Quantity:
    """A coordinate some pitches on; along an axis of the part in decimals, as one would write it."""
    steps = [(times, pitch, way) for times, pitch, way in steps if times and way]
    if all(abs(way) == 1.0 for _, _, way in steps):
        return summed([(1, at), *((times * int(way), pitch) for times, pitch, way in steps)])
    return Quantity(at.internal + sum(times * pitch.internal * way for times, pitch, way in steps), "mm")
