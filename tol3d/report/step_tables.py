"""Tables of STEP files: features of foreign parts, each with its place and a line that selects it.

And of product manufacturing information (PMI): datums, tolerances with their meaning in a scene, dimensions.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Final

import numpy as np

from tol3d.cad.step.datum import Datum
from tol3d.cad.step.dimension import Dimension
from tol3d.cad.step.feature import NamedFeature
from tol3d.cad.step.found_features import FeatureKind, FoundFeature
from tol3d.cad.step.frame import frame
from tol3d.cad.step.machined import MadeOfSeveral, Stepped
from tol3d.cad.step.meaning import Meaning, Meanings, surfaces_of
from tol3d.cad.step.outline import Remark, StepText, disagreements
from tol3d.cad.step.reading import StepFile, StepPart
from tol3d.cad.step.refused import shown
from tol3d.cad.step.selectors import best_line, names, numbers
from tol3d.cad.step.shape import shape_of
from tol3d.cad.step.tolerance import Tolerance
from tol3d.cad.step.units import Measure
from tol3d.report.declared import declared_table
from tol3d.report.page import BLANK, Line, Page, PageItem, Table, line, note, page, titled
from tol3d.study.runs.summary.shows import Computed, RowOf, Shows

UNDIRECTED: Final = ("ball", "socket", "free form", "unread")
ROUNDING: Final = 1e-6  # mm; splines that deviate by less are the surface that they are taken for
TURNED: Final = ("hole", "pin", "fillet", "round", "cone")
MOST_ROWS: Final = 40  # of a page, a terminal's height or so
LEAST_ROWS: Final = 4  # of a product
MOST_PARTS: Final = 8  # products on a page
ORDER: Final[Sequence[FeatureKind]] = (
    "hole", "pin", "ball", "socket", "cone", "plane", "torus", "fillet", "round", "free form", "unread",
)  # fmt: skip
LISTED: Final = 4  # faces of a feature, or layers of a file, that are listed
WORDS: Final = (
    "a hole or pin turns more than half round, a fillet or round less; planes by the rectangle around them, or their "
    "circle; places in the frame of the part, where the middle is; `#` numbers are those of faces in this file and "
    "change when it is exported again"
)


@dataclass(frozen=True)
class FeatureRow:
    """A feature of a part as a screen shows it."""

    part: StepPart
    feature: FoundFeature
    kind = Computed(Shows("kind", "words"), lambda row: kind_text(row.feature))
    size = Computed(Shows("size [mm]", "words"), lambda row: size_text(row.feature))
    place = Computed(
        Shows("place [mm]"), lambda row: "–" if row.feature.kind == "unread" else _numbers(row.feature.at, 4)
    )
    direction = Computed(
        Shows("direction"), lambda row: "–" if row.feature.kind in UNDIRECTED else _numbers(row.feature.direction, 4)
    )
    faces = Computed(Shows("faces", "words", optional=True), lambda row: _first_faces(row.feature))
    in_file = Computed(
        Shows("in the file", "words", optional=True),
        lambda row: (
            ", ".join(
                [
                    *_drawn(row.part, row.feature),
                    *(repr(shown(name)) for name in row.feature.names),
                    *filter(None, [row.feature.colour]),
                ]
            )
            or "–"
        ),
    )
    line = Computed(Shows("select it by", "words"), lambda row: best_line(row.part, row.feature))


@dataclass(frozen=True)
class AlikeRow:
    """Features of one kind and size on a page, by the first of them."""

    features: Sequence[FoundFeature]
    part: StepPart
    count = Computed(Shows("count", "words"), lambda row: f"{len(row.features)} ×" if len(row.features) > 1 else "")
    kind = Computed(Shows("kind", "words"), lambda row: kind_text(row.features[0]))
    size = Computed(Shows("size [mm]", "words"), lambda row: size_text(row.features[0]))
    place = Computed(Shows("the first at [mm]"), lambda row: _numbers(row.features[0].at, 4))
    drawn = Computed(
        Shows("in the drawing", "words", optional=True),
        lambda row: ", ".join(dict.fromkeys(each for own in row.features for each in _letters(row.part, own))) or "–",
    )


@dataclass(frozen=True)
class MachinedRow:
    """Features that several surfaces make, of one size, by the first of them."""

    alike: Sequence[MadeOfSeveral]
    place = Computed(Shows("the first at [mm]"), lambda row: _numbers(_middle(row.alike[0]), 4))
    faces = Computed(Shows("its faces", "words"), lambda row: _few(row.alike[0]))


@dataclass(frozen=True)
class FeatureNumbers:
    """All numbers of a feature [mm, rad, mm²]."""

    part: StepPart
    feature: FoundFeature
    product = Computed(Shows("product"), lambda row: shown(row.part.name))
    kind = Computed(Shows("kind"), lambda row: row.feature.kind)
    at = Computed(Shows("{key}", "g"), lambda row: dict(zip("xyz", row.feature.at, strict=True)))
    direction = Computed(
        Shows("direction {key}", "g"), lambda row: dict(zip("xyz", row.feature.direction, strict=True))
    )
    length = Computed(Shows("length or first extent", "g"), lambda row: row.feature.extent[0])
    width = Computed(Shows("second extent", "g"), lambda row: row.feature.extent[1])
    diameter = Computed(Shows("diameter", "g"), lambda row: 2 * row.feature.radius or None)
    smaller_diameter = Computed(
        Shows("smaller diameter", "g"),
        lambda row: 2 * row.feature.minor_radius if row.feature.kind in ("cone", "torus") else None,
    )
    half_angle = Computed(
        Shows("half angle", "g"), lambda row: row.feature.half_angle if row.feature.kind == "cone" else None
    )
    turn = Computed(Shows("turn", "g"), lambda row: row.feature.turn if row.feature.kind in TURNED else None)
    area = Computed(Shows("area", "g"), lambda row: row.feature.area)
    faces = Computed(Shows("faces"), lambda row: numbers(row.feature))
    repeated = Computed(Shows("loose faces on it"), lambda row: ", ".join(f"#{face}" for face in row.feature.repeated))
    drawn = Computed(Shows("in the drawing"), lambda row: ", ".join(_drawn(row.part, row.feature)))
    names = Computed(Shows("names"), lambda row: ", ".join(map(shown, row.feature.names)))
    colour = Computed(Shows("colour"), lambda row: row.feature.colour)
    line = Computed(Shows("line"), lambda row: best_line(row.part, row.feature))


@dataclass(frozen=True)
class UseRow:
    """A part where it stands in the file."""

    product: Annotated[str, Shows("product", "words")]
    frame: Sequence[Sequence[float]]
    origin = Computed(Shows("origin [mm]"), lambda row: _numbers(row.frame[0], 4))
    z_axis = Computed(Shows("z"), lambda row: _numbers(row.frame[1], 6))
    x_axis = Computed(Shows("x"), lambda row: _numbers(row.frame[2], 6))


def features_page(file: StepFile) -> Page:
    """Features of a file on a page: those of one kind and size of a product in one row, MOST_ROWS rows in all."""
    blocks: list[PageItem] = []
    left = 0
    room = max(LEAST_ROWS, MOST_ROWS // max(1, len(file.parts)))
    for part in file.parts[:MOST_PARTS]:
        rows = _alike(part)
        left += sum(len(own.features) for _, own in rows[room:])
        blocks += [BLANK] if blocks else []
        blocks += [
            Line(((shown(part.name), "bold"), (f" · {_counted(part)}", ""))),
            declared_table("", rows[:room]),
            *_machined(part, max(LEAST_ROWS, room // 4)),
            *_unread(part),
        ]
    words = []
    if len(file.parts) > MOST_PARTS:
        words.append(f"{len(file.parts) - MOST_PARTS} more products")
    if left:
        words.append(f"{left} more features")
    if len(file.uses) > 1:
        words.append(f"{len(file.uses)} parts as they stand in the file")
    more = f"{', '.join(words)}; " if words else ""
    blocks += _elsewhere(file)
    return page(*blocks, BLANK, note(f"{more}--all lists each feature, with the line that selects it in a scene"))


def _alike(part: StepPart) -> list[tuple[str, AlikeRow]]:
    """Features of one kind and size together, those that hold others first, then the largest."""
    groups: dict[tuple[str, str], list[tuple[str, FoundFeature]]] = {}
    for name, own in zip(names(part.features), part.features, strict=True):
        groups.setdefault((kind_text(own), size_text(own)), []).append((name, own))
    ordered = sorted(
        groups.values(),
        key=lambda group: (ORDER.index(group[0][1].kind), -sum(own.area for _, own in group)),
    )
    return [(group[0][0], AlikeRow([own for _, own in group], part)) for group in ordered]


def _machined(part: StepPart, most: int | None) -> list[PageItem]:
    """Features of a part that several surfaces make, those of one size together, and threads that names state."""
    alike: dict[str, list[MadeOfSeveral]] = {}
    for own in part.machined.all:
        alike.setdefault(own.words, []).append(own)
    rows = [(f"{len(own)} × {words}" if len(own) > 1 else words, MachinedRow(own)) for words, own in alike.items()]
    blocks: list[PageItem] = [declared_table("made of several", rows[:most])] if rows else []
    if most is not None and len(rows) > most:
        blocks.append(note(f"and {len(rows) - most} more that several faces make"))
    if part.threads:
        named = ", ".join(map(shown, part.threads[:LISTED]))
        blocks.append(note(f"thread {named} by name: its faces are plain cylinders"))
    return blocks


def _middle(own: MadeOfSeveral) -> Sequence[float]:
    """Place of a feature that several surfaces make: of its hole, or the middle of its members."""
    if isinstance(own, Stepped):
        return own.hole.at
    at = np.mean([member.at for member in own.members], axis=0)
    return [float(each) for each in at]


def _few(own: MadeOfSeveral) -> str:
    """Numbers of the first of its faces."""
    faces = [face for member in own.members for face in member.faces]
    return ", ".join(f"#{face}" for face in faces[:LISTED]) + (", …" if len(faces) > LISTED else "")


def _letters(part: StepPart, feature: FoundFeature) -> list[str]:
    """Letters of the datums on a feature."""
    faces = {*feature.faces, *feature.repeated}
    return [shown(each.name) for each in part.named if each.what == "datum" and faces & {*each.faces}]


def features_report(file: StepFile) -> Page:
    """Features of each product of a file that has geometry of its own, a table each; poses if there are several."""
    blocks: list[PageItem] = []
    for part in file.parts:
        blocks += [BLANK] if blocks else []
        blocks += [
            Line(((shown(part.name), "bold"), (f" · {_counted(part)}", ""))),
            _table(part),
            *_machined(part, None),
            *_unread(part),
        ]
    if len(file.uses) > 1:
        blocks += [BLANK, *titled("parts as they stand in the file", _uses(file))]
    if file.layers:
        named = ", ".join(repr(shown(layer)) for layer in file.layers[:LISTED])
        blocks += [
            BLANK,
            note(f"{len(file.layers)} layers are ignored: {named}{', …' if len(file.layers) > LISTED else ''}"),
        ]
    return page(*blocks, *_elsewhere(file), BLANK, note(WORDS))


def _elsewhere(file: StepFile) -> list[PageItem]:
    """Parts whose shapes stand in other files, by file."""
    counts = Counter(own.file for own in file.elsewhere)
    listed = [f"{shown(name)!r}" + (f" ({count} ×)" if count > 1 else "") for name, count in counts.items()]
    if not listed:
        return []
    more = f", and {len(listed) - MOST_PARTS} more" if len(listed) > MOST_PARTS else ""
    words = f"{counts.total()} parts stand in other files: {', '.join(listed[:MOST_PARTS])}{more}"
    return [note(f"{words}; tol3d new --from reads them from the folder of this file")]


def _unread(part: StepPart) -> list[PageItem]:
    """Faces of a part that cannot be read, or not triangulated, and what that means."""
    noted = [note(f"#{face} cannot be read: {shown(why)}") for face, why in list(part.unread.items())[:LISTED]]
    if len(part.unread) > LISTED:
        noted.append(note(f"and {len(part.unread) - LISTED} more faces cannot be read"))
    bare = sorted(part.bare - {*part.unread})
    if bare:
        listed = ", ".join(f"#{face}" for face in bare[:LISTED]) + (", …" if len(bare) > LISTED else "")
        noted.append(note(f"Open CASCADE cannot triangulate {listed}: no picture has it, by its surface it is exact"))
    return [*noted, note("a clearance of this part is refused")] if noted else []


def _uses(file: StepFile) -> Table:
    """Pose of each part, as in `use` and `placed` of a scene."""
    products = {part.body.product: shown(part.name) for part in file.parts}
    rows = [(shown(use.path), UseRow(products[use.product], use.frame)) for use in file.uses]
    return declared_table("use", rows)


def _counted(part: StepPart) -> str:
    """Numbers of its solids, faces and features, and of those left aside."""
    solids, faces = len(part.body.solids), len(part.body.faces)
    counts = [f"{solids} solid{'s' * (solids != 1)}", f"{faces} faces", f"{len(part.features)} features"]
    repeated = sum(len(feature.repeated) for feature in part.features)
    if repeated:
        counts.append(f"{repeated} loose faces that repeat its own")
    if loose := sum(feature.loose for feature in part.features):
        counts.append(f"{loose} features beside the solid, which no selector takes but by a face")
    return ", ".join(counts)


def _table(part: StepPart) -> Table:
    named = zip(names(part.features), part.features, strict=True)
    return declared_table("", [(name, FeatureRow(part, feature)) for name, feature in named])


def _first_faces(feature: FoundFeature) -> str:
    if len(feature.faces) <= LISTED:
        return numbers(feature)
    return f"{', '.join(f'#{face}' for face in feature.faces[:LISTED])}, … ({len(feature.faces)})"


def _drawn(part: StepPart, feature: FoundFeature) -> list[str]:
    """Names in the drawing on a feature: datums, tolerances and dimensions."""
    faces = {*feature.faces, *feature.repeated}
    return [
        shown(each.words if each.what == "datum" else f"{each.name} {each.words}".strip())
        for each in part.named
        if faces & {*each.faces}
    ]


def kind_text(feature: FoundFeature) -> str:
    """The kind of a feature in words, with the deviation of splines that are taken for it."""
    deviation = f" (spline within {1000 * feature.deviation:.2g} µm)" if feature.deviation > ROUNDING else ""
    return feature.kind + deviation + " (beside the solid)" * feature.loose


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
    return ", ".join(f"{round(value, decimals) + 0.0:.9g}" for value in values)


def features_csv(file: StepFile) -> str:
    """CSV of all numbers with all their digits, a line per feature [mm, rad, mm²]."""
    rows = [
        (name, FeatureNumbers(part, feature))
        for part in file.parts
        for name, feature in zip(names(part.features), part.features, strict=True)
    ]
    return declared_table("feature", rows).csv()


MOST_FACES: Final = 8  # of an annotated feature; of more only the first is listed
PMI_WORDS: Final = (
    "frames and dimensions are in the unit that the file has them in, limits in mm or rad; `#` numbers stand in this "
    'file: those of faces select a feature in a scene, faces: ["#12", "#13"]; a + joins faces of one hole'
)


@dataclass(frozen=True)
class DatumRow:
    """A datum of a drawing."""

    is_a: Annotated[str, Shows("what it is", "words")]
    datum: Datum
    faces = Computed(Shows("faces", "words"), lambda row: _faces(row.datum.features))
    targets = Computed(Shows("targets", "words"), lambda row: shown(_targets(row.datum)) or "–")


@dataclass(frozen=True)
class ToleranceRow:
    """A tolerance of a drawing, and what it means in a scene."""

    tolerance: Tolerance
    meaning: Meaning
    unit = Computed(Shows("unit", "words"), lambda row: _unit(row.tolerance.magnitude))
    name = Computed(Shows("name", "words", optional=True), lambda row: shown(row.tolerance.name) or "–")
    at = Computed(Shows("at", "words"), lambda row: f"#{row.tolerance.id}")
    shape = Computed(Shows("of", "words"), lambda row: row.meaning.shape)
    faces = Computed(Shows("faces", "words", optional=True), lambda row: _faces((row.tolerance.feature,)))
    how = Computed(Shows("in a scene", "words"), lambda row: row.meaning.how)
    kind = Computed(Shows("as", "words", optional=True), lambda row: row.meaning.kind or "–")
    why = Computed(Shows("what is lost, or why it is left out", "words"), lambda row: row.meaning.why or "–")


class DimensionRow(RowOf[Dimension]):
    """A dimension of a drawing."""

    unit = Computed(Shows("unit", "words"), lambda row: _unit(row.of.nominal or row.of.least))
    name = Computed(Shows("name", "words", optional=True), lambda row: shown(row.of.name) or "–")
    at = Computed(Shows("at", "words"), lambda row: f"#{row.of.id}")
    kind = Computed(Shows("kind", "words"), lambda row: shown(row.of.kind))
    least = Computed(Shows("least", ".6g"), lambda row: (row.of.limits or (None, None))[0])
    most = Computed(Shows("most", ".6g"), lambda row: (row.of.limits or (None, None))[1])
    faces = Computed(Shows("faces", "words", optional=True), lambda row: _faces(row.of.features))


class RemarkRow(RowOf[Remark]):
    """Parts of a file that were not read, or are incomplete."""

    what = Computed(Shows("what", "words"), lambda row: shown(row.of.what))
    why = Computed(Shows("why", "words"), lambda row: shown(row.of.why))


def pmi_report(text: StepText) -> Page:
    """Datums, tolerances, dimensions, and entries not read or incomplete; tables without rows are left out.

    Raises:
        StepError: the surface of a face cannot be read.
    """
    surfaces = surfaces_of(text)
    meanings = Meanings(text, surfaces).all
    remarks = [*text.remarks, *disagreements(text, surfaces)]
    shapes = {
        datum.id: shape_of(datum.features[0], surfaces, text.structure).words for datum in text.datums if datum.features
    }
    datums = [(shown(datum.letter), DatumRow(shapes.get(datum.id, "–"), datum)) for datum in text.datums]
    tolerances = [
        ("  " * (each.above is not None) + shown(frame(each)), ToleranceRow(each, meaning))
        for each, meaning in zip(text.tolerances, meanings, strict=True)
    ]
    dimensions = [(shown(dimension), DimensionRow(dimension)) for dimension in text.dimensions]
    left_out = [(f"#{remark.id}", RemarkRow(remark)) for remark in remarks]
    blocks = [
        *_block("Datums", str(len(text.datums)), declared_table("letter", datums)),
        *_block("Tolerances", _counted_pmi(meanings), declared_table("frame", tolerances)),
        *_block("Dimensions", str(len(text.dimensions)), declared_table("dimension", dimensions)),
        *_block("Not read, or incomplete", str(len(remarks)), declared_table("at", left_out)),
    ]
    if not blocks:
        return page(line(f"{shown(text.name)} has no datums, tolerances or dimensions that can be read as such"))
    return page(*blocks[1:], BLANK, note(PMI_WORDS))


def _block(title: str, counted: str, table: Table) -> list[PageItem]:
    return [BLANK, Line(((title, "bold"), (f" · {counted}", ""))), table] if table.rows else []


def _counted_pmi(meanings: Sequence[Meaning]) -> str:
    """Numbers of tolerances, by use."""
    counts = Counter(meaning.how for meaning in meanings)
    listed = ", ".join(f"{counts[how]} {how}" for how in ("said", "approximately", "left out") if counts[how])
    return f"{len(meanings)}: {listed}"


def _targets(datum: Datum) -> str:
    return ", ".join(f"{datum.letter}{target.number} {target.kind}".strip() for target in datum.targets)


def _unit(measure: Measure | None) -> str:
    return "–" if measure is None else measure.unit.name


def _faces(features: Sequence[NamedFeature]) -> str:
    """The faces of features: members of a pattern by commas, the sides of a distance by an arrow."""
    return " → ".join(_listed(feature) for feature in features) or "–"


def _listed(feature: NamedFeature) -> str:
    if not feature.groups:
        return feature.lies_on
    count = len(feature.faces)
    if count > MOST_FACES:
        return f"{count} faces, #{feature.faces[0]} first"
    return ", ".join("+".join(f"#{face}" for face in group) for group in feature.groups)
