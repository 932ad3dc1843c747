"""An assembly to first order: each measure is a row over deviations, a constant, and nonlinear terms."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly, Measured
from tol3d.assembly.torsors.columns import Columns, without_rounding
from tol3d.assembly.torsors.measures import reading
from tol3d.assembly.torsors.rest_move import OneSided, along_nothing
from tol3d.assembly.torsors.terms import Ends, Form, Largest, Term
from tol3d.assembly.torsors.torsor import ordered_product
from tol3d.assembly.torsors.world import World
from tol3d.errors import InputError
from tol3d.import_path import named
from tol3d.numerics.arrays import Array

STEP: Final = 1e-6
"""Step [mm] for slopes of deviations that do not vary."""


@dataclass(frozen=True, eq=False)
class Bend:
    """A term of a measure, nonlinear in the deviations.

    Args:
        form: how it depends on what it reads.
        columns: of the deviations that act through it, in order.
        weights: (numbers of the term,), with which it is added to the measure; all 0 where another one reads it.
        vectors: (vectors, size, columns of the deviations + 1), of a largest length that reads deviations alone: it is
            the largest of |vectors[..., :-1] @ deviations + vectors[..., -1]|; else None.
    """

    form: Form
    columns: tuple[int, ...]
    weights: Array
    vectors: Array | None = None


@dataclass(frozen=True, eq=False)
class Slopes:
    """A measure to first order at the means of the deviations.

    Neglected: for columns in `bends`, all but the mean slope from one sigma below to one above the mean, the others at
        their means. So nothing is left of a largest amount that is 0 at the means.

    Args:
        nominal, at_means: of the measure, without deviations and with all at their means [mm or rad].
        coefficients: change of the measure per deviation (columns,).
        bends: the terms that are not linear; none where the measure is smooth.
    """

    nominal: float
    at_means: float
    coefficients: Array
    bends: tuple[Bend, ...] = ()

    @property
    def bent(self) -> tuple[int, ...]:
        """Columns whose coefficients are mean slopes, in order."""
        return tuple(sorted({column for bend in self.bends for column in bend.columns}))


UNSEEN = 1e-9
"""Change of a measure by rocking [mm or rad per mm] that is rounding."""
TOGETHER = 4096
"""Trials evaluated at once: their columns stay in the cache."""


@dataclass(frozen=True, eq=False)
class FirstOrder:
    """The measures of an assembly to first order. It pickles, and holds no model.

    Args:
        width: columns of the deviations.
        terms: each with the first of its columns, in an order in which each reads only those before.
        rows: of each measure (columns,) [mm or rad]: the deviations', the constant's, the terms'.
    """

    width: int
    terms: tuple[tuple[int, Term], ...]
    rows: Mapping[str, Array]

    def values(self, deviations: Array, names: Sequence[str]) -> dict[str, Array]:
        """Values (trials,) of some measures [mm or rad] from deviations (trials, columns) [mm, rad]."""
        if not names:
            return {}
        rows = np.array([self.rows[name] for name in names])
        terms = self._read_by(rows)
        found = np.empty((len(names), len(deviations)))
        for first in range(0, len(deviations), TOGETHER):
            piece = deviations[first : first + TOGETHER]
            found[:, first : first + TOGETHER] = ordered_product(rows, self._columns(piece, terms, rows.shape[1]))
        return dict(zip(names, found, strict=True))

    def is_bent(self, name: str) -> bool:
        """True if a measure reads a term."""
        return bool(self._read_by(self.rows[name][None]))

    def slopes(self, name: str, means: Array, sigmas: Array) -> Slopes:
        """Slopes of a measure for each column, at the means of the deviations.

        Args:
            name: its name.
            means, sigmas: of each column (columns,) [mm, rad].
        """
        row = self.rows[name]
        terms = self._read_by(row[None])
        bends = tuple(self._bend(row, start, term) for start, term in terms)
        coefficients = row[: self.width].copy()
        bent = np.array(sorted({column for bend in bends for column in bend.columns}), dtype=int)
        steps = np.zeros((len(bent), self.width))
        steps[np.arange(len(bent)), bent] = np.where(sigmas[bent] > 0.0, sigmas[bent], STEP)
        sides = [self.values(means + sign * steps, [name])[name] for sign in (1.0, -1.0)]
        coefficients[bent] = (sides[0] - sides[1]) / (2.0 * steps.sum(axis=1))
        ends = self.values(np.array([np.zeros(self.width), means]), [name])[name]
        return Slopes(float(ends[0]), float(ends[1]), coefficients, bends)

    def _columns(self, deviations: Array, terms: Sequence[tuple[int, Term]], count: int) -> Array:
        columns = np.zeros((count, len(deviations)))
        columns[: self.width] = deviations.T
        columns[self.width] = 1.0
        for start, term in terms:
            columns[start : start + term.count] = term.values(ordered_product(term.forms, columns))
        return columns

    def _read_by(self, rows: Array) -> list[tuple[int, Term]]:
        """The terms that rows read, and what those read, in their order."""
        wanted, found = _reads(rows), list[tuple[int, Term]]()
        for start, term in reversed(self.terms):
            if wanted[start : start + term.count].any():
                wanted = wanted | _reads(term.forms)
                found.append((start, term))
        return found[::-1]

    def _bend(self, row: Array, start: int, term: Term) -> Bend:
        earlier = self._read_by(term.forms)
        read = _reads(np.concatenate([term.forms, *(each.forms for _, each in earlier)]))
        columns = tuple(np.flatnonzero(read[: self.width]).tolist())
        vectors = None
        if isinstance(term, Largest) and not earlier:
            vectors = term.forms[:, : self.width + 1].reshape(-1, term.size, self.width + 1)
        return Bend(term.form, columns, row[start : start + term.count], vectors)


def first_order(assembly: Assembly) -> FirstOrder:
    """An assembly to first order, from its nominal geometry.

    Raises:
        InputError: a move leaves a freedom that it should hold, or holds one twice; or a measure makes no sense.
    """
    columns = Columns(assembly.width, _room(assembly))
    first = World(assembly, columns)
    worlds, unknowns = _moved(first, {})
    rows = {name: _row(name, measured, worlds) for name, measured in assembly.measures.items()}
    for name, measured in assembly.measures.items():
        if measured.rocking is not None and unknowns:
            rows[name] = _rocked(measured, rows[name], first, unknowns)
        if measured.over_play is not None:
            rows[name] = _played(name, measured, rows[name], first, unknowns)
    return FirstOrder(assembly.width, tuple(columns.terms), rows)


def displaced(assembly: Assembly, part: str, after: int) -> FirstOrder:
    """Torsor of a part, seen at the world's origin [mm, rad], as six measures "0" to "5".

    Args:
        assembly: the model.
        part: its name.
        after: index of the move after which it is evaluated; -1 for the end.
    """
    columns = Columns(assembly.width, _room(assembly))
    worlds, _ = _moved(World(assembly, columns), {})
    torsor = without_rounding(worlds[-1 if after < 0 else after + 1].parts[part])
    return FirstOrder(assembly.width, tuple(columns.terms), {str(k): row for k, row in enumerate(torsor)})


def _played(name: str, measured: Measured, row: Array, first: World, unknowns: Mapping[int, slice]) -> Array:
    """A measure's row (columns,) at its least or largest over the play of parts."""
    sign = 1.0 if measured.over_play == "largest" else -1.0
    plays = {index: own for index, own in unknowns.items() if first.assembly.moves[index].acts.has_room}
    whither = {index: sign * row[own.start : own.stop - 1] for index, own in plays.items()}
    return _row(name, measured, _moved(first, whither)[0])


def _moved(first: World, leaning: Mapping[int, Array]) -> tuple[list[World], dict[int, slice]]:
    """Worlds before the first move and after each, with the leaning of some rests; and the columns made by rests."""
    worlds, unknowns = [first], dict[int, slice]()
    for index, move in enumerate(first.assembly.moves):
        act, leans = named(move.acts.torsors), move.acts.rocks or move.acts.has_room
        worlds.append(act(move, worlds[-1], leaning.get(index)) if leans else act(move, worlds[-1]))
        if leans:
            start, term = first.columns.terms[-1]
            unknowns[index] = slice(start, start + term.count)
    return worlds, unknowns


def _rocked(measured: Measured, row: Array, first: World, unknowns: Mapping[int, slice]) -> Array:
    """A measure's row (columns,) at one end of the rocking range, or in the middle of both."""
    through = _through(row, first.columns.terms)
    moves = first.assembly.moves
    weights = {index: through[own] for index, own in unknowns.items() if moves[index].acts.rocks}
    for index, own in weights.items():
        if np.abs(own).max() < UNSEEN:  # no effect, or by a nonlinear term
            weights[index] = along_nothing(len(own))
    ends = []
    for sign in (-1.0, 1.0):
        worlds, _ = _moved(first, {index: sign * own for index, own in weights.items()})
        ends.append(without_rounding(reading(measured, worlds)))
    if measured.rocking == "middle":
        return (ends[0] + ends[1]) / 2.0
    made: Array = first.columns.made_by(Ends(np.array(ends), measured.rocking == "largest"))[0]
    return made


def _through(row: Array, terms: Sequence[tuple[int, Term]]) -> Array:
    """A row (columns,) with dependence on rests transferred to the rests beneath: a part moves along with those.

    A part on one-sided contacts A z + g goes along with what displaces all of them by A q: z falls by q.
    """
    for start, term in reversed(terms):
        if isinstance(term, OneSided):
            own = row[start : start + term.count]
            row = row - own @ np.linalg.pinv(term.matrix) @ term.forms
    return row


def _row(name: str, measured: Measured, worlds: list[World]) -> Array:
    try:
        return without_rounding(reading(measured, worlds))
    except InputError as error:
        raise InputError(f"measures.{name}: {error}") from None


def _reads(rows: Array) -> NDArray[np.bool_]:
    """Flags of the columns that some of the rows read (columns,)."""
    return np.asarray(rows.any(axis=0))


def _room(assembly: Assembly) -> int:
    """Upper bound for the number of columns of terms.

    One for a datum, those of moves, one for a linear reading, else ten. Datums of a frame with gauges count twice, and
    the gauges have play.

    Moves are followed once, and twice more for each measure that is read at an end of the rocking range.
    """
    frames = assembly.datum_frames.values()
    datums = sum(len(frame.datums) for frame in frames)
    datums += sum(len(frame.datums) + 7 for frame in frames if frame.gauges is not None)
    rests = any(move.acts.rocks for move in assembly.moves)
    played = sum(measure.over_play is not None for measure in assembly.measures.values())
    rocking = sum(measure.rocking is not None for measure in assembly.measures.values()) if rests else 0
    moved = sum(move.terms for move in assembly.moves)
    return datums + moved * (1 + 2 * rocking + played) + sum(map(_readings, assembly.measures.values()))


def _readings(measured: Measured) -> int:
    # where a part may rock, the ends of a linear measure are a term
    own = 1 if measured.reads.is_linear else 10 + len(measured.bonuses)
    return own + (0 if measured.minus is None else _readings(measured.minus))
