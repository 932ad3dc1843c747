"""Tables of tolerances in a STEP file: datums, tolerances with their meaning in a scene, dimensions."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Final

from tol3d.report.declared import declared_table
from tol3d.report.page import BLANK, Line, Page, PageItem, Table, line, note, page
from tol3d.runs.summary.shows import Computed, RowOf, Shows
from tol3d.step.datum import Datum
from tol3d.step.dimension import Dimension
from tol3d.step.feature import NamedFeature
from tol3d.step.frame import frame
from tol3d.step.meaning import Meaning, Meanings, surfaces_of
from tol3d.step.nominals import disagreements
from tol3d.step.outline import Remark, StepText
from tol3d.step.refused import shown
from tol3d.step.shape import shape_of
from tol3d.step.tolerance import Tolerance
from tol3d.step.units import Measure

MOST_FACES: Final = 8  # of a feature that are listed
WORDS: Final = (
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
        each.id: shape_of(each.features[0], surfaces, text.structure).words for each in text.datums if each.features
    }
    datums = [(shown(each.letter), DatumRow(shapes.get(each.id, "–"), each)) for each in text.datums]
    tolerances = [
        ("  " * (each.above is not None) + shown(frame(each)), ToleranceRow(each, meaning))
        for each, meaning in zip(text.tolerances, found, strict=True)
    ]
    dimensions = [(shown(each), DimensionRow(each)) for each in text.dimensions]
    left_out = [(f"#{each.id}", RemarkRow(each)) for each in remarks]
    blocks = [
        *_block("Datums", str(len(text.datums)), declared_table("letter", datums)),
        *_block("Tolerances", _counted(found), declared_table("frame", tolerances)),
        *_block("Dimensions", str(len(text.dimensions)), declared_table("dimension", dimensions)),
        *_block("Not read, or incomplete", str(len(remarks)), declared_table("at", left_out)),
    ]
    if not blocks:
        return page(line(f"{shown(text.name)} has no datums, tolerances or dimensions that can be read as such"))
    return page(*blocks[1:], BLANK, note(WORDS))


def _block(title: str, counted: str, table: Table) -> list[PageItem]:
    return [BLANK, Line(((title, "bold"), (f" · {counted}", ""))), table] if table.rows else []


def _counted(found: Sequence[Meaning]) -> str:
    """Numbers of tolerances, by use."""
    counts = Counter(each.how for each in found)
    listed = ", ".join(f"{counts[how]} {how}" for how in ("said", "approximately", "left out") if counts[how])
    return f"{len(found)}: {listed}"


def _targets(datum: Datum) -> str:
    return ", ".join(f"{datum.letter}{each.number} {each.kind}".strip() for each in datum.targets)


def _unit(measure: Measure | None) -> str:
    return "–" if measure is None else measure.unit.name


def _faces(features: Sequence[NamedFeature]) -> str:
    """The faces of features: members of a pattern by commas, the sides of a distance by an arrow."""
    return " → ".join(_listed(each) for each in features) or "–"


def _listed(feature: NamedFeature) -> str:
    if not feature.groups:
        return feature.lies_on
    count = len(feature.faces)
    if count > MOST_FACES:
        return f"{count} faces, #{feature.faces[0]} first"
    return ", ".join("+".join(f"#{face}" for face in group) for group in feature.groups)
