"""Pictures of the callouts in drawings.md: feature control frames as small SVG files, drawn from a table.

    python docs/callouts.py

writes docs/callouts/*.svg anew. A new callout is an entry of CALLOUTS and a line `![…](callouts/NAME.svg)` on the page.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final
from xml.sax.saxutils import escape

HERE: Final = Path(__file__).parent
ROW: Final = 26.0  # px; height of a row
GAP: Final = 12.0  # px; between frames, and around all of them
LETTER: Final = 8.4  # px; width of a character, to which its text is stretched
INSIDE: Final = 7.0  # px; between a text and its frame
CELL: Final = 34.0  # px; width of a cell with a symbol
SYMBOLS: Final[Mapping[str, str]] = {
    "position": '<circle cx="10" cy="10" r="5.5"/><path d="M1 10H19M10 1V19"/>',
    "profile": '<path d="M2 14A8 8 0 0 1 18 14Z"/>',
    "straightness": '<path d="M2 10H18"/>',
    "flatness": '<path d="M2 15L7 5H18L13 15Z"/>',
    "roundness": '<circle cx="10" cy="10" r="7"/>',
    "cylindricity": '<circle cx="10" cy="10" r="5"/><path d="M2 17L7 3M13 17L18 3"/>',
    "perpendicularity": '<path d="M2 17H18M10 17V3"/>',
    "parallelism": '<path d="M3 17L9 3M10 17L16 3"/>',
    "angularity": '<path d="M18 16H2L16 4"/>',
    "coaxiality": '<circle cx="10" cy="10" r="3.5"/><circle cx="10" cy="10" r="7.5"/>',
    "symmetry": '<path d="M5 6H15M2 10H18M5 14H15"/>',
    "run_out": '<path d="M3 17L14 6"/><path d="M17 3L15 9L11 5Z" fill="black"/>',
    "total_run_out": (
        '<path d="M1 17L8 8M9 17L16 8M1 17H9"/><path d="M11 4L10 10L5.5 6.5ZM19 4L18 10L13.5 6.5Z" fill="black"/>'
    ),
}
"""In a square of 20 px."""
DIAMETER: Final = "⌀"
CIRCLED: Final = {"Ⓜ": "M", "Ⓛ": "L", "Ⓟ": "P", "Ⓣ": "T", "Ⓔ": "E"}


@dataclass(frozen=True)
class Frame:
    """A feature control frame.

    Args:
        symbol: a key of SYMBOLS.
        rows: cells of each segment, the zone first; one symbol stands before all of them.
        before: text in front of it, such as 4 × ⌀8.
        notes: text behind each row.
    """

    symbol: str
    rows: tuple[tuple[str, ...], ...]
    before: str = ""
    notes: tuple[str, ...] = ()


CALLOUTS: Final[Mapping[str, tuple[Frame, ...]]] = {
    "composite_position": (
        Frame(
            "position",
            (("⌀0.3", "A", "B", "C"), ("⌀0.1", "A")),
            "4 × ⌀8",
            ("location of the pattern", "location of its holes to each other"),
        ),
    ),
    "profile_of_a_bore": (
        Frame("profile", (("0.1", "A", "B", "C"),), "⌀8 (basic)", ("size, place, lean and form of the bore",)),
    ),
    "cone_datum": (
        Frame("profile", (("0.01",),), "taper 3:20", ("of its surface; the taper is datum A",)),
        Frame("total_run_out", (("0.02", "A"),), "nose", ("about the axis of A, which holds the place along it too",)),
    ),
    "form": (
        Frame("cylindricity", (("0.02",),), "nose"),
        Frame("roundness", (("0.01",),), "nose"),
        Frame("straightness", (("0.015",),), "nose", ("lines of the surface; ⌀0.015 would be the axis",)),
        Frame("run_out", (("0.05", "A"),), "nose"),
        Frame("run_out", (("0.03", "A"),), "shoulder", ("axial run-out",)),
        Frame("flatness", (("0.004",),), "shoulder"),
        Frame("straightness", (("0.01/20",),), "rail", ("every 20 mm",)),
    ),
    "size_and_form": (
        Frame("straightness", (("⌀0.02",),), "⌀10 0/-0.05 Ⓔ", ("axis of the pin, no more than the size leaves",)),
    ),
    "orientation": (
        Frame("perpendicularity", (("⌀0.05Ⓟ16", "A"),), "tapped hole", ("over the projected length of its stud",)),
        Frame("parallelism", (("0.02Ⓣ", "A"),), "top", ("of the tangent plane",)),
    ),
    "simultaneous": (
        Frame("position", (("⌀0.2", "A", "BⓂ"),), "near", ("SIM REQT",)),
        Frame("position", (("⌀0.1", "A", "BⓂ"),), "far", ("SIM REQT",)),
    ),
    "pattern_datum": (
        Frame("position", (("⌀0.3", "A"),), "4 × ⌀8", ("the pattern is datum B",)),
        Frame("position", (("⌀0.1", "A", "B"),), "bore", ("regardless of the sizes of the holes",)),
        Frame("position", (("⌀0.1", "A", "BⓂ"),), "rim", ("on a gauge of four pins",)),
    ),
    "datum_targets": (
        Frame("position", (("⌀0.3", "A", "B", "C"),), "hole", ("A at A1, A2, A3; B at B1, B2; C at C1",)),
    ),
    "common_datum": (Frame("coaxiality", (("⌀0.02", "A-B-C"),), "nose", ("to the line through three bores",)),),
}
"""Frames of each picture, one below the other."""


def picture(frames: tuple[Frame, ...]) -> str:
    """The SVG of some frames."""
    left = GAP + max((_width(own.before) + INSIDE if own.before else 0.0) for own in frames)
    drawn, top, right = list[str](), GAP, 0.0
    for frame in frames:
        own, end = _frame(frame, left, top)
        drawn += own
        right, top = max(right, end), top + ROW * len(frame.rows) + GAP
    size = f"{right + GAP:g} {top:g}"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size}" width="{right + GAP:g}" height="{top:g}" '
        'font-family="monospace" font-size="14" fill="none" stroke="black" stroke-width="1.2">\n'
        f'<rect width="100%" height="100%" fill="white" stroke="none"/>\n{chr(10).join(drawn)}\n</svg>\n'
    )


def _frame(frame: Frame, left: float, top: float) -> tuple[list[str], float]:
    """Its elements, and how far it reaches to the right [px]."""
    height = ROW * len(frame.rows)
    drawn = [*_text(frame.before, left - INSIDE - _width(frame.before), top + height / 2)] if frame.before else []
    drawn.append(_box(left, top, CELL, height))
    middle = f"translate({left + CELL / 2 - 10:g} {top + height / 2 - 10:g})"
    drawn.append(f'<g transform="{middle}">{SYMBOLS[frame.symbol]}</g>')
    right = 0.0
    for k, row in enumerate(frame.rows):
        x, y = left + CELL, top + k * ROW
        for cell in row:
            width = _width(cell) + 2 * INSIDE
            drawn.append(_box(x, y, width, ROW))
            drawn += _text(cell, x + INSIDE, y + ROW / 2)
            x += width
        if k < len(frame.notes):
            drawn += _text(frame.notes[k], x + GAP, y + ROW / 2)
            x += GAP + _width(frame.notes[k])
        right = max(right, x)
    return drawn, right


def _box(x: float, y: float, width: float, height: float) -> str:
    return f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}"/>'


def _width(text: str) -> float:
    return sum(_width_of(piece) for piece in _pieces(text))


def _width_of(piece: str) -> float:
    return 18.0 if piece in CIRCLED else 14.0 if piece == DIAMETER else LETTER * len(piece)


def _pieces(text: str) -> Iterator[str]:
    """Its signs, and what stands between them."""
    plain = ""
    for letter in text:
        if letter in CIRCLED or letter == DIAMETER:
            yield from (plain, letter) if plain else (letter,)
            plain = ""
        else:
            plain += letter
    if plain:
        yield plain


def _text(text: str, x: float, middle: float) -> Iterator[str]:
    for piece in _pieces(text):
        width = _width_of(piece)
        at = x + width / 2
        if piece in CIRCLED:
            yield f'<circle cx="{at:g}" cy="{middle:g}" r="8"/>'
            yield _words(CIRCLED[piece], at, middle, 9.0)
        elif piece == DIAMETER:
            yield f'<circle cx="{at:g}" cy="{middle:g}" r="4.5"/>'
            yield f'<path d="M{at - 5:g} {middle + 6:g}L{at + 5:g} {middle - 6:g}"/>'
        else:
            shown = piece.strip()
            ahead = LETTER * (len(piece) - len(piece.lstrip()))
            yield _words(shown, x + ahead + LETTER * len(shown) / 2, middle, LETTER * len(shown) - 1.0)
        x += width


def _words(text: str, at: float, middle: float, width: float) -> str:
    fixed = f' textLength="{width:g}" lengthAdjust="spacingAndGlyphs"' if len(text) > 1 else ""
    place = f'x="{at:g}" y="{middle + 5:g}" text-anchor="middle"'
    return f'<text {place}{fixed} fill="black" stroke="none">{escape(text)}</text>'


def main() -> None:
    """Write all pictures."""
    for name, frames in CALLOUTS.items():
        (HERE / "callouts" / f"{name}.svg").write_text(picture(frames), encoding="utf-8")


if __name__ == "__main__":
    main()
