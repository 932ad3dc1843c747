"""The features of foreign parts as tables: what each is, where it lies, and a line that selects it.

Tables of tolerances in a STEP file: datums, tolerances with their meaning in a scene, dimensions.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Final

from tol3d.cad.step.datum import Datum
from tol3d.cad.step.dimension import Dimension
from tol3d.cad.step.feature import NamedFeature
from tol3d.cad.step.found_features import FoundFeature
from tol3d.cad.step.frame import frame
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

UNDIRECTED: Final = ("ball", "socket", "free form")
TURNED: Final = ("hole", "pin", "fillet", "round", "cone")
LONGEST_FACES: Final = 4  # faces of a feature that are listed
WORDS: Final = (
    "a hole or pin turns more than half round, a fillet or round less; planes by the rectangle around them, or their "
    "circle; places in the frame of the part, where the middle is; `#` numbers are those of faces in this file and "
    "change when it is exported again"
)


@dataclass(frozen=True)
class FeatureRow:
    """A feature of a part as a screen shows it."""

    part: StepPart
    of: FoundFeature
    kind = Computed(Shows("kind", "words"), lambda own: own.of.kind + " (beside the solid)" * own.of.loose)
    size = Computed(Shows("size [mm]", "words"), lambda own: size_text(own.of))
    place = Computed(Shows("place [mm]"), lambda own: _numbers(own.of.at, 4))
    direction = Computed(
        Shows("direction"), lambda own: "–" if own.of.kind in UNDIRECTED else _numbers(own.of.direction, 4)
    )
    faces = Computed(Shows("faces", "words", optional=True), lambda own: _first_faces(own.of))
    told = Computed(
        Shows("in the file", "words", optional=True),
        lambda own: (
            ", ".join(
                [
                    *_drawn(own.part, own.of),
                    *(repr(shown(name)) for name in own.of.names),
                    *filter(None, [own.of.colour]),
                ]
            )
            or "–"
        ),
    )
    line = Computed(Shows("select it by", "words"), lambda own: best_line(own.part, own.of))


@dataclass(frozen=True)
class FeatureNumbers:
    """All numbers of a feature [mm, rad, mm²]."""

    part: StepPart
    of: FoundFeature
    product = Computed(Shows("product"), lambda own: shown(own.part.name))
    kind = Computed(Shows("kind"), lambda own: own.of.kind)
    at = Computed(Shows("{key}", "g"), lambda own: dict(zip("xyz", own.of.at, strict=True)))
    direction = Computed(Shows("direction {key}", "g"), lambda own: dict(zip("xyz", own.of.direction, strict=True)))
    length = Computed(Shows("length or first extent", "g"), lambda own: own.of.extent[0])
    width = Computed(Shows("second extent", "g"), lambda own: own.of.extent[1])
    diameter = Computed(Shows("diameter", "g"), lambda own: 2 * own.of.radius or None)
    smaller_diameter = Computed(
        Shows("smaller diameter", "g"),
        lambda own: 2 * own.of.minor_radius if own.of.kind in ("cone", "torus") else None,
    )
    half_angle = Computed(Shows("half angle", "g"), lambda own: own.of.half_angle if own.of.kind == "cone" else None)
    turn = Computed(Shows("turn", "g"), lambda own: own.of.turn if own.of.kind in TURNED else None)
    area = Computed(Shows("area", "g"), lambda own: own.of.area)
    faces = Computed(Shows("faces"), lambda own: numbers(own.of))
    repeated = Computed(Shows("loose faces on it"), lambda own: ", ".join(f"#{face}" for face in own.of.repeated))
    drawn = Computed(Shows("in the drawing"), lambda own: ", ".join(_drawn(own.part, own.of)))
    names = Computed(Shows("names"), lambda own: ", ".join(map(shown, own.of.names)))
    colour = Computed(Shows("colour"), lambda own: own.of.colour)
    line = Computed(Shows("line"), lambda own: best_line(own.part, own.of))


@dataclass(frozen=True)
class UseRow:
    """A part where it stands in the file."""

    product: Annotated[str, Shows("product", "words")]
    frame: Sequence[Sequence[float]]
    origin = Computed(Shows("origin [mm]"), lambda own: _numbers(own.frame[0], 4))
    z_axis = Computed(Shows("z"), lambda own: _numbers(own.frame[1], 6))
    x_axis = Computed(Shows("x"), lambda own: _numbers(own.frame[2], 6))


def features_report(file: StepFile) -> Page:
    """A table for each product of a file that has geometry of its own."""
    blocks: list[PageItem] = []
    for part in file.parts:
        blocks += [BLANK] if blocks else []
        blocks += [Line(((shown(part.name), "bold"), (f" · {_counted(part)}", ""))), _table(part)]
    if len(file.uses) > 1:
        blocks += [BLANK, *titled("parts as they stand in the file", _uses(file))]
    if file.layers:
        named = ", ".join(repr(shown(layer)) for layer in file.layers[:LONGEST_FACES])
        blocks += [
            BLANK,
            note(f"{len(file.layers)} layers are ignored: {named}{', …' if len(file.layers) > LONGEST_FACES else ''}"),
        ]
    return page(*blocks, BLANK, note(WORDS))


def _uses(file: StepFile) -> Table:
    """Pose of each part, as in `use` and `placed` of a scene."""
    products = {part.body.product: shown(part.name) for part in file.parts}
    rows = [(shown(use.path), UseRow(products[use.product], use.frame)) for use in file.uses]
    return declared_table("use", rows)


def _counted(part: StepPart) -> str:
    """Numbers of its solids, faces and features, and of those left aside."""
    solids, faces = len(part.body.solids), len(part.body.faces)
    found = [f"{solids} solid{'s' * (solids != 1)}", f"{faces} faces", f"{len(part.features)} features"]
    repeated = sum(len(feature.repeated) for feature in part.features)
    if repeated:
        found.append(f"{repeated} loose faces that repeat its own")
    if loose := sum(feature.loose for feature in part.features):
        found.append(f"{loose} features beside the solid, which no selector takes but by a face")
    return ", ".join(found)


def _table(part: StepPart) -> Table:
    named = zip(names(part.features), part.features, strict=True)
    return declared_table("", [(name, FeatureRow(part, own)) for name, own in named])


def _first_faces(feature: FoundFeature) -> str:
    if len(feature.faces) <= LONGEST_FACES:
        return numbers(feature)
    return f"{', '.join(f'#{face}' for face in feature.faces[:LONGEST_FACES])}, … ({len(feature.faces)})"


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
    return ", ".join(f"{round(value, decimals) + 0.0:.9g}" for value in values)


def features_csv(file: StepFile) -> str:
    """All numbers with all their digits, a line a feature [mm, rad, mm²]."""
    rows = [
        (name, FeatureNumbers(part, own))
        for part in file.parts
        for name, own in zip(names(part.features), part.features, strict=True)
    ]
    return declared_table("feature", rows).csv()


MOST_FACES: Final = 8  # of a feature that are listed
PMI_WORDS: Final = (
    "frames and dimensions are in the unit that the file has them in, limits in mm or rad; `#` numbers stand in this "
    'file: those of faces select a feature in a scene, faces: ["#12", "#13"]; a + joins faces of one hole'
)


@dataclass(frozen=True)
class DatumRow:
    """A datum of a drawing."""

    is_a: Annotated[str, Shows("what it is", "words")]
    of: Datum
    faces = Computed(Shows("faces", "words"), lambda own: _faces(own.of.features))
    targets = Computed(Shows("targets", "words"), lambda own: shown(_targets(own.of)) or "–")


@dataclass(frozen=True)
class ToleranceRow:
    """A tolerance of a drawing, and what it means in a scene."""

    of: Tolerance
    meaning: Meaning
    unit = Computed(Shows("unit", "words"), lambda own: _unit(own.of.magnitude))
    name = Computed(Shows("name", "words", optional=True), lambda own: shown(own.of.name) or "–")
    at = Computed(Shows("at", "words"), lambda own: f"#{own.of.id}")
    shape = Computed(Shows("of", "words"), lambda own: own.meaning.shape)
    faces = Computed(Shows("faces", "words", optional=True), lambda own: _faces((own.of.feature,)))
    how = Computed(Shows("in a scene", "words"), lambda own: own.meaning.how)
    kind = Computed(Shows("as", "words", optional=True), lambda own: own.meaning.kind or "–")
    why = Computed(Shows("what is lost, or why it is left out", "words"), lambda own: own.meaning.why or "–")


class DimensionRow(RowOf[Dimension]):
    """A dimension of a drawing."""

    unit = Computed(Shows("unit", "words"), lambda own: _unit(own.of.nominal or own.of.least))
    name = Computed(Shows("name", "words", optional=True), lambda own: shown(own.of.name) or "–")
    at = Computed(Shows("at", "words"), lambda own: f"#{own.of.id}")
    kind = Computed(Shows("kind", "words"), lambda own: shown(own.of.kind))
    least = Computed(Shows("least", ".6g"), lambda own: (own.of.limits or (None, None))[0])
    most = Computed(Shows("most", ".6g"), lambda own: (own.of.limits or (None, None))[1])
    faces = Computed(Shows("faces", "words", optional=True), lambda own: _faces(own.of.features))


class RemarkRow(RowOf[Remark]):
    """Parts of a file that were not read, or are incomplete."""

    what = Computed(Shows("what", "words"), lambda own: shown(own.of.what))
    why = Computed(Shows("why", "words"), lambda own: shown(own.of.why))


def pmi_report(text: StepText) -> Page:
    """Datums, tolerances, dimensions, and what was not read or is incomplete; a table is there if it has a row.

    Raises:
        StepError: the surface of a face cannot be read.
    """
    surfaces = surfaces_of(text)
    found = Meanings(text, surfaces).all
    remarks = [*text.remarks, *disagreements(text, surfaces)]
    shapes = {
        datum.id: shape_of(datum.features[0], surfaces, text.structure).words for datum in text.datums if datum.features
    }
    datums = [(shown(datum.letter), DatumRow(shapes.get(datum.id, "–"), datum)) for datum in text.datums]
    tolerances = [
        ("  " * (each.above is not None) + shown(frame(each)), ToleranceRow(each, meaning))
        for each, meaning in zip(text.tolerances, found, strict=True)
    ]
    dimensions = [(shown(dimension), DimensionRow(dimension)) for dimension in text.dimensions]
    left_out = [(f"#{remark.id}", RemarkRow(remark)) for remark in remarks]
    blocks = [
        *_block("Datums", str(len(text.datums)), declared_table("letter", datums)),
        *_block("Tolerances", _counted_pmi(found), declared_table("frame", tolerances)),
        *_block("Dimensions", str(len(text.dimensions)), declared_table("dimension", dimensions)),
        *_block("Not read, or incomplete", str(len(remarks)), declared_table("at", left_out)),
    ]
    if not blocks:
        return page(line(f"{shown(text.name)} has no datums, tolerances or dimensions that can be read as such"))
    return page(*blocks[1:], BLANK, note(PMI_WORDS))


def _block(title: str, counted: str, table: Table) -> list[PageItem]:
    return [BLANK, Line(((title, "bold"), (f" · {counted}", ""))), table] if table.rows else []


def _counted_pmi(found: Sequence[Meaning]) -> str:
    """Numbers of tolerances, by use."""
    counts = Counter(each.how for each in found)
    listed = ", ".join(f"{counts[how]} {how}" for how in ("said", "approximately", "left out") if counts[how])
    return f"{len(found)}: {listed}"


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
