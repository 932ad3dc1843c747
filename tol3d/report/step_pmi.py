"""Tables of tolerances in a STEP file: datums, tolerances with their meaning in a scene, dimensions."""

from collections import Counter
from collections.abc import Sequence
from typing import Final

from tol3d.report.page import BLANK, Heading, Line, Page, PageItem, Row, Shown, Table, line, note, page
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
DATUM_HEADINGS: Final = (
    Heading("what it is", words=True),
    Heading("faces", words=True),
    Heading("targets", words=True),
)
TOLERANCE_HEADINGS: Final = (
    Heading("unit", words=True),
    Heading("name", words=True, optional=True),
    Heading("at", words=True),
    Heading("of", words=True),
    Heading("faces", words=True, optional=True),
    Heading("in a scene", words=True),
    Heading("as", words=True, optional=True),
    Heading("what is lost, or why it is left out", words=True),
)
DIMENSION_HEADINGS: Final = (
    Heading("unit", words=True),
    Heading("name", words=True, optional=True),
    Heading("at", words=True),
    Heading("kind", words=True),
    Heading("least"),
    Heading("most"),
    Heading("faces", words=True, optional=True),
)
REMARK_HEADINGS: Final = (Heading("what", words=True), Heading("why", words=True))


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
    datum_rows = [_datum(each, shapes.get(each.id, "–")) for each in text.datums]
    tolerance_rows = [_tolerance(each, meaning) for each, meaning in zip(text.tolerances, found, strict=True)]
    blocks = [
        *_block("Datums", str(len(text.datums)), "letter", DATUM_HEADINGS, datum_rows),
        *_block("Tolerances", _counted(found), "frame", TOLERANCE_HEADINGS, tolerance_rows),
        *_block(
            "Dimensions",
            str(len(text.dimensions)),
            "dimension",
            DIMENSION_HEADINGS,
            list(map(_dimension, text.dimensions)),
        ),
        *_block("Not read, or incomplete", str(len(remarks)), "at", REMARK_HEADINGS, list(map(_remark, remarks))),
    ]
    if not blocks:
        return page(line(f"{shown(text.name)} has no datums, tolerances or dimensions that can be read as such"))
    return page(*blocks[1:], BLANK, note(WORDS))


def _block(title: str, counted: str, corner: str, headings: Sequence[Heading], rows: Sequence[Row]) -> list[PageItem]:
    if not rows:
        return []
    return [BLANK, Line(((title, "bold"), (f" · {counted}", ""))), Table(corner, headings, rows)]


def _counted(found: Sequence[Meaning]) -> str:
    """Numbers of tolerances, by use."""
    counts = Counter(each.how for each in found)
    listed = ", ".join(f"{counts[how]} {how}" for how in ("said", "approximately", "left out") if counts[how])
    return f"{len(found)}: {listed}"


def _datum(datum: Datum, words: str) -> Row:
    targets = ", ".join(f"{datum.letter}{each.number} {each.kind}".strip() for each in datum.targets)
    return Row(shown(datum.letter), (words, _faces(datum.features), shown(targets) or "–"))


def _tolerance(tolerance: Tolerance, meaning: Meaning) -> Row:
    cells = (
        _unit(tolerance.magnitude),
        shown(tolerance.name) or "–",
        f"#{tolerance.id}",
        meaning.shape,
        _faces((tolerance.feature,)),
        meaning.how,
        meaning.kind or "–",
        meaning.why or "–",
    )
    below = "  " if tolerance.above is not None else ""
    return Row(below + shown(frame(tolerance)), cells)


def _dimension(dimension: Dimension) -> Row:
    limits = dimension.limits or (None, None)
    cells = (
        _unit(dimension.nominal or dimension.least),
        shown(dimension.name) or "–",
        f"#{dimension.id}",
        shown(dimension.kind),
        *(Shown("–" if each is None else f"{each:.6g}", each) for each in limits),
        _faces(dimension.features),
    )
    return Row(shown(dimension), cells)


def _remark(remark: Remark) -> Row:
    return Row(f"#{remark.id}", (shown(remark.what), shown(remark.why)))


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
