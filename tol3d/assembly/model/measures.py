"""Measures of an assembly: features, a direction, the moment of reading."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

from tol3d.assembly.model.datum_frame import GaugeRoom, MaterialBonus
from tol3d.import_path import is_named
from tol3d.numerics.arrays import Array
from tol3d.numerics.values import Valued
from tol3d.study.system.measure import Worse


@dataclass(frozen=True, eq=False)
class Facing:
    """Pairs of points of two parts; the distance of the parts is the least of theirs, to first order.

    Args:
        starts: in the frame of the first part (pairs, 3) [mm].
        ends: in the frame of the second (pairs, 3) [mm].
        normals: directions along which they come nearer, from the first part to the second, nominally in the frame of
            the first (pairs, 3).
        lengths: distances along these, nominally (pairs,) [mm].
        reach: how far points move, about: of the second part along x, y and z of the first, of the first along those of
            the second (2, 3) [mm]. What moves no farther is read of fewer triangles.
    """

    starts: Array
    ends: Array
    normals: Array
    lengths: Array
    reach: Array


PLACING: Final = "tol3d.assembly.placing.measuring"
TORSORS: Final = "tol3d.assembly.torsors.measures"
"""Module of each method's readings for the kinds bundled with tol3d."""


@dataclass(frozen=True)
class Reading:
    """Functions that read a kind of measure, one per method, each by an import path `package.module:function`.

    Args:
        name: for messages; of one kind, or of several that are read alike.
        placing: of a Measured and a World of placed parts to values (n,) or (1,) [mm or rad].
        torsors: of a Measured and a World of torsors to a row over their columns (columns,) [mm or rad].
        is_linear: True if the row adds no term.
        of_part: True for a measure of a single part, whether that is placed or not.
        worse: the worse end if there is no limit.
        of_drawing: True if what is measured is judged against where its drawing has it.
        by_solids: True if `placing` names a SolidReader instead: values with codes, of the solids of two parts.
    """

    name: str
    placing: str
    torsors: str
    is_linear: bool = False
    of_part: bool = False
    worse: Worse = "low"
    by_solids: bool = False
    of_drawing: bool = False

    def lacking(self) -> Iterator[str]:
        """Import paths of its readings that cannot be imported, as error texts."""
        for method, path in (("placing", self.placing), ("torsors", self.torsors)):
            if not is_named(path):
                yield f"its reading by {method}: expected `package.module:function`, got {path!r}, where nothing is"


Rocking = Literal["least", "middle", "largest"]
"""Value read where a part may rock on its contacts: least or largest over the ends, or the middle of both."""


Gauge = Literal["shift", "shift_and_turn"]
SetGauge = Literal["held", "oriented"]
"""A set lies as its datum frame says, or is only oriented by it."""

OverPlay = Literal["least", "largest"]
"""Value read over all poses that play allows."""


@dataclass(frozen=True, eq=False)
class Measured(Valued):
    """One measure of the model.

    Args:
        reads: its formula.
        features: names, in the order of the kind: from, to.
        direction: (3,), of unit length, nominally in the frame of the first feature's part.
        frame: name of a datum frame of that part in which the direction is fixed, or to which a position or an
            orientation is inspected; "" for the part's frame.
        after: index of the move after which it is read; -1 for the end.
        bonuses: of a position and a pattern, the bonus by the size of each feature; () for none.
        zones: of several positions, the width of each [mm], which is subtracted.
        room: of a position, datum shift allowed to the gauge of its last datum, which takes the best shift.
        over_gauges: of a position, True if the gauges of its datum frame take the best place.
        gauge: how a pattern's or a set's gauge finds its best pose in the frame.
        surfaces: True if what is round counts by its surface, with its size.
        middle: of a set, how far the middle of its zone lies out of the material [mm].
        of_move: index of the move whose slack is read; -1 for other kinds.
        over_play: the value taken over the play of parts; None if the floats of the moves decide.
        parts: of a clearance.
        chord_error: of a clearance, chord error of its surfaces [mm].
        facing: of a clearance, places where its parts may be nearest.
        minus: a second one that is subtracted in the same trial.
        rocking: the value taken where a part may rock on its contacts; None for no value then. Not of `minus`.
    """

    reads: Reading
    features: tuple[str, ...]
    direction: Array | None = None
    frame: str = ""
    after: int = -1
    bonuses: tuple[MaterialBonus, ...] = ()
    zones: tuple[float, ...] = ()
    gauge: Gauge | SetGauge = "shift"
    surfaces: bool = False
    middle: float = 0.0
    room: GaugeRoom | None = None
    over_gauges: bool = False
    of_move: int = -1
    minus: "Measured | None" = None
    rocking: Rocking | None = None
    over_play: OverPlay | None = None
    parts: tuple[str, ...] = ()
    chord_error: float = 0.0
    facing: Facing | None = None

    @property
    def kind(self) -> str:
        """Name of its reading."""
        return self.reads.name
