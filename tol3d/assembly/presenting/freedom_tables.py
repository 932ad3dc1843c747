"""Which freedoms datums and moves take of a part, as tables."""

from collections.abc import Sequence
from typing import Final

from tol3d.assembly.model import Assembly, Fix, StatedMove, Weld
from tol3d.assembly.placing.holding import Freedoms, Taken, held_by, held_by_datums, in_words
from tol3d.assembly.placing.plan import planned
from tol3d.report.page import Heading, PageItem, Row, Table, note, titled

SIGNS: Final = "z: a shift along z; turns z: a turn about z; each holds of what those above it leave"


def datum_blocks(assembly: Assembly) -> Sequence[PageItem]:
    """Which freedoms datums take."""
    rows: list[Row] = []
    for frame in assembly.datum_frames.values():
        found = held_by_datums(assembly, frame)
        datums = [f"{own.words}: {in_words(own)}" for own in found.taken]
        rows.append(Row(f"{frame.part}: {', '.join(frame.name.split('|')[1:])}", ("; ".join(datums), _left(found))))
    words = [Heading(word, words=True) for word in ("each takes", "stay as in the part")]
    return titled("datum frames, along the axes of their part", Table("", words, rows)) if rows else ()


def freedom_blocks(assembly: Assembly) -> Sequence[PageItem]:
    """Which freedoms moves hold, and which they leave."""
    rows: list[Row] = []
    for move, plan in zip(assembly.moves, planned(assembly).moves, strict=True):
        match move:
            case Fix():
                rows.append(Row(move.name, ("all six", "as drawn")))
            case Weld():
                rows.append(Row(move.name, ("all six", f"{', '.join(move.others)} with {move.part}")))
            case StatedMove():
                rows += [Row(move.name, (f"all six of {part}", move.words)) for part in move.parts]
            case _:
                found = held_by(assembly, plan)
                rows += [Row(move.name, (in_words(own), _by(own))) for own in found.taken]
                if found.left.count:
                    rows.append(Row(move.name, (_left(found), "left as drawn")))
    words = [Heading(word, words=True) for word in ("freedoms", "held by")]
    table = Table("", words, rows)
    return (*titled("freedoms that moves hold, along the axes of the world", table), note(SIGNS))


def _by(taken: Taken) -> str:
    return f"{taken.words}, within clearance" if taken.is_room else taken.words


def _left(freedoms: Freedoms) -> str:
    """What none takes; of one turn about which axis."""
    return f"{in_words(freedoms.left)}{f' {freedoms.where}' if freedoms.where else ''}"
