"""The features of foreign parts as tables: what each is, where it lies, and a line that selects it."""

from collections.abc import Sequence
from typing import Final

from tol3d.report.page import BLANK, Heading, Line, Page, PageItem, Row, Shown, Table, note, page, titled
from tol3d.step.found import FoundFeature
from tol3d.step.reading import StepFile, StepPart
from tol3d.step.refused import shown
from tol3d.step.selecting import best_line, names, numbers

LONGEST_FACES: Final = 4  # faces of a feature that are listed
WORDS: Final = (
    "a hole or pin turns more than half round, a fillet or round less; planes by the rectangle around them, or their "
    "circle; places in the frame of the part, where the middle is; `#` numbers are those of faces in this file and "
    "change when it is exported again"
)
HEADINGS: Final = (
    Heading("kind", words=True),
    Heading("size [mm]", words=True),
    Heading("place [mm]"),
    Heading("direction"),
    Heading("faces", words=True, optional=True),
    Heading("in the file", words=True, optional=True),
    Heading("select it by", words=True),
)


def features_report(file: StepFile) -> Page:
    """A table for each product of a file that has geometry of its own."""
    blocks: list[PageItem] = []
    for part in file.parts:
        blocks += [BLANK] if blocks else []
        blocks += [Line(((shown(part.name), "bold"), (f" · {_counted(part)}", ""))), _table(part)]
    if len(file.uses) > 1:
        blocks += [BLANK, *titled("parts as they stand in the file", _uses(file))]
    if file.layers:
        named = ", ".join(repr(shown(own)) for own in file.layers[:LONGEST_FACES])
        blocks += [
            BLANK,
            note(f"{len(file.layers)} layers are ignored: {named}{', …' if len(file.layers) > LONGEST_FACES else ''}"),
        ]
    return page(*blocks, BLANK, note(WORDS))


def _uses(file: StepFile) -> Table:
    """Pose of each part, as in `use` and `placed` of a scene."""
    products = {own.body.product: shown(own.name) for own in file.parts}
    rows = []
    for own in file.uses:
        at, z, x = own.frame
        cells = (products[own.product], _numbers(at, 4), _numbers(z, 6), _numbers(x, 6))
        rows.append(Row(shown(own.path), cells))
    return Table("use", [Heading("product", words=True), *map(Heading, ("origin [mm]", "z", "x"))], rows)


def _counted(part: StepPart) -> str:
    """Numbers of its solids, faces and features, and of those left aside."""
    solids, faces = len(part.body.solids), len(part.body.faces)
    found = [f"{solids} solid{'s' * (solids != 1)}", f"{faces} faces", f"{len(part.features)} features"]
    repeated = sum(len(own.repeated) for own in part.features)
    if repeated:
        found.append(f"{repeated} loose faces that repeat its own")
    if loose := sum(own.loose for own in part.features):
        found.append(f"{loose} features beside the solid, which no selector takes but by a face")
    return ", ".join(found)


def _table(part: StepPart) -> Table:
    rows = [_row(part, name, own) for name, own in zip(names(part.features), part.features, strict=True)]
    return Table("", HEADINGS, rows)


def _row(part: StepPart, name: str, feature: FoundFeature) -> Row:
    beside = " (beside the solid)" if feature.loose else ""
    colour = [feature.colour] if feature.colour else []
    listed = numbers(feature)
    if len(feature.faces) > LONGEST_FACES:
        listed = f"{', '.join(f'#{own}' for own in feature.faces[:LONGEST_FACES])}, … ({len(feature.faces)})"
    cells = (
        f"{feature.kind}{beside}",
        size_text(feature),
        _numbers(feature.at, 4),
        "–" if feature.kind in ("ball", "socket", "free form") else _numbers(feature.direction, 4),
        listed,
        ", ".join([*_drawn(part, feature), *(repr(shown(own)) for own in feature.names), *colour]) or "–",
        best_line(part, feature),
    )
    return Row(name, cells)


def _drawn(part: StepPart, feature: FoundFeature) -> list[str]:
    """Names in the drawing on a feature: datums, tolerances and dimensions."""
    own = {*feature.faces, *feature.repeated}
    return [
        shown(each.words if each.what == "datum" else f"{each.name} {each.words}".strip())
        for each in part.named
        if own & {*each.faces}
    ]


def size_text(feature: FoundFeature) -> str:
    """The size of a feature in words."""
    if feature.kind == "plane":
        return f"⌀{_short(2 * feature.radius)}" if feature.radius else " × ".join(map(_short, feature.extent))
    if feature.kind in ("hole", "pin"):
        return f"⌀{_short(2 * feature.radius)} × {_short(feature.length)}"
    if feature.kind in ("fillet", "round"):
        return f"R{_short(feature.radius)} × {_short(feature.length)}"
    if feature.kind == "cone":
        return f"⌀{_short(2 * feature.minor_radius)} to ⌀{_short(2 * feature.radius)} × {_short(feature.length)}"
    if feature.kind == "torus":
        return f"R{_short(feature.radius)}, r{_short(feature.minor_radius)}"
    return f"S⌀{_short(2 * feature.radius)}" if feature.kind in ("ball", "socket") else "–"


def _short(value: float) -> str:
    return f"{round(value, 6) + 0.0:.8g}"


def _numbers(values: Sequence[float], decimals: int) -> str:
    return ", ".join(f"{round(own, decimals) + 0.0:.9g}" for own in values)


NUMBERS: Final = (
    "x", "y", "z", "direction x", "direction y", "direction z", "length or first extent", "second extent", "diameter",
    "smaller diameter", "half angle", "turn", "area",
)  # fmt: skip


def features_csv(file: StepFile) -> str:
    """All numbers with all their digits, a line a feature [mm, rad, mm²]."""
    heads = [
        Heading(own)
        for own in (
            "product",
            "kind",
            *NUMBERS,
            "faces",
            "loose faces on it",
            "in the drawing",
            "names",
            "colour",
            "line",
        )
    ]
    rows = [
        Row(name, (shown(part.name), own.kind, *_all_numbers(own), *_words(part, own)))
        for part in file.parts
        for name, own in zip(names(part.features), part.features, strict=True)
    ]
    return Table("feature", heads, rows).csv()


def _all_numbers(feature: FoundFeature) -> Sequence[Shown]:
    minor = 2 * feature.minor_radius if feature.kind in ("cone", "torus") else None
    values = (
        *feature.at,
        *feature.direction,
        *feature.extent,
        2 * feature.radius if feature.radius else None,
        minor,
        feature.half_angle if feature.kind == "cone" else None,
        feature.turn if feature.kind in ("hole", "pin", "fillet", "round", "cone") else None,
        feature.area,
    )
    return [Shown("" if own is None else f"{own:g}", own) for own in values]


def _words(part: StepPart, feature: FoundFeature) -> Sequence[str]:
    repeated = ", ".join(f"#{own}" for own in feature.repeated)
    drawn = ", ".join(_drawn(part, feature))
    return (
        numbers(feature),
        repeated,
        drawn,
        ", ".join(map(shown, feature.names)),
        feature.colour,
        best_line(part, feature),
    )
