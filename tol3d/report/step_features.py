"""The features of foreign parts as tables: what each is, where it lies, and a line that selects it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Final

from tol3d.report.declared import declared_table
from tol3d.report.page import BLANK, Line, Page, PageItem, Table, note, page, titled
from tol3d.runs.summary.shows import Computed, Shows
from tol3d.step.found import FoundFeature
from tol3d.step.reading import StepFile, StepPart
from tol3d.step.refused import shown
from tol3d.step.selecting import best_line, names, numbers

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
        named = ", ".join(repr(shown(own)) for own in file.layers[:LONGEST_FACES])
        blocks += [
            BLANK,
            note(f"{len(file.layers)} layers are ignored: {named}{', …' if len(file.layers) > LONGEST_FACES else ''}"),
        ]
    return page(*blocks, BLANK, note(WORDS))


def _uses(file: StepFile) -> Table:
    """Pose of each part, as in `use` and `placed` of a scene."""
    products = {own.body.product: shown(own.name) for own in file.parts}
    rows = [(shown(own.path), UseRow(products[own.product], own.frame)) for own in file.uses]
    return declared_table("use", rows)


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
    named = zip(names(part.features), part.features, strict=True)
    return declared_table("", [(name, FeatureRow(part, own)) for name, own in named])


def _first_faces(feature: FoundFeature) -> str:
    if len(feature.faces) <= LONGEST_FACES:
        return numbers(feature)
    return f"{', '.join(f'#{own}' for own in feature.faces[:LONGEST_FACES])}, … ({len(feature.faces)})"


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


def features_csv(file: StepFile) -> str:
    """All numbers with all their digits, a line a feature [mm, rad, mm²]."""
    rows = [
        (name, FeatureNumbers(part, own))
        for part in file.parts
        for name, own in zip(names(part.features), part.features, strict=True)
    ]
    return declared_table("feature", rows).csv()
